"""The walk over the records of an MCAP file, and how it goes on behind damage.

A record is stepped over by its length. Where that leads to no record, the file is searched for
the next place that can only be the start of one. A chunk whose end leads nowhere and whose
checksum fails is searched itself: with bytes missing inside, it reaches into its successors.
"""

from __future__ import annotations

import struct
import zlib
from typing import Any

from mcap.opcode import Opcode
from mcap.records import Channel, Header, Metadata, Schema, Statistics

from geoprim_core.io.losses import Loss
from geoprim_core.io.mcap_chunks import INSIDE, unpack
from geoprim_core.io.mcap_extent import Extent
from geoprim_core.io.mcap_records import (
    HEAD,
    MAGIC,
    MESSAGE_BODY,
    PRIVATE,
    ChunkHead,
    View,
    chunk_head,
    parse_record,
    record_end,
    record_head,
)
from geoprim_core.io.mcap_search import candidates, trailing_zeros

_PARSED: dict[int, Any] = {
    Opcode.HEADER: Header,
    Opcode.SCHEMA: Schema,
    Opcode.CHANNEL: Channel,
    Opcode.STATISTICS: Statistics,
    Opcode.METADATA: Metadata,
}
_LARGEST_RECORD = 1 << 26
_FEWEST_ZEROS = 16


