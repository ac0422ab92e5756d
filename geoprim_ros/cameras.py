"""Finding the camera_info of a frame."""

from __future__ import annotations

from collections import OrderedDict
from typing import Any

from geoprim_core.io.record import stamp_of

_KEPT = 30


class CameraInfos:
    """Keeps the last camera_info messages by their stamp."""

    def __init__(self) -> None:
        self._kept: OrderedDict[int, Any] = OrderedDict()

    def add(self, info: Any) -> None:
        """Keep a message; the oldest gives way."""
        self._kept.pop(stamp_of(info), None)
        self._kept[stamp_of(info)] = info
        if len(self._kept) > _KEPT:
            self._kept.popitem(last=False)

    def of(self, message: Any) -> Any:
        """Return the one with the stamp of a message, else the newest, else None."""
        if not self._kept:
            return None
        return self._kept.get(stamp_of(message)) or next(reversed(self._kept.values()))
