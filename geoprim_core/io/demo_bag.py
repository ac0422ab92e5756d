"""The demo bag: real photographs and rendered sorting sequences with their ground truth."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass

import numpy as np
from tqdm import tqdm

from geoprim_core._check import AnyArray
from geoprim_core.applications.sorting import OUTLINE_VERTICES, ellipse_outlines, size_on_plane
from geoprim_core.fitting import ellipse_boxes
from geoprim_core.io.bags import BagWriter
from geoprim_core.io.camera_message import camera_record
from geoprim_core.io.image_message import image_record
from geoprim_core.io.photographs import PHOTOGRAPHS, packaged_photographs
from geoprim_core.io.wire import to_wire
from geoprim_core.synthetic import SORTING_LINES, Scene, sorting_sequence
from geoprim_core.types import Detections

RATE_HZ = 15
START_NS = 1_700_000_000_000_000_000
PHOTOGRAPH_FRAMES = 3
PHOTOGRAPH_TICKS = 3  # photographs, some of them large, come at a third of the rate
SORTING_FRAMES = 60


@dataclass(frozen=True)
class DemoSequence:
    """A sequence of the demo bag: its frame_id, first and last stamp, frames and provenance."""

    name: str
    start_ns: int
    end_ns: int
    frames: int
    content: str
    source: str


def build_demo_bag(
    path: str | os.PathLike[str],
    *,
    sorting_frames: int = SORTING_FRAMES,
    progress: bool = True,
) -> tuple[DemoSequence, ...]:
    """Write the demo bag.

    Topics: `image`, `camera_info` (of a camera that is not calibrated for the photographs) and,
    for the rendered sequences, `ground_truth`: there a score of 1 marks an object that a detector
    is expected to find, and 0 one that counts neither as hit nor as miss. The metadata record
    `sequences` lists the sequences, each as JSON.

    Parameters
    ----------
    path : path of the .mcap file; an old one is replaced
    sorting_frames : int
        Frames of each rendered sequence.
    progress : bool
        Show a progress bar where the standard error output is a terminal.

    Returns
    -------
    tuple of DemoSequence

    Raises
    ------
    FileError
        The bag cannot be written, or scikit-image's photographs are missing.
    """
    photographs = packaged_photographs()
    total = PHOTOGRAPH_FRAMES * len(photographs) + sorting_frames * len(SORTING_LINES)
    bar = tqdm(total=total, unit="frame", file=sys.stderr, disable=None if progress else True)
    with BagWriter(path) as bag, bar:
        run = _Run(bag, bar)
        for name, image in photographs.items():
            about = PHOTOGRAPHS[name]
            source = f"scikit-image, {about.file}: {about.source}"
            run.sequence(f"photo_{name}", _still(image), about.content, source, PHOTOGRAPH_TICKS)
        for seed, line in enumerate(SORTING_LINES):
            scenes = sorting_sequence(line, seed=seed, frames=sorting_frames)
            run.sequence(f"sorting_{line}", scenes, f"{line} on a belt", "rendered by geoprim")
        table = {s.name: json.dumps(asdict(s)) for s in run.sequences}
        bag.add_metadata("sequences", table)
    return tuple(run.sequences)


def ground_truth(scene: Scene) -> Detections:
    """Return the true objects of a scene; the score is 1 where one has to be found, else 0."""
    order = np.argsort(~scene.required, kind="stable")
    ellipses = scene.ellipses.select(order)
    count = len(ellipses)
    unknown = np.full((count, 2), np.nan)
    return Detections(
        labels=tuple(scene.labels[k] for k in order),
        score=scene.required[order].astype(np.float64),
        boxes=ellipse_boxes(ellipses),
        ellipses=ellipses,
        polygons=ellipse_outlines(ellipses, OUTLINE_VERTICES).reshape(-1, 2),
        polygon_offsets=np.arange(count + 1) * OUTLINE_VERTICES,
        size=unknown if scene.camera is None else size_on_plane(ellipses, scene.camera),
        image_size=scene.image_size,
    )


def _still(image: AnyArray) -> Iterator[AnyArray]:
    return (image for _ in range(PHOTOGRAPH_FRAMES))


class _Run:
    """Where the writing stands."""

    def __init__(self, bag: BagWriter, bar: tqdm[None]) -> None:
        self.sequences: list[DemoSequence] = []
        self._bag, self._bar = bag, bar
        self._ticks = 0

    def sequence(
        self,
        name: str,
        frames: Iterator[AnyArray | Scene],
        content: str,
        source: str,
        ticks: int = 1,
    ) -> None:
        stamps = []
        for frame in frames:
            # Whole numbers, so that no rounding adds up.
            stamps.append(START_NS + self._ticks * 1_000_000_000 // RATE_HZ)
            self._write(frame, stamps[-1], name)
            self._ticks += ticks
            self._bar.update()
        row = DemoSequence(name, stamps[0], stamps[-1], len(stamps), content, source)
        self.sequences.append(row)

    def _write(self, frame: AnyArray | Scene, stamp: int, name: str) -> None:
        if isinstance(frame, Scene):
            image, camera = frame.image, frame.camera
            self._bag.write("ground_truth", to_wire(ground_truth(frame), stamp, name))
        else:
            image, camera = frame, None
        size = image.shape[1], image.shape[0]
        self._bag.write("camera_info", camera_record(camera, size, stamp, name))
        self._bag.write("image", image_record(image, stamp, name))
