"""The summary at the end of an MCAP file, and whether the file is as it says."""

from __future__ import annotations

import struct
import zlib
from bisect import bisect_right
from collections import defaultdict
from dataclasses import dataclass, field
from typing import Any

from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, Schema, Statistics

from geoprim_core.io.losses import Loss
from geoprim_core.io.mcap_extent import Extent
from geoprim_core.io.mcap_records import (
    FOOTER_BODY,
    HEAD,
    View,
    parse_record,
    record_end,
    record_head,
)
from geoprim_core.io.mcap_scan import Scan

_FOOTER = struct.Struct("<QQI")
_PARSED: dict[int, Any] = {
    Opcode.SCHEMA: Schema,
    Opcode.CHANNEL: Channel,
    Opcode.CHUNK_INDEX: ChunkIndex,
    Opcode.STATISTICS: Statistics,
}
_LARGEST = 1 << 29


@dataclass
class Summary:
    """What the end of a file says of the file.

    Attributes
    ----------
    proved : bool
        Its checksum holds; False also where it has none.
    shift : int
        How many bytes were put in (above 0) or taken out before it.
    disowned : bool
        It is that of another file.
    statistics : Statistics or None
    definitions : list of Schema and Channel
    chunks : list of ChunkIndex
    """

    proved: bool
    shift: int
    disowned: bool = False
    statistics: Statistics | None = None
    definitions: list[Any] = field(default_factory=list)
    chunks: list[ChunkIndex] = field(default_factory=list)


def read_summary(scan: Scan) -> Summary | None:
    """Return the summary of a file, None where there is none or it is damaged, which is noted."""
    if scan.footer is None:
        return None
    start, _, crc = _FOOTER.unpack(scan.view.at(scan.footer + HEAD, FOOTER_BODY))
    if not start and scan.summary in (None, scan.footer):
        return None
    for place in dict.fromkeys((start, scan.summary)):
        if place is not None and _holds(scan.view, place, scan.footer, crc):
            summary = _parsed(scan.view, place, scan.footer, Summary(crc != 0, place - start))
            if summary is not None:
                return summary
    place = min(scan.summary or scan.footer, scan.footer)
    scan.lose(place, scan.footer - place, "the index at the end is damaged")
    return None


def compare(scan: Scan, summary: Summary) -> None:
    """Tie the chunks to their lines in the index; what is missing or too much is a loss."""
    chunks = [extent for extent in scan.extents if extent.head is not None]
    missing = _tie(chunks, summary)
    if summary.chunks and _of_another_file(chunks, summary):
        _disown(scan, chunks, summary)
        return
    _note_missing(scan, missing, summary.shift)
    for extent in chunks:
        if extent.listed is None and summary.chunks:
            extent.stray = summary.proved
            reason = "a chunk that the index does not list"
            scan.losses.setdefault(extent.offset, Loss(extent.offset, 0, reason))
        elif extent.listed is not None:
            extent.start_time = extent.listed.message_start_time
            extent.broken |= extent.head is None or extent.head.signature != _signature(
                extent.listed
            )
    if summary.shift:
        verb = "more" if summary.shift > 0 else "fewer"
        text = f"the file has {abs(summary.shift)} bytes {verb} than its index says"
        scan.losses.setdefault(scan.view.size, Loss(scan.view.size, 0, text))
    counted = sum(extent.counted for extent in scan.extents)
    if not summary.proved and counted and not _agrees(summary, counted):
        scan.lose(scan.view.size, 0, "the numbers at the end are not those of the file")
        summary.statistics = None


def _of_another_file(chunks: list[Extent], summary: Summary) -> bool:
    """Return whether an index does not know what stands before any place where the walk broke."""
    known = {_signature(line) for line in summary.chunks}
    unknown = [e for e in chunks if e.listed is None and e.head and e.head.signature not in known]
    safe = [e for e in chunks if not e.orphan]
    foreign = sum(not e.orphan for e in unknown)
    return foreign > sum(e.listed is not None for e in safe) or (bool(unknown) and not safe)