class Scan:
    """What lies where in a file.

    Attributes
    ----------
    extents : list of Extent
    records : list of (offset, record)
        The schemas, channels, headers, metadata and statistics outside of chunks.
    attachments : list of (offset, length)
    losses : dict
        Offset -> `Loss`.
    footer, summary : int or None
        Where the last footer and the records behind the end of the data start.
    data_crc : int
        Checksum of the data section or 0.
    """

    def __init__(self, view: View) -> None:
        self.view = view
        self.extents: list[Extent] = []
        self.records: list[tuple[int, Any]] = []
        self.attachments: list[tuple[int, int]] = []
        self.losses: dict[int, Loss] = {}
        self.footer: int | None = None
        self.summary: int | None = None
        self.data_crc = 0
        self._last: Extent | Loss | None = None
        self._last_private: int | None = None
        self._chunks = 0
        self._work = 8 * view.size + (1 << 26)  # how much may be unpacked while searching
        self._guess = self._broken_off = False
        self._cut_zeros()
        self._walk()
        if not self.extents and self.losses:
            self._guess, self._broken_off = True, False  # perhaps it has no chunks at all
            self.records, self.attachments, self._last = [], [], None
            self.losses = {at: loss for at, loss in self.losses.items() if at >= view.size}
            self._walk()

    def lose(self, offset: int, length: int, reason: str, **facts: Any) -> Loss:
        """Note a loss."""
        loss = self.losses[offset] = Loss(offset, length, reason, **facts)
        return loss

    def _walk(self) -> None:
        position = len(MAGIC)
        if self.view.at(0, len(MAGIC)) != MAGIC:
            position = self._start()
        while position < self.view.size:
            position = self._step(position)
        reached = max((loss.offset + loss.bytes for loss in self.losses.values()), default=0)
        if position == self.view.size and reached < position:
            self.lose(position, 0, "the file is cut off: its end is missing")

    def _start(self) -> int:
        """Note that the file does not start as it should; return where its records do."""
        if record_end(self.view, len(MAGIC)) is not None:
            self.lose(0, len(MAGIC), "the mark at the start is damaged")
            return len(MAGIC)
        return self._skip(0, 0, "the start is damaged")

    def _step(self, position: int) -> int:
        """Take in what stands at a place; return where to go on."""
        end = record_end(self.view, position)
        if end is None:
            head = chunk_head(self.view, position)
            return self._recover(position) if head is None else self._open_chunk(head)
        opcode = record_head(self.view, position)[0]
        if opcode == Opcode.FOOTER:
            return self._end(position, end)
        if opcode >= PRIVATE and self._disguised(position, end):
            return end
        self._note(opcode, position, end)
        return end

    def _open_chunk(self, head: ChunkHead) -> int:
        """Take in a chunk that is not known to end where it says."""
        ends = (head.data_offset + head.data_length, head.end)
        sure = (end for end in ends if end < self.view.size and self._known(end))
        extent = Extent(head, head.offset, head.end, head.start_time, broken=True)
        self._add(extent)
        extent.end = next(sure, None) or self._next_start(head.data_offset)
        extent.cut = extent.end >= self.view.size
        return extent.end

    def _disguised(self, position: int, end: int) -> bool:
        """Take in a chunk with a damaged opcode, which its checksum tells from private records."""
        head = chunk_head(self.view, position)
        if head is None or head.data_offset + head.data_length > end:
            return False
        extent = Extent(head, position, end, head.start_time)
        if not self._proved(extent):
            return False
        extent.broken = True
        self._add(extent)
        return True

    def _end(self, footer: int, end: int) -> int:
        """Take in a footer; return where to go on, behind the file at its true end."""
        self.footer, self._last = footer, None
        rest = self.view.size - end
        if self.view.at(end, len(MAGIC)) == MAGIC and rest == len(MAGIC):
            return self.view.size + 1
        if rest <= len(MAGIC):
            self.lose(end, rest, "the mark at the end is missing or damaged")
            return self.view.size + 1
        if self.view.at(end, len(MAGIC)) == MAGIC:
            end += len(MAGIC)
        self.lose(end, 0, "something follows behind the end")
        return end

    def _recover(self, position: int) -> int:
        """Go on behind a place where no record starts."""
        start, lost, last = position + 1, 0, self._last
        if isinstance(last, Extent) and last.end == position:
            if last.head is None:  # its length led astray
                self.extents.pop()
                position, start, lost = last.offset, last.offset + 1, 1
            elif not self._proved(last):
                start = last.head.data_offset
        elif self._last_private is not None:
            start = position = self._last_private
            start += 1
        following = self._next_start(start)
        if isinstance(last, Extent) and following < position:
            last.end, last.broken = following, True
            return following
        return self._skip(position, following, "damaged record", lost)

    def _skip(self, position: int, following: int, reason: str, messages: int = 0) -> int:
        following = following or self._next_start(position)
        if following >= self.view.size:
            reason = "the file is cut off or damaged for good"
        self._last = self.lose(position, following - position, reason, messages=messages)
        self._last_private = None
        return following

    def _proved(self, extent: Extent) -> bool:
        """Return whether the checksum of a chunk holds; False once too much was unpacked."""
        head = extent.head
        if head is None or not head.crc or self._work < 0:
            return False
        unpacked = unpack(head.compression, extent.data(self.view), head.size)
        self._work -= len(unpacked.data) + head.data_length
        return zlib.crc32(unpacked.data) == head.crc

    def _note(self, opcode: int, position: int, end: int) -> None:
        """Take in a record whose end is known."""
        private = self._last_private
        self._last_private = position if opcode >= PRIVATE else None
        if opcode == Opcode.CHUNK:
            head = chunk_head(self.view, position)
            assert head is not None
            self._add(Extent(head, position, end, head.start_time))
        elif opcode == Opcode.MESSAGE:
            # between chunks none is expected: the length of the chunk before led astray
            self._broken_off |= self._chunks > 0
            body = self.view.at(position + HEAD, MESSAGE_BODY.size)
            time = MESSAGE_BODY.unpack(body)[2]
            self._add(Extent(None, position, end, time, counted=1))
        elif opcode == Opcode.MESSAGE_INDEX:
            self._note_index(position, end, private)
        else:
            self._last = None
            self._note_other(opcode, position, end)

    def _note_other(self, opcode: int, position: int, end: int) -> None:
        body = position + HEAD
        if opcode == Opcode.DATA_END:
            self.summary, self.data_crc = end, self.view.number(body, 4)
        elif opcode == Opcode.ATTACHMENT:
            self.attachments.append((body, end - body))
        elif opcode in _PARSED:
            small = end - body <= _LARGEST_RECORD
            record = (
                parse_record(_PARSED[opcode], self.view.at(body, end - body)) if small else None
            )
            if record is None:
                self.lose(position, end - position, "damaged record")
            else:
                self.records.append((position, record))

    def _note_index(self, position: int, end: int, private: int | None) -> None:
        """Take in how many messages the chunk before holds, or held."""
        channel = self.view.number(position + HEAD, 2)
        body = self.view.at(position + HEAD + 6, min(end - position, _LARGEST_RECORD))
        times = [time for time, _ in struct.iter_unpack("<QQ", body[: len(body) // 16 * 16])]
        if self._last is None or (isinstance(self._last, Extent) and self._last.head is None):
            place = position if private is None else private
            self._last = self.lose(place, position - place, "the chunk before an index is missing")
        count, last = (end - position - HEAD - 6) // 16, self._last
        if isinstance(last, Loss):
            last.messages += count
            if times:
                last.span(min(times), max(times))
            return
        last.channels.add(channel)
        last.counted += count
        last.times = _hull(last.times, times)

    def _add(self, extent: Extent) -> None:
        extent.orphan = self._broken_off
        self._chunks += extent.head is not None
        self.extents.append(extent)
        self._last, self._last_private = extent, None

    def _next_start(self, start: int) -> int:
        """Return the next place that can only be the start of a record, else the end.

        What stands inside chunks is not taken for a record outside: its checksum is the chunk's.
        """
        own = () if self._guess or len(self.extents) > self._chunks else INSIDE
        self._broken_off = True
        places = candidates(self.view, start, own)
        return next((p for p in places if self._starts(p)), self.view.size)

    def _starts(self, position: int) -> bool:
        opcode = record_head(self.view, position)[0]
        if opcode == Opcode.CHUNK:
            head = chunk_head(self.view, position)
            # its lengths agree with each other: by chance once in 2**64 places
            return head is not None and head.consistent and head.start_time <= head.end_time
        end = record_end(self.view, position)
        return end is not None and self._known(end)

    def _known(self, position: int) -> bool:
        """Return whether something stands at a place that a record may end at."""
        if position == self.view.size or self.view.at(position, len(MAGIC)) == MAGIC:
            return True
        return record_end(self.view, position) is not None or (
            chunk_head(self.view, position) is not None
        )

    def _cut_zeros(self) -> None:
        zeros = trailing_zeros(self.view)
        if zeros >= _FEWEST_ZEROS:
            self.view.size -= zeros
            self.lose(self.view.size, zeros, "the file ends in zeros")


def _hull(times: tuple[int, int] | None, more: list[int]) -> tuple[int, int] | None:
    every = [*(times or ()), *more]
    return (min(every), max(every)) if every else None
