"""Finding the camera_info of a frame: the one with its stamp, which may come after it."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from typing import Any

from geoprim_core.io.record import stamp_of
from geoprim_core.params import Params, option

# A reliable, deep queue of images may be that many frames behind its camera_info.
_KEPT = 300
_WAITING = 10


@dataclass(frozen=True)
class CameraParams(Params):
    """How a frame finds its camera_info."""

    camera_info_sync: str = option(
        "exact",
        "use the camera_info with the stamp of the frame, or the latest one",
        choices=("exact", "latest"),
    )


class CameraInfos:
    """Keeps the last camera_info messages by their stamp, and frames that wait for theirs.

    Examples
    --------
    >>> from geoprim_core.io.record import Record, header
    >>> infos, info = CameraInfos(), Record("info", {"header": header(7, "camera")})
    >>> frame = Record("frame", {"header": header(7, "camera")})
    >>> infos.wait(frame, "what was found")
    >>> infos.add(info) == ("what was found", frame)
    True
    """

    def __init__(self) -> None:
        self._kept: OrderedDict[int, Any] = OrderedDict()
        self._waiting: OrderedDict[int, tuple[Any, Any]] = OrderedDict()

    def add(self, info: Any) -> tuple[Any, Any] | None:
        """Keep a message; return what waited for it and the frame, if any."""
        stamp = stamp_of(info)
        self._kept.pop(stamp, None)
        self._kept[stamp] = info
        if len(self._kept) > _KEPT:
            self._kept.popitem(last=False)
        return self._waiting.pop(stamp, None)

    def exact(self, frame: Any) -> Any:
        """Return the one with the stamp of a frame, or None."""
        return self._kept.get(stamp_of(frame))

    def latest(self) -> Any:
        """Return the one that came last, or None."""
        return next(reversed(self._kept.values())) if self._kept else None

    def wait(self, frame: Any, found: Any) -> None:
        """Keep what was found in a frame until its camera_info comes."""
        self._waiting[stamp_of(frame)] = (found, frame)

    def overdue(self, limit: int = _WAITING) -> list[tuple[Any, Any]]:
        """Return what has waited for more than some frames, oldest first; it waits no longer."""
        count = max(0, len(self._waiting) - limit)
        return [self._waiting.popitem(last=False)[1] for _ in range(count)]
