"""The search for places in a damaged file where a record can start."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator, Sequence

from mcap.opcode import Opcode

from geoprim_core.io.mcap_records import HEAD, MAGIC, View

_BLOCK, _OVERLAP = 1 << 20, 64
_HEAD = struct.Struct("<BQ")
# Opcode -> where a number stands that has to fit the length of the record.
_FITS: dict[int, tuple[int, Callable[[int, int], bool]]] = {
    Opcode.CHUNK: (37, lambda name, _: name <= 16),
    Opcode.MESSAGE_INDEX: (11, lambda array, length: array == length - 6),
}
_TAIL = 1 << 16
_START = re.compile(rb"[\x01-\x0f](?!\0{8})(?=.{4}\0{4})", re.DOTALL)


def candidates(view: View, start: int, own: Sequence[int]) -> Iterator[int]:
    """Yield the places whose first bytes can be the head of a record; most others end here."""
    for base in range(start, view.size, _BLOCK):
        block = view.at(base, _BLOCK + _OVERLAP)
        for match in _START.finditer(block, 0, min(_BLOCK + HEAD, len(block))):
            place = match.start()
            opcode, length = _HEAD.unpack_from(block, place)
            if opcode in own or not 4 <= length <= view.size or place >= _BLOCK:
                continue
            if opcode in _FITS:
                at, fits = _FITS[opcode]
                if not fits(int.from_bytes(block[place + at : place + at + 4], "little"), length):
                    continue
            yield base + place


def trailing_zeros(view: View) -> int:
    """Return how many zeros a file ends in; a file system may leave some after a power cut."""
    size = view.size
    while size > len(MAGIC):
        block = view.at(max(size - _TAIL, 0), min(_TAIL, size))
        kept = len(block.rstrip(b"\0"))
        size -= len(block) - kept
        if kept:
            break
    return view.size - size