def _disown(scan: Scan, chunks: list[Extent], summary: Summary) -> None:
    """Take nothing for granted that an index says which is not that of the file."""
    for extent in chunks:
        extent.listed = None
    summary.proved, summary.disowned, summary.statistics = False, True, None
    place = min(scan.summary or scan.view.size, scan.view.size)
    scan.losses.setdefault(place, Loss(place, 0, "the index at the end is not that of this file"))


def _agrees(summary: Summary, counted: int) -> bool:
    return summary.statistics is None or summary.statistics.message_count == counted


def _holds(view: View, start: int, footer: int, crc: int) -> bool:
    """Return whether the checksum of a summary that starts at a place is right, or not given."""
    length = footer + HEAD + FOOTER_BODY - 4 - start
    if start <= 0 or start > footer or length > _LARGEST:
        return False
    return crc == 0 or zlib.crc32(view.at(start, length)) == crc


def _parsed(view: View, position: int, footer: int, summary: Summary) -> Summary | None:
    while position < footer:
        end = record_end(view, position)
        if end is None or end > footer:
            return None
        kind = _PARSED.get(record_head(view, position)[0])
        if kind is not None:
            record = parse_record(kind, view.at(position + HEAD, end - position - HEAD))
            if record is None:
                return None
            _file(record, summary)
        position = end
    return summary


def _file(record: Any, summary: Summary) -> None:
    if isinstance(record, ChunkIndex):
        summary.chunks.append(record)
    elif isinstance(record, Statistics):
        summary.statistics = record
    else:
        summary.definitions.append(record)


def _tie(chunks: list[Extent], summary: Summary) -> list[ChunkIndex]:
    """Give each chunk its line in the index, first by place and contents; return lines left."""
    left = _tie_by(
        chunks, summary.chunks,
        lambda e: (e.offset, e.head.signature if e.head else None),
        lambda i: (i.chunk_start_offset, _signature(i)),
    )  # fmt: skip
    left = _tie_by(chunks, left, lambda e: e.head.signature if e.head else None, _signature)
    at = {e.offset: e for e in chunks if e.listed is None}
    return [line for line in left if not _tie_damaged(at.get(line.chunk_start_offset), line)]


def _tie_damaged(extent: Extent | None, line: ChunkIndex) -> bool:
    """Give a chunk the line for its place when all but one fact of its head agree."""
    if extent is None or extent.head is None:
        return False
    equal = sum(a == b for a, b in zip(extent.head.signature, _signature(line), strict=True))
    if equal >= 4:
        extent.listed = line
    return equal >= 4


def _tie_by(chunks: list[Extent], lines: list[ChunkIndex], of: Any, key: Any) -> list[ChunkIndex]:
    places: dict[Any, list[Extent]] = defaultdict(list)
    for extent in reversed(chunks):
        if extent.listed is None:
            places[of(extent)].append(extent)
    left = []
    for line in lines:
        found = places.get(key(line))
        if found:
            extent = found.pop()
            extent.listed = line
        else:
            left.append(line)
    return left


def _signature(line: ChunkIndex) -> tuple[int, int, int, int, str]:
    return (
        line.message_start_time,
        line.message_end_time,
        line.uncompressed_size,
        line.compressed_size,
        line.compression,
    )


def _note_missing(scan: Scan, lines: list[ChunkIndex], shift: int) -> None:
    """Note chunks that are gone, each with the loss at its place where there is one."""
    holes = [] if shift else sorted(scan.losses.items(), key=lambda item: item[0])
    holes = [(offset, loss) for offset, loss in holes if loss.bytes]
    ends = [offset + loss.bytes for offset, loss in holes]
    for line in lines:
        start = line.chunk_start_offset
        near = bisect_right(ends, start)
        if near < len(holes) and holes[near][0] < start + line.chunk_length:
            loss = holes[near][1]
        else:
            while start in scan.losses:
                start += 1
            loss = scan.lose(start, 0, "a chunk that the index lists is missing")
        loss.span(line.message_start_time, line.message_end_time)
