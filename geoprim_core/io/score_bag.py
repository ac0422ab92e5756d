"""Scoring a bag of results against the ground-truth topic that it carries."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence

from geoprim_core.errors import BagError
from geoprim_core.evaluation import OVERLAPS, GroundTruth, Report, score_sequence
from geoprim_core.io.bags import BagReader
from geoprim_core.io.record import stamp_of
from geoprim_core.io.wire import from_wire
from geoprim_core.types import Detections, EllipseDetections, Ellipses


def score_bag(
    path: str | os.PathLike[str],
    *,
    found: str = "ellipses",
    truth: str = "ground_truth",
    overlaps: Sequence[float] = OVERLAPS,
) -> Report:
    """Score the detections of a bag, frame by frame, grouped by `frame_id`.

    A true object with score 0 is not required: it counts neither as hit nor as miss.

    Parameters
    ----------
    path : path of an .mcap file or of a rosbag2 folder
    found, truth : str
        Topics of type geoprim_msgs/msg/EllipseDetections or Detections, and Detections.
    overlaps : floats
        Least overlap ratios of a hit.

    Returns
    -------
    Report

    Raises
    ------
    BagError
        The bag cannot be read, a topic is missing, or no frame has both.
    """
    reader = BagReader(path)
    report = score_sequence(_pairs(reader, found, truth), overlaps=overlaps)
    if not report.images:
        raise BagError(f"{reader.path}: no stamp has a message on {found} and on {truth}")
    return report


def _pairs(reader: BagReader, found: str, truth: str) -> Iterator[tuple[Ellipses, GroundTruth]]:
    """Yield detections and truth of one stamp; a frame without an answer has found nothing."""
    answers: dict[int, Ellipses] = {}
    for message in reader.messages([found]):
        answer = from_wire(message.decoded)
        if not isinstance(answer, EllipseDetections | Detections):
            raise BagError(f"{reader.path}: topic {found} holds {message.type}, not ellipses")
        answers[stamp_of(message.decoded)] = answer.ellipses
    for message in reader.messages([truth]):
        known, stamp = from_wire(message.decoded), stamp_of(message.decoded)
        if not isinstance(known, Detections):
            raise BagError(f"{reader.path}: topic {truth} holds {message.type}, not objects")
        group = message.decoded.header.frame_id
        entry = GroundTruth(f"{group}/{stamp}", known.ellipses, known.score == 0.0, group=group)
        yield answers.get(stamp, EllipseDetections.empty().ellipses), entry
