"""What one chunk of a damaged or whole file gives, and how far it can be believed."""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from itertools import chain

from geoprim_core.io.losses import Loss
from geoprim_core.io.mcap_catalogue import Grade
from geoprim_core.io.mcap_chunks import (
    LARGEST_CHUNK,
    Content,
    Unpacked,
    message_of,
    split,
    unpack,
)
from geoprim_core.io.mcap_extent import Extent
from geoprim_core.io.mcap_records import HEAD, ChunkHead, View

_DOUBTS = {
    Grade.WRONG: "the checksum of its chunk fails",
    Grade.DOUBTFUL: "its checksum is missing, as its chunk is damaged or cut off",
}


@dataclass
class Reading:
    """The records of an extent with the grade of all of them and what is wrong, if anything.

    `unpacked` is how many bytes it took.
    """

    content: Content
    grade: Grade
    fault: str = ""
    unpacked: int = 0

    @property
    def doubt(self) -> str:
        """Why its messages may be wrong; empty when nothing speaks against them."""
        return _DOUBTS.get(self.grade, "")

    def loss(self, extent: Extent, delivered: int) -> Loss | None:
        """Return what is lost or doubtful when so many of the messages are passed on."""
        if not (self.fault or self.doubt or extent.stray):
            return None
        present = len(self.content.messages)
        missing = max(extent.counted, present) - delivered
        kept = delivered if self.doubt or extent.stray else 0
        loss = Loss(extent.offset, extent.end - extent.offset, self._reason(extent), missing, kept)
        if self.grade is Grade.PROVED and not missing:
            loss.bytes = 0
        else:
            _span(loss, extent, self.content)
        return loss

    def _reason(self, extent: Extent) -> str:
        if self.grade is Grade.PROVED:
            stray = "a chunk that the index does not list" if extent.stray else ""
            return stray or f"chunk with a damaged head ({self.fault})"
        if extent.cut:
            return f"the file is cut off within a chunk ({self.fault})"
        return f"damaged chunk ({self.fault or self.doubt})"


def read_extent(view: View, extent: Extent, *, checksums: bool) -> Reading:
    """Return what an extent gives; `checksums` tells whether chunks of this file have them."""
    if extent.end - extent.offset > LARGEST_CHUNK:
        return Reading(Content(), Grade.WRONG, f"it is larger than {LARGEST_CHUNK} bytes")
    if extent.given_up:
        return Reading(Content(), Grade.WRONG, "not unpacked: too much before it was wrong")
    if extent.head is None:
        body = view.at(extent.offset + HEAD, extent.end - extent.offset - HEAD)
        return Reading(Content([message_of(body)]), Grade.DOUBTFUL if checksums else Grade.PLAIN)
    unpacked, grade = _best(extent.head, extent, extent.data(view), checksums)
    content = split(unpacked.data)
    fault = _fault(extent, unpacked, content, grade)
    return Reading(content, grade, fault, len(unpacked.data))


def _best(head: ChunkHead, extent: Extent, data: bytes, checksums: bool) -> tuple[Unpacked, Grade]:
    """Return the data with the best grade of those that a damaged head leaves possible."""
    lengths = [len(data)]
    if extent.broken and not head.compression:
        lengths += [n for n in (head.data_length, head.size) if 0 < n < len(data)]
    tried = []
    for length in lengths:
        unpacked = unpack(head.compression, data[:length], head.size)
        tried.append((unpacked, _grade(head, extent, unpacked, checksums)))
        if tried[-1][1] is Grade.PROVED:
            return tried[-1]
    return tried[0]


def _grade(head: ChunkHead, extent: Extent, unpacked: Unpacked, checksums: bool) -> Grade:
    if head.crc:
        if zlib.crc32(unpacked.data) == head.crc:
            return Grade.PROVED
        early = extent.cut and not unpacked.contradicted
        return Grade.DOUBTFUL if early else Grade.WRONG
    if unpacked.contradicted or (unpacked.fault and not extent.cut):
        return Grade.WRONG
    whole = not unpacked.fault and not extent.broken and not checksums
    return Grade.PLAIN if whole else Grade.DOUBTFUL


def _fault(extent: Extent, unpacked: Unpacked, content: Content, grade: Grade) -> str:
    if grade is Grade.PROVED:
        if content.fault:
            return content.fault
        if extent.broken or unpacked.fault:
            return "its messages are whole"
        times = [message.log_time for message in content.messages]
        indexed = extent.times is not None and extent.counted == len(times)
        return "the index behind it" if indexed and extent.times != (min(times), max(times)) else ""
    if unpacked.fault or content.fault:
        return unpacked.fault or content.fault
    return "its checksum fails" if grade is Grade.WRONG else ""


def _span(loss: Loss, extent: Extent, content: Content) -> None:
    """Give a loss the log times that its messages can have."""
    times = list(chain(extent.times or (), (m.log_time for m in content.messages)))
    if extent.listed is not None:
        times += [extent.listed.message_start_time, extent.listed.message_end_time]
    elif extent.head is not None and extent.head.start_time <= extent.head.end_time:
        times += [extent.head.start_time, extent.head.end_time]
    if times:
        loss.span(min(times), max(times))
