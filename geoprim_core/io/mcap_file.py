"""One MCAP file, read record by record, so that damage costs no more than the chunk it is in.

The libraries for MCAP stop at the first damaged record or refuse a file without its end. Here
the records are walked by their lengths; where the walk breaks off, the index at the end of the
file, if it is whole, tells where the next chunk starts.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import IO, Any

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, ChunkIndex, Footer, Message, Metadata, Schema, Statistics
from mcap.stream_reader import breakup_chunk

from geoprim_core.errors import BagError

MAGIC = b"\x89MCAP0\r\n"
_HEAD = 9  # opcode and length of a record
_FOOTER = _HEAD + 20
_PRIVATE = 0x80  # from here on opcodes are free for anybody's records
_PARSED: dict[int, Any] = {
    Opcode.SCHEMA: Schema,
    Opcode.CHANNEL: Channel,
    Opcode.STATISTICS: Statistics,
    Opcode.METADATA: Metadata,
}


@dataclass(frozen=True)
class Loss:
    """A part of a file that cannot be read.

    Attributes
    ----------
    bytes : int
        Length of the part in the file.
    messages : int
        How many messages are known to be in it; there may be more.
    reason : str
    """

    bytes: int
    messages: int
    reason: str


@dataclass(frozen=True)
class Losses:
    """What could not be read of a bag, as far as noticed yet.

    Attributes
    ----------
    parts : int
        Number of parts that are lost.
    bytes : int
        Their length in the file.
    messages : int
        How many messages are known to be lost; there may be more.
    reasons : tuple of str
        One a part.
    """

    parts: int
    bytes: int
    messages: int
    reasons: tuple[str, ...]

    def __bool__(self) -> bool:
        """Return True when anything is lost."""
        return self.parts > 0

    def __str__(self) -> str:
        if not self:
            return "nothing is lost"
        first = "; ".join(self.reasons[:3]) + ("; ..." if self.parts > 3 else "")
        known = f", at least {self.messages} messages" if self.messages else ""
        return f"{self.bytes} bytes are lost{known}: {first}"


@dataclass
class _Extent:
    """A chunk, or a message outside of any, and where it lies."""

    start_time: int
    offset: int
    length: int
    opcode: int
    messages: int = 0
    channels: set[int] = field(default_factory=set)
    end_time: int = 0

    def outside(self, since_ns: int | None, until_ns: int | None) -> bool:
        """Tell whether all of it lies before or behind some times."""
        if since_ns is not None and self.start_time <= self.end_time < since_ns:
            return True
        return until_ns is not None and self.start_time > until_ns


class McapFile:
    """The readable part of an MCAP file.

    Attributes
    ----------
    channels, schemas : dict
        Id -> record. Those that only stand inside chunks appear when the chunks are read.
    statistics : Statistics or None
        None where the end of the file is missing.
    metadata : list of (name, values)
    losses : dict
        Offset in the file -> `Loss`, as far as noticed yet.

    Raises
    ------
    BagError
        The file is missing, empty or not an MCAP file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.channels: dict[int, Channel] = {}
        self.schemas: dict[int, Schema] = {}
        self.statistics: Statistics | None = None
        self.metadata: list[tuple[str, dict[str, str]]] = []
        self.losses: dict[int, Loss] = {}
        self._extents: list[_Extent] = []
        try:
            with path.open("rb") as file:
                _check_magic(path, file.read(len(MAGIC)))
                self._scan(file)
        except BagError:
            raise
        except OSError as error:
            raise BagError(f"cannot read {path}: {error.strerror or error}") from None

    @property
    def time_range(self) -> tuple[int, int] | None:
        """The earliest and the latest log time, as the chunks tell; None without a message."""
        filled = [e for e in self._extents if e.messages or e.end_time]
        if not filled:
            return None
        return min(e.start_time for e in filled), max(e.end_time for e in filled)

    def messages(
        self,
        channels: set[int] | None = None,
        since_ns: int | None = None,
        until_ns: int | None = None,
    ) -> Iterator[Message]:
        """Yield the messages of some channels, or all, in the order of their log times.

        Chunks that lie outside of the times asked for are not read; of those that are, all
        messages come.
        """
        pending: list[tuple[int, int, Message]] = []
        serial = 0
        with self.path.open("rb") as file:
            for extent in sorted(self._extents, key=lambda e: (e.start_time, e.offset)):
                if (
                    channels is not None
                    and extent.channels
                    and extent.channels.isdisjoint(channels)
                ):
                    continue
                if extent.outside(since_ns, until_ns):
                    continue
                while pending and pending[0][0] < extent.start_time:
                    yield heapq.heappop(pending)[2]
                for message in self._messages_in(file, extent):
                    if channels is None or message.channel_id in channels:
                        heapq.heappush(pending, (message.log_time, serial, message))
                        serial += 1
        while pending:
            yield heapq.heappop(pending)[2]

    def _messages_in(self, file: IO[bytes], extent: _Extent) -> list[Message]:
        file.seek(extent.offset)
        data = file.read(_HEAD + extent.length)
        try:
            if extent.opcode == Opcode.CHUNK:
                chunk = Chunk.read(_stream(data))
                records = breakup_chunk(chunk, validate_crc=True)
            else:
                records = [Message.read(_stream(data), extent.length)]
        except Exception as error:  # whatever a decompressor or a parser makes of damaged bytes
            self._lose(extent.offset, len(data), f"damaged chunk ({error})", extent.messages)
            return []
        for record in records:
            self._register(record)
        messages = [record for record in records if isinstance(record, Message)]
        known = [m for m in messages if m.channel_id in self.channels]
        if len(known) < len(messages):
            missing = len(messages) - len(known)
            self._lose(extent.offset, 0, "messages of a channel that is not described", missing)
        return known

    def _scan(self, file: IO[bytes]) -> None:
        """Walk over the records of the file and note what lies where."""
        size = file.seek(0, 2)
        position, lost_to = len(MAGIC), 0
        while position < size:
            file.seek(position)
            head = file.read(_HEAD)
            opcode, length = head[0], int.from_bytes(head[1:], "little")
            end = position + _HEAD + length
            if opcode == Opcode.FOOTER and end <= size:
                return
            if len(head) < _HEAD or end > size or not _plausible(opcode):
                end = lost_to = self._skip(file, position, size)
            else:
                self._note(file, position, opcode, length)
            position = end
        if lost_to < size:
            self._lose(size, 0, "the file is cut off: its end is missing")

    def _skip(self, file: IO[bytes], position: int, size: int) -> int:
        """Note a record that cannot be stepped over; return where the next readable part starts."""
        following = [start for start in _indexed_starts(file, size) if start > position]
        end = min(following, default=size)
        reason = "damaged record" if following else "the file is cut off or damaged for good"
        self._lose(position, end - position, reason)
        return end

    def _note(self, file: IO[bytes], position: int, opcode: int, length: int) -> None:
        if opcode == Opcode.CHUNK:
            times = file.read(16)
            start, last = (int.from_bytes(part, "little") for part in (times[:8], times[8:]))
            self._extents.append(_Extent(start, position, length, opcode, end_time=last))
        elif opcode == Opcode.MESSAGE:
            start = int.from_bytes(file.read(14)[6:], "little")
            alone = _Extent(start, position, length, opcode, messages=1, end_time=start)
            self._extents.append(alone)
        elif opcode == Opcode.MESSAGE_INDEX and self._extents:
            self._extents[-1].channels.add(int.from_bytes(file.read(2), "little"))
            self._extents[-1].messages += (length - 6) // 16
        elif opcode in _PARSED:
            try:
                self._register(_PARSED[opcode].read(_stream(b"\0" * _HEAD + file.read(length))))
            except Exception as error:  # whatever a parser makes of damaged bytes
                self._lose(position, _HEAD + length, f"damaged record ({error})")

    def _register(self, record: Any) -> None:
        if isinstance(record, Schema):
            self.schemas[record.id] = record
        elif isinstance(record, Channel):
            self.channels[record.id] = record
        elif isinstance(record, Statistics):
            self.statistics = record
        elif isinstance(record, Metadata):
            self.metadata.append((record.name, dict(record.metadata)))

    def _lose(self, position: int, length: int, reason: str, messages: int = 0) -> None:
        self.losses[position] = Loss(length, messages, f"{reason} at byte {position}")


