"""The inside of MCAP chunks: unpacked within bounds, and records as far as they can be told."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import lz4.frame
import zstandard
from mcap.opcode import Opcode
from mcap.records import Channel, Message, Schema

from geoprim_core.io.mcap_records import HEAD, MESSAGE_BODY, PRIVATE, parse_record

# A chunk that unpacks to more is not believed: its size field may be anything.
LARGEST_CHUNK = 1 << 29
_PIECE = 1 << 16
_FINE = 1 << 12
_AT_LEAST = 1 << 24
_LIKELY_RATIO = 8
_HEAD = struct.Struct("<BQ")
INSIDE = (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE)
_MESSAGE_START = re.compile(rb"\x05(?=.{4}\0{4})", re.DOTALL)
_DEFINITIONS: dict[int, Any] = {Opcode.SCHEMA: Schema, Opcode.CHANNEL: Channel}


@dataclass
class Content:
    """The records of a chunk.

    Attributes
    ----------
    messages, definitions : list
        Definitions are `Schema` and `Channel` records.
    fault : str
        Why these may not be all; empty where every byte was accounted for.
    """

    messages: list[Message] = field(default_factory=list)
    definitions: list[Schema | Channel] = field(default_factory=list)
    fault: str = ""


class Unpacked(NamedTuple):
    """The data of a chunk as far as they go.

    Attributes
    ----------
    data : bytes
    fault : str
        Why they are not what was announced; empty where they are.
    contradicted : bool
        The fault is more than an early end: something in the data is wrong.
    """

    data: bytes
    fault: str = ""
    contradicted: bool = False


def unpack(compression: str, data: bytes, size: int) -> Unpacked:
    """Return the unpacked data; memory follows what comes out, not what a size field announces."""
    if compression == "":
        text = "" if len(data) == size else f"it has {len(data)} bytes, not {size}"
        return Unpacked(data, text, len(data) > size)
    pieces = _UNPACKERS.get(compression)
    if pieces is None:
        return Unpacked(b"", f"its compression {compression!r} is not known", True)
    limit = min(LARGEST_CHUNK, max(size, _AT_LEAST))
    unpacked: list[bytes] = []
    length, fault, wrong = 0, "", False
    try:
        for piece in pieces(data, limit):
            unpacked.append(piece)
            length += len(piece)
            if length > limit:
                raise ValueError(f"it unpacks to more than {limit} bytes")
    except EOFError as error:
        fault = str(error)
    except Exception as error:  # whatever a decompressor makes of damaged bytes
        fault, wrong = str(error) or type(error).__name__, True
    if not fault and length != size:
        fault, wrong = f"it unpacks to {length} bytes, not {size}", length > size
    return Unpacked(b"".join(unpacked), fault, wrong)


def split(data: bytes) -> Content:
    """Return the records of a chunk's data; after a damaged one go on with the next message."""
    content = Content()
    position = 0
    while position < len(data):
        end = _end(data, position)
        if end is None or not _take(data, position, end, content):
            content.fault = content.fault or f"a record in it is damaged at its byte {position}"
            position = _next_message(data, position + 1)
        else:
            position = end
    return content


def message_of(body: bytes) -> Message:
    """Return the message of a record's body."""
    channel, sequence, log_time, publish_time = MESSAGE_BODY.unpack_from(body)
    return Message(channel, log_time, body[MESSAGE_BODY.size :], publish_time, sequence)


def _take(data: bytes, position: int, end: int, content: Content) -> bool:
    opcode, body = data[position], data[position + HEAD : end]
    if opcode == Opcode.MESSAGE:
        content.messages.append(message_of(body))
    elif opcode in _DEFINITIONS:
        record = parse_record(_DEFINITIONS[opcode], body)
        if record is None:
            return False
        content.definitions.append(record)
    return True


def _end(data: bytes, position: int) -> int | None:
    if position + HEAD > len(data):
        return None
    opcode, length = _HEAD.unpack_from(data, position)
    end: int = position + HEAD + length
    if end > len(data) or not (opcode in INSIDE or opcode >= PRIVATE):
        return None
    short = opcode == Opcode.MESSAGE and length < MESSAGE_BODY.size
    return None if short else end


def _next_message(data: bytes, start: int) -> int:
    """Return where the next message starts that is followed by another record or the end."""
    for match in _MESSAGE_START.finditer(data, start):
        end = _end(data, match.start())
        if end is not None and (end == len(data) or _end(data, end) is not None):
            return match.start()
    return len(data)


def _zstd(data: bytes, limit: int) -> Iterator[bytes]:
    try:
        frame = zstandard.get_frame_parameters(data)
        if 0 < frame.content_size <= limit:
            yield zstandard.ZstdDecompressor().decompress(data)
            return
    except zstandard.ZstdError:
        pass  # damaged or cut: piece by piece as far as it goes
    # Short reads, as the decompressor keeps nothing of a read in which it fails.
    with zstandard.ZstdDecompressor().stream_reader(data, read_across_frames=True) as reader:
        while piece := reader.read(_FINE):
            yield piece


def _lz4(data: bytes, limit: int) -> Iterator[bytes]:
    try:
        whole = lz4.frame.LZ4FrameDecompressor()
        likely = min(limit, _LIKELY_RATIO * len(data) + _AT_LEAST // 16)  # allocated at once
        unpacked = whole.decompress(data, max_length=likely)
        if whole.eof and not whole.unused_data:
            yield unpacked
            return
    except RuntimeError:
        pass  # damaged: piece by piece as far as it goes
    rest = data
    while rest:  # frame after frame
        frame = lz4.frame.LZ4FrameDecompressor()
        yield frame.decompress(rest, max_length=_PIECE)
        while not frame.eof and not frame.needs_input:
            yield frame.decompress(b"", max_length=_PIECE)
        if not frame.eof:
            raise EOFError("its data are cut off")
        rest = frame.unused_data or b""


_UNPACKERS: dict[str, Callable[[bytes, int], Iterator[bytes]]] = {"zstd": _zstd, "lz4": _lz4}
