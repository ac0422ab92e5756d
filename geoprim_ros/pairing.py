"""Pairing messages of several topics by their exact stamp."""

from __future__ import annotations

from collections import OrderedDict
from typing import Any

from geoprim_core.io.record import stamp_of


class StampPairs:
    """Waits for messages with one stamp on several topics; bounded, the oldest give way.

    Parameters
    ----------
    topics : names of the topics of a complete set
    limit : number of incomplete stamps that are kept

    Examples
    --------
    >>> from geoprim_core.io.record import Record, header
    >>> pairs = StampPairs(("contours", "polygons"))
    >>> message = Record("any", {"header": header(7, "camera")})
    >>> pairs.add("contours", message) is None
    True
    >>> pairs.add("polygons", message) == {"contours": message, "polygons": message}
    True
    """

    def __init__(self, topics: tuple[str, ...], limit: int = 10) -> None:
        self.topics = topics
        self.limit = limit
        self.unpaired = 0
        self._waiting: OrderedDict[int, dict[str, Any]] = OrderedDict()

    def clear(self) -> None:
        """Forget what waits; it is not counted, as nobody waits for it any more."""
        self._waiting.clear()

    def add(self, topic: str, message: Any) -> dict[str, Any] | None:
        """Keep a message; return topic -> message when it completes the set of its stamp."""
        stamp = stamp_of(message)
        found = self._waiting.setdefault(stamp, {})
        self.unpaired += topic in found  # an earlier one with the same stamp is replaced
        found[topic] = message
        if len(found) == len(self.topics):
            return self._waiting.pop(stamp)
        if len(self._waiting) > self.limit:
            self.unpaired += len(self._waiting.popitem(last=False)[1])
        return None