def _check_magic(path: Path, start: bytes) -> None:
    if start == MAGIC:
        return
    if not start:
        raise BagError(f"{path} is empty: 0 bytes")
    if start.startswith(b"SQLite"):
        raise BagError(f"{path} is an SQLite bag; convert it to MCAP with `ros2 bag convert`")
    raise BagError(f"{path} is not an MCAP file: it starts with {start!r}")


def _stream(record: bytes) -> ReadDataStream:
    """Return a stream that stands behind the head of a record."""
    stream = ReadDataStream(BytesIO(record))
    stream.read(_HEAD)
    return stream


def _plausible(opcode: int) -> bool:
    return Opcode.HEADER <= opcode <= Opcode.DATA_END or opcode >= _PRIVATE


def _indexed_starts(file: IO[bytes], size: int) -> list[int]:
    """Return where the index at the end of the file says that chunks and the index itself start."""
    file.seek(max(0, size - len(MAGIC) - _FOOTER))
    tail = file.read()
    if not tail.endswith(MAGIC) or tail[0] != Opcode.FOOTER:
        return []
    position = Footer.read(_stream(tail)).summary_start
    starts = [position] if 0 < position < size else []
    while 0 < position < size:
        file.seek(position)
        head = file.read(_HEAD)
        opcode, length = head[0], int.from_bytes(head[1:], "little")
        if opcode == Opcode.FOOTER or position + _HEAD + length > size:
            break
        if opcode == Opcode.CHUNK_INDEX:
            index = ChunkIndex.read(_stream(head + file.read(length)))
            starts.append(index.chunk_start_offset)
        position += _HEAD + length
    return starts
