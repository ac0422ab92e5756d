"""Scoring sequences of detections and running detectors over images with ground truth."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from geoprim_core._check import AnyArray, describe
from geoprim_core.errors import InputError
from geoprim_core.evaluation.ground_truth import GroundTruth
from geoprim_core.evaluation.matching import match_ellipses
from geoprim_core.evaluation.report import ImageScore, Report
from geoprim_core.types import EllipseDetections, Ellipses

Found = Ellipses | EllipseDetections
Detector = Callable[[AnyArray], Found]

OVERLAPS = (0.8, 0.95)
"""The overlap ratios of a report: usual for photographs, and the thesis' for rendered images."""


def score_sequence(
    pairs: Iterable[tuple[Found, GroundTruth]], *, overlaps: Sequence[float] = OVERLAPS
) -> Report:
    """Score the detections of a sequence of images.

    Parameters
    ----------
    pairs : iterable of (Ellipses or EllipseDetections, GroundTruth)
    overlaps : floats
        Least overlap ratios of a hit, in (0, 1].

    Returns
    -------
    Report

    Raises
    ------
    InputError
        A detection is neither Ellipses nor EllipseDetections, or an overlap is out of range.

    References
    ----------
    Thesis section 5.6.2.

    Examples
    --------
    >>> disc = Ellipses([50], [50], [20], [20], [0])
    >>> report = score_sequence([(disc, GroundTruth("frame", disc))])
    >>> [(row.overlap, row.score.f_measure) for row in report.rows]
    [(0.8, 1.0), (0.95, 1.0)]
    """
    scores = []
    for found, truth in pairs:
        ellipses = _ellipses(found)
        for overlap in overlaps:
            matching = match_ellipses(
                ellipses, truth.ellipses, overlap=overlap, uncertain=truth.uncertain
            )
            score = matching.score(recall_only=truth.recall_only)
            scores.append(ImageScore(truth.name, truth.group, overlap, score))
    return Report(tuple(scores))


def evaluate_images(
    detector: Detector,
    truth: Iterable[GroundTruth],
    read_image: Callable[[Path], AnyArray],
    *,
    overlaps: Sequence[float] = OVERLAPS,
) -> Report:
    """Run a detector over the image files of a ground truth and score what it finds.

    Parameters
    ----------
    detector : callable(image) -> Ellipses or EllipseDetections
    truth : iterable of GroundTruth
        As `load_ground_truth` returns; each with the path of its image.
    read_image : callable(path) -> image
    overlaps : floats

    Returns
    -------
    Report

    Raises
    ------
    InputError
        A ground truth has no path.
    FileError
        Raised by `read_image` for an image that is not there.

    Examples
    --------
    >>> disc = Ellipses([50], [50], [20], [20], [0])
    >>> truth = GroundTruth("disc", disc, path=Path("disc.png"))
    >>> evaluate_images(lambda image: disc, [truth], lambda path: None).rows[0].score
    Score(hits=1, misses=0, false=0)
    """
    pairs = ((detector(read_image(_path(entry))), entry) for entry in truth)
    return score_sequence(pairs, overlaps=overlaps)


def _path(truth: GroundTruth) -> Path:
    if truth.path is None:
        raise InputError("truth", "the path of an image", f"none for {truth.name}")
    return truth.path


def _ellipses(found: Found) -> Ellipses:
    if isinstance(found, EllipseDetections):
        return found.ellipses
    if not isinstance(found, Ellipses):
        raise InputError("found", "Ellipses or EllipseDetections", describe(found))
    return found
