"""Frames to look at, from a bag or from image files, in the rhythm in which they were taken."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from geoprim_core.errors import BagError, GeoprimError, InputError
from geoprim_core.io.bags import BagMessage, BagReader, bag_image
from geoprim_core.io.foxglove_view import View, ViewFrame
from geoprim_core.io.images import read_image
from geoprim_core.io.process import Chain, Results
from geoprim_core.io.record import stamp_of
from geoprim_core.io.shown import OverlayParams, to_show
from geoprim_core.io.wire import from_wire
from geoprim_core.types import Detections, EllipseDetections
from geoprim_core.warm import warm_scenes

_RESULTS = ("ellipses", "detections")
_TIMES_KEPT = 100
_OK, _WARN = 0, 1


class Due(NamedTuple):
    """A frame that is to come: when, and how it is made; making one may raise `GeoprimError`."""

    time_ns: int
    make: Callable[[], ViewFrame]


@dataclass(frozen=True, eq=False)
class Detector:
    """Makes frames to look at with the chain, or with results that are already there."""

    chain: Chain
    style: OverlayParams

    def warm_up(self) -> None:
        """Bring every kernel of the chain to run."""
        for image in warm_scenes():
            self.chain.run(image)

    def frame(self, image: Any, stamp_ns: int, frame_id: str, camera_info: Any) -> ViewFrame:
        """Return the frame of an image with what the chain finds in it."""
        start = time.perf_counter()
        results: Results = self.chain.run(image, camera_info)
        seconds = time.perf_counter() - start
        shown = to_show(results.ellipses, results.objects, self.style)
        return ViewFrame(
            image, shown, stamp_ns, frame_id, results.contours, results.polygons, seconds,
            results.ellipses.reason or results.unsorted,
        )  # fmt: skip


def image_frames(paths: Sequence[Path], detector: Detector, rate_hz: float) -> Iterator[Due]:
    """Yield the images of files, so many a second."""
    for k, path in enumerate(paths):
        stamp = round(k * 1e9 / rate_hz)
        yield Due(stamp, _from_file(path, detector, stamp))


def _from_file(path: Path, detector: Detector, stamp: int) -> Callable[[], ViewFrame]:
    return lambda: detector.frame(read_image(path), stamp, path.stem, None)


class BagFrames:
    """The frames of a bag.

    Parameters
    ----------
    bag : BagReader
    topic : the image topic
    detector : Detector
    results : BagReader, optional
        A bag with `ellipses` and `detections` that `geoprim process` or a live graph made of
        the first one; without, and where a frame has none there, the chain runs.

    Raises
    ------
    BagError
        The topic is missing or holds no images.
    """

    def __init__(
        self, bag: BagReader, topic: str, detector: Detector, results: BagReader | None = None
    ) -> None:
        bag.images(topic)  # refuses what is missing or of another type
        self._bag, self._detector = bag, detector
        self._images = bag.topic(topic).name
        self._cameras = _by_stamp(bag, self._images.rpartition("/")[0] + "/camera_info")
        self._found, self._objects = (
            ({}, {}) if results is None else (_by_stamp(results, name) for name in _RESULTS)
        )

    def __call__(self) -> Iterator[Due]:
        """Yield the frames in the order of their log times."""
        for message in self._bag.messages([self._images]):
            yield Due(message.log_time_ns, self._maker(message))

    def _maker(self, message: BagMessage) -> Callable[[], ViewFrame]:
        return lambda: self._frame(message)

    def _frame(self, message: BagMessage) -> ViewFrame:
        frame = bag_image(message)
        stamp = frame.stamp_ns
        if frame.image is None:
            raise InputError("image", "a usable image", frame.reason)
        if stamp not in self._found:
            info = self._cameras.get(stamp)
            return self._detector.frame(
                frame.image, stamp, frame.frame_id, None if info is None else info.decoded
            )
        found = _decoded(self._found[stamp], EllipseDetections)
        objects = self._objects.get(stamp)
        shown = to_show(
            found,
            None if objects is None else _decoded(objects, Detections),
            self._detector.style,
        )
        return ViewFrame(frame.image, shown, stamp, frame.frame_id, reason=found.reason)


def _by_stamp(bag: BagReader, topic: str) -> dict[int, BagMessage]:
    """Return the messages of a topic by their stamps; nothing where there is none."""
    found: dict[int, BagMessage] = {}
    names = {t.name.lstrip("/") for t in bag.topics()}
    for message in bag.messages([topic]) if topic.lstrip("/") in names else ():
        with suppress(BagError, AttributeError):
            found[stamp_of(message.decoded)] = message
    return found


def _decoded(message: BagMessage, kind: type[Any]) -> Any:
    value = from_wire(message.decoded)
    if not isinstance(value, kind):
        raise InputError(message.topic, f"geoprim_msgs/msg/{kind.__name__}", message.type)
    return value


class Rhythm:
    """Waits until frames are due, in their own rhythm times a rate; never hurries after a delay.

    Parameters
    ----------
    rate : above 0
    clock, sleep : as `time.monotonic` and `time.sleep`

    Examples
    --------
    >>> waited = []
    >>> rhythm = Rhythm(2.0, clock=lambda: sum(waited), sleep=waited.append)
    >>> for time_ns in (0, 1_000_000_000, 3_000_000_000):
    ...     rhythm.wait_for(time_ns)
    >>> waited
    [0.5, 1.0]
    """

    def __init__(
        self,
        rate: float = 1.0,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], object] = time.sleep,
    ) -> None:
        self._rate, self._clock, self._sleep = rate, clock, sleep
        self._last: tuple[int, float] | None = None

    def wait_for(self, time_ns: int) -> None:
        """Wait as long after the frame before as the times are apart; a step back starts anew."""
        if self._last is not None and time_ns > self._last[0]:
            before, at = self._last
            due = at + (time_ns - before) * 1e-9 / self._rate
            delay = due - self._clock()
            if delay > 0:
                self._sleep(delay)
            self._last = time_ns, max(due, self._clock() if delay <= 0 else due)
            return
        self._last = time_ns, self._clock()


@dataclass(eq=False)
class Replay:
    """Shows frames in a view, and says on its diagnostics how that goes.

    Attributes
    ----------
    shown, bad : int
        Frames sent, and frames that could not be used.
    last_reason : str
        Why the last bad one could not.
    """

    view: View
    shown: int = 0
    bad: int = 0
    last_reason: str = ""
    seconds: list[float] = field(default_factory=list)

    def play(self, frames: Iterable[Due], rhythm: Rhythm | None = None) -> None:
        """Send every frame when it is due; without a rhythm at once, at its own time."""
        for due in frames:
            if rhythm is not None:
                rhythm.wait_for(due.time_ns)
                if not self.view.watched():
                    continue
            try:
                frame = due.make()
            except GeoprimError as problem:
                self.bad += 1
                self.last_reason = str(problem)
            else:
                self._show(frame, None if rhythm is not None else due.time_ns)
            self._diagnose(due.time_ns, None if rhythm is not None else due.time_ns)

    def _show(self, frame: ViewFrame, log_time_ns: int | None) -> None:
        self.view.show(frame, log_time_ns)
        self.shown += 1
        if np.isfinite(frame.seconds):
            self.seconds = [*self.seconds[1 - _TIMES_KEPT :], frame.seconds]

    def _diagnose(self, stamp_ns: int, log_time_ns: int | None) -> None:
        values = {
            "frames shown": str(self.shown), "bad": str(self.bad), "last reason": self.last_reason,
        }  # fmt: skip
        if self.seconds:
            p50, p95 = np.percentile(self.seconds, [50, 95]) * 1e3
            values |= {"detection p50 [ms]": f"{p50:.2f}", "detection p95 [ms]": f"{p95:.2f}"}
        status = {
            "level": _WARN if self.bad else _OK,
            "name": "geoprim view: frames",
            "message": self.last_reason if self.bad else "active",
            "hardware_id": "none",
            "values": [{"key": k, "value": v} for k, v in values.items()],
        }
        self.view.diagnose([status], stamp_ns, log_time_ns)
