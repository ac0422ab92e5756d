"""Processing a bag offline: every frame, one after the other, into a new bag and overlays."""

from __future__ import annotations

import os
import re
import sys
import time
from bisect import bisect_right
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tqdm import tqdm

from geoprim_core._check import AnyArray
from geoprim_core.applications import SortingParams
from geoprim_core.ecc import DetectorParams, detect_from_contours, find_polygons
from geoprim_core.edges import extract_contours
from geoprim_core.errors import BagError, FileError, InputError
from geoprim_core.io.bags import BagImage, BagMessage, BagReader, BagWriter, Topic, bag_image
from geoprim_core.io.camera_message import sort_objects
from geoprim_core.io.images import write_image
from geoprim_core.io.picture import draw_picture
from geoprim_core.io.process_report import BadFrame, ProcessReport, SequenceReport
from geoprim_core.io.record import stamp_of
from geoprim_core.io.shown import OverlayParams
from geoprim_core.io.wire import to_wire
from geoprim_core.types import Contours, Detections, EllipseDetections, Polygons

__all__ = ["BadFrame", "ProcessReport", "SequenceReport", "process_bag"]

GROUND_TRUTH = "ground_truth"


def process_bag(
    source: str | os.PathLike[str],
    output: str | os.PathLike[str],
    *,
    overlays: str | os.PathLike[str] | None = None,
    overlay_every: int = 1,
    params: DetectorParams | None = None,
    sorting: SortingParams | None = None,
    plane_distance: float = 0.0,
    shown: OverlayParams | None = None,
    topic: str = "image",
    progress: bool = True,
    force_progress: bool = False,
) -> ProcessReport:
    """Detect ellipses in every image of a bag and write a bag with the results.

    The result bag has the topics `contours`, `polygons`, `ellipses` and `detections` with the
    headers and times of the images, and copies of `ground_truth`, the camera_info beside the
    image topic and all metadata.

    Parameters
    ----------
    source : path of an .mcap file or of a rosbag2 folder
    output : path of the result bag, an .mcap file; an old one is replaced
    overlays : path of a folder, optional
        Pictures with the results drawn on them, `<sequence>_<number>.png`; the sequence is the
        frame_id of the image.
    overlay_every : int
        Draw every n-th frame of each sequence; 0: only the first.
    params, sorting : DetectorParams, SortingParams, optional
    plane_distance : float
        Distance of the working plane from the camera in metres; 0 where it is not known.
    shown : OverlayParams, optional
        What the overlays show.
    topic : str
        The image topic.
    progress : bool
        Show a progress bar where the standard error output is a terminal.
    force_progress : bool
        Show it anywhere.

    Returns
    -------
    ProcessReport
        A frame that cannot be used is counted there with its reason and does not end the run.

    Raises
    ------
    BagError
        The bag cannot be read, or the topic is missing or holds no images.
    FileError
        The result bag or an overlay cannot be written.
    """
    start = time.perf_counter()
    reader = BagReader(source)
    images = _image_topic(reader, topic)
    target = _new_file(reader, Path(output))
    chain = Chain(params or DetectorParams(), sorting or SortingParams(), plane_distance)
    cameras = _Cameras(reader, images.name.rpartition("/")[0] + "/camera_info")
    folder = None if overlays is None else Path(overlays)
    run = _Run(chain, cameras, folder, overlay_every, shown)
    copied = [t.name for t in reader.topics() if _plain(t.name) == GROUND_TRUTH] + cameras.topics
    with BagWriter(target) as bag, _bar(images.count, progress, force_progress) as bar:
        for name, values in reader.metadata.items():
            bag.add_metadata(name, values)
        bag.add_metadata("geoprim_process", chain.describe())
        for message in reader.messages([images.name, *copied]):
            if message.topic == images.name:
                run.frame(message, bag)
                bar.update()
            else:
                _copy(message, bag)
    return run.report(target, reader, time.perf_counter() - start)


@dataclass(frozen=True)
class Results:
    """What the chain made of one image; `objects` is empty where `unsorted` says why."""

    contours: Contours
    polygons: Polygons
    ellipses: EllipseDetections
    objects: Detections
    unsorted: str


@dataclass(frozen=True)
class Chain:
    """The stages from image to objects with their parameters."""

    params: DetectorParams
    sorting: SortingParams
    plane_distance: float

    def run(self, image: AnyArray, camera_info: Any = None) -> Results:
        """Return what every stage makes of an image; an unusable image raises `InputError`."""
        params = self.params
        contours = extract_contours(image, params.edges)
        polygons = find_polygons(contours, params)
        found = detect_from_contours(contours, polygons, params.ecc)
        try:
            objects = sort_objects(found, self.sorting, camera_info, self.plane_distance)
        except InputError as error:
            none = EllipseDetections.empty(found.image_size)
            objects = sort_objects(none, SortingParams(), None, 0.0)
            return Results(contours, polygons, found, objects, str(error))
        return Results(contours, polygons, found, objects, "")

    def describe(self) -> dict[str, str]:
        """Return all parameters as texts."""
        values = {**self.params.to_dict(), **self.sorting.to_dict()}
        values["plane_distance"] = self.plane_distance
        return {name: str(value) for name, value in values.items()}


