"""The records of MCAP: where one can start and end, so that a damaged file is not believed.

A record is an opcode, a length and a body. Most bodies repeat their length in the lengths of
their parts; a place where these do not agree holds no record.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from typing import IO, Any

from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.opcode import Opcode
from mcap.records import Message

MAGIC = b"\x89MCAP0\r\n"
HEAD = 9  # opcode and length of a record
FOOTER_BODY = 20
MESSAGE_BODY = struct.Struct("<HIQQ")
PRIVATE = 0x80  # from here on opcodes are free for anybody's records
_HEAD = struct.Struct("<BQ")
_CHUNK = struct.Struct("<BQQQQII")
_LONGEST_NAME = 4096
_SMALL, _BLOCK = 256, 4096  # small reads come from a block that is kept
_STARTS = {"zstd": b"\x28\xb5\x2f\xfd", "lz4": b"\x04\x22\x4d\x18"}


class View:
    """The bytes of an open file by their offsets; a read beyond the end is short."""

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        self._block, self._base = b"", 0
        self.size = file.seek(0, 2)

    def at(self, offset: int, length: int) -> bytes:
        """Return the bytes at an offset."""
        if length > _SMALL:
            self._file.seek(offset)
            return self._file.read(min(length, max(self.size - offset, 0)))
        place = offset - self._base
        if not 0 <= place <= len(self._block) - length:
            self._file.seek(offset)
            self._block, self._base, place = self._file.read(_BLOCK), offset, 0
        return self._block[place : max(min(offset + length, self.size) - self._base, place)]

    def number(self, offset: int, length: int) -> int:
        """Return a little-endian number; beyond the end one that fits nowhere."""
        data = self.at(offset, length)
        return int.from_bytes(data, "little") if len(data) == length else 1 << 64


@dataclass
class ChunkHead:
    """The head of a chunk and where its data lie.

    Attributes
    ----------
    offset, end : int
        Of the record; `end` is where the chunk says it ends.
    start_time, end_time, size, crc : int
        Of the messages; of the unpacked data.
    compression : str
    data_offset, data_length : int
    consistent : bool
        Its lengths agree with each other.
    """

    offset: int
    end: int
    start_time: int
    end_time: int
    size: int
    crc: int
    compression: str
    data_offset: int
    data_length: int
    consistent: bool

    @property
    def signature(self) -> tuple[int, int, int, int, str]:
        """What the index at the end of the file repeats of it."""
        return (self.start_time, self.end_time, self.size, self.data_length, self.compression)


def record_head(view: View, position: int) -> tuple[int, int]:
    """Return opcode and length of what stands at a place; opcode 0 where the file ends."""
    raw = view.at(position, HEAD)
    return _HEAD.unpack(raw) if len(raw) == HEAD else (0, 0)


def record_end(view: View, position: int) -> int | None:
    """Return where the record at a place ends, None where there is no whole record."""
    opcode, length = record_head(view, position)
    body = position + HEAD
    if body + length > view.size or not (opcode in _CHECKS or opcode >= PRIVATE):
        return None
    check = _CHECKS.get(opcode)
    return body + length if check is None or check(view, body, length) else None


def chunk_head(view: View, position: int) -> ChunkHead | None:
    """Return the chunk that starts at a place, also one whose head is damaged in part."""
    raw = view.at(position, _CHUNK.size)
    if len(raw) < _CHUNK.size:
        return None
    opcode, length, start, end, size, crc, name_length = _CHUNK.unpack(raw)
    name = view.at(position + _CHUNK.size, min(name_length, 17))
    data_offset = position + _CHUNK.size + name_length + 8
    if len(name) != name_length or not name.isascii() or data_offset > view.size:
        return None
    data_length = view.number(data_offset - 8, 8)
    consistent = opcode == Opcode.CHUNK and length == 40 + name_length + data_length
    head = ChunkHead(
        position, position + HEAD + length, start, end, size, crc, name.decode(),
        data_offset, data_length, consistent,
    )  # fmt: skip
    return head if consistent or _looks_like_chunk(view, head) else None


def parse_record(kind: Any, body: bytes) -> Any:
    """Return a record of the library's class `kind`, None where the body is not one.

    The library takes what is short or does not agree as it comes; so the record is written again
    and has to give the bytes that it was read from.
    """
    try:
        record = kind.read(stream(body))
        builder = RecordBuilder()
        record.write(builder)
    except Exception:  # whatever a parser makes of damaged bytes
        return None
    return record if builder.end()[HEAD:] == body else None


def stream(body: bytes) -> ReadDataStream:
    """Return a stream as the parsers of the library take it."""
    return ReadDataStream(BytesIO(body))


def _looks_like_chunk(view: View, head: ChunkHead) -> bool:
    if head.start_time > head.end_time or head.compression not in ("", *_STARTS):
        return False
    if head.compression:
        return view.at(head.data_offset, 4) == _STARTS[head.compression]
    opcode, length = record_head(view, head.data_offset)
    fits = head.data_offset + HEAD + length <= view.size
    return opcode in (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE) and fits and length > 0


def _after_strings(view: View, at: int, count: int) -> int:
    """Return where some texts, each behind its length, end; beyond any file if they cannot be."""
    for _ in range(count):
        length = view.number(at, 4)
        if length > _LONGEST_NAME:
            return 1 << 64
        at += 4 + length
    return at


def _texts(before: int, count: int, after: int = 0) -> Callable[[View, int, int], bool]:
    """Check a body of some bytes, some texts and some bytes."""

    def check(view: View, body: int, length: int) -> bool:
        return _after_strings(view, body + before, count) + after == body + length

    return check


def _texts_and_data(before: int, count: int, width: int, after: int = 0) -> Any:
    """Check a body of some bytes, some texts, a length of some width and its data."""

    def check(view: View, body: int, length: int) -> bool:
        at = _after_strings(view, body + before, count)
        return at + width + after <= body + length and (
            at + width + view.number(at, width) + after == body + length
        )

    return check


def _entries(before: int, width: int) -> Callable[[View, int, int], bool]:
    """Check a body of some bytes and an array of entries of some width."""

    def check(view: View, body: int, length: int) -> bool:
        array = view.number(body + before, 4)
        return array % width == 0 and before + 4 + array == length

    return check


def _chunk(view: View, body: int, length: int) -> bool:
    head = chunk_head(view, body - HEAD)
    return head is not None and head.consistent


def _chunk_index(view: View, body: int, length: int) -> bool:
    array = view.number(body + 32, 4)
    if array % 10 or array > length:
        return False
    return _after_strings(view, body + 36 + array + 8, 1) + 16 == body + length


_CHECKS: dict[int, Callable[[View, int, int], bool]] = {
    Opcode.HEADER: _texts(0, 2),
    Opcode.FOOTER: lambda view, body, length: length == FOOTER_BODY,
    Opcode.SCHEMA: _texts_and_data(2, 2, 4),
    Opcode.CHANNEL: _texts_and_data(4, 2, 4),
    Opcode.MESSAGE: lambda view, body, length: length >= MESSAGE_BODY.size,
    Opcode.CHUNK: _chunk,
    Opcode.MESSAGE_INDEX: _entries(2, 16),
    Opcode.CHUNK_INDEX: _chunk_index,
    Opcode.ATTACHMENT: _texts_and_data(16, 2, 8, 4),
    Opcode.ATTACHMENT_INDEX: _texts(40, 2),
    Opcode.STATISTICS: _entries(42, 10),
    Opcode.METADATA: _texts_and_data(0, 1, 4),
    Opcode.METADATA_INDEX: _texts(16, 1),
    Opcode.SUMMARY_OFFSET: lambda view, body, length: length == 17,
    Opcode.DATA_END: lambda view, body, length: length == 4,
}


def message_key(message: Message) -> int:
    """Return a number by which equal messages are told."""
    return hash((
        message.channel_id, message.sequence, message.log_time, message.publish_time,
        len(message.data), zlib.crc32(message.data),
    ))  # fmt: skip