class _Cameras:
    """The camera_info messages of a bag by their stamps."""

    def __init__(self, reader: BagReader, topic: str) -> None:
        self.topics = [t.name for t in reader.topics() if _plain(t.name) == _plain(topic)]
        self._infos: dict[int, Any] = {}
        for message in reader.messages(self.topics):
            try:
                self._infos[stamp_of(message.decoded)] = message.decoded
            except (BagError, AttributeError):
                continue  # without it the frame is counted as one that cannot be sorted
        self._stamps = sorted(self._infos)

    def of(self, stamp_ns: int) -> Any:
        """Return the one of a frame, else the newest before it, else None."""
        place = bisect_right(self._stamps, stamp_ns)
        return self._infos[self._stamps[place - 1]] if place else None


class _Run:
    """The state of a run: what was counted and drawn so far."""

    def __init__(
        self,
        chain: Chain,
        cameras: _Cameras,
        overlays: Path | None,
        overlay_every: int,
        shown: OverlayParams | None,
    ) -> None:
        self._chain, self._cameras = chain, cameras
        self._overlays, self._every, self._shown = overlays, overlay_every, shown
        self._sequences: dict[str, SequenceReport] = {}
        self._bad: list[BadFrame] = []
        self._pictures: list[Path] = []

    def frame(self, message: BagMessage, bag: BagWriter) -> None:
        frame = bag_image(message)
        sequence = self._sequences.setdefault(frame.frame_id, SequenceReport(frame.frame_id))
        start = time.perf_counter()
        try:
            if frame.image is None:
                raise InputError("image", "a usable image", frame.reason)
            results = self._chain.run(frame.image, self._cameras.of(frame.stamp_ns))
        except (InputError, MemoryError) as error:
            sequence.bad += 1
            reason = frame.reason or str(error) or type(error).__name__
            self._bad.append(BadFrame(frame.frame_id, frame.stamp_ns, reason))
            return
        sequence.seconds += time.perf_counter() - start
        self._write(results, frame, bag)
        self._draw(results, frame, sequence)
        sequence.frames += 1
        sequence.unsorted += bool(results.unsorted)
        sequence.cut_short += not results.ellipses.complete
        sequence.contours += len(results.contours)
        sequence.ellipses += len(results.ellipses)
        sequence.objects.update(results.objects.labels)

    def report(self, output: Path, reader: BagReader, seconds: float) -> ProcessReport:
        sequences = tuple(self._sequences.values())
        bad, pictures = tuple(self._bad), tuple(self._pictures)
        return ProcessReport(output, sequences, bad, reader.losses, pictures, seconds)

    def _write(self, results: Results, frame: BagImage, bag: BagWriter) -> None:
        method = self._chain.params.polygon_method
        records = {
            "contours": to_wire(results.contours, frame.stamp_ns, frame.frame_id),
            "polygons": to_wire(
                results.polygons,
                frame.stamp_ns,
                frame.frame_id,
                contours=results.contours,
                method=method,
            ),
            "ellipses": to_wire(results.ellipses, frame.stamp_ns, frame.frame_id),
            "detections": to_wire(results.objects, frame.stamp_ns, frame.frame_id),
        }
        for topic, record in records.items():
            bag.write(topic, record, frame.log_time_ns)

    def _draw(self, results: Results, frame: BagImage, sequence: SequenceReport) -> None:
        number = sequence.frames + sequence.bad
        wanted = number % self._every == 0 if self._every > 0 else number == 0
        if self._overlays is None or not wanted or frame.image is None:
            return
        picture = draw_picture(
            frame.image,
            ellipses=results.ellipses,
            detections=results.objects,
            params=self._shown,
            scheme=self._chain.params.ecc.scheme,
        )
        name = re.sub(r"[^\w.-]+", "_", frame.frame_id).strip(".") or "frame"
        path = self._overlays / f"{name}_{number:05d}.png"
        write_image(path, picture)
        self._pictures.append(path)


def _image_topic(reader: BagReader, topic: str) -> Topic:
    reader.images(topic)  # refuses a topic that is missing or of another type
    return reader.topic(topic)


def _new_file(reader: BagReader, target: Path) -> Path:
    if any(target.resolve() == file.resolve() for file in reader.files):
        raise FileError(f"cannot write {target}: it is the bag that is read")
    return target


def _bar(total: int, progress: bool, force: bool) -> tqdm[None]:
    hidden = None if progress else True  # None: tqdm hides itself where there is no terminal
    return tqdm(total=total, unit="frame", file=sys.stderr, disable=False if force else hidden)


def _copy(message: BagMessage, bag: BagWriter) -> None:
    time_ns, text = message.log_time_ns, message.definition
    bag.write_raw(message.topic, message.type, message.raw, time_ns, text)


def _plain(topic: str) -> str:
    return topic.lstrip("/")
