"""A part of an MCAP file that holds messages, and what its indexes say of it."""

from __future__ import annotations

from dataclasses import dataclass, field

from mcap.records import ChunkIndex

from geoprim_core.io.mcap_records import ChunkHead, View


@dataclass
class Extent:
    """A chunk, or a message outside of any, and where it lies.

    Attributes
    ----------
    head : ChunkHead or None
        None for a message.
    offset, end : int
        What belongs to it, up to where something else follows.
    start_time, end_time : int
        The earliest log time in it, as far as known, and the latest once it was read.
    counted : int
        Number of messages by the message index behind it.
    times : (int, int) or None
        First and last log time by that index.
    channels : set of int
        By that index.
    cut : bool
        The file ends in it.
    broken : bool
        Its head is damaged or its data are not all there.
    listed : ChunkIndex or None
        What the index at the end of the file says of it.
    stray : bool
        That index does not know it.
    orphan : bool
        It lies behind a place where the walk broke off; only an index can tell whose it is.
    given_up : bool
        It is not unpacked, as more than enough was unpacked in vain before.
    repeated : set of int
        Which of its messages stand elsewhere in the file too.
    """

    head: ChunkHead | None
    offset: int
    end: int
    start_time: int
    end_time: int = 0
    counted: int = 0
    times: tuple[int, int] | None = None
    channels: set[int] = field(default_factory=set)
    cut: bool = False
    broken: bool = False
    listed: ChunkIndex | None = None
    stray: bool = False
    orphan: bool = False
    given_up: bool = False
    repeated: set[int] = field(default_factory=set)

    def data(self, view: View) -> bytes:
        """Return the packed data of a chunk."""
        assert self.head is not None
        end = self.end if self.broken else self.head.data_offset + self.head.data_length
        return view.at(self.head.data_offset, end - self.head.data_offset)

    def surely_without(self, channels: set[int]) -> bool:
        """Return whether both indexes of a chunk say that it has no message of some channels."""
        if self.listed is None or not self.channels or not self.listed.message_index_offsets:
            return False
        said = self.channels | set(self.listed.message_index_offsets)
        return said.isdisjoint(channels)

    def surely_outside(self, since_ns: int | None, until_ns: int | None) -> bool:
        """Return whether a chunk and the index agree that it lies before or behind some times.

        The times in a chunk's head have no checksum: alone they are not enough to pass it over.
        """
        if self.listed is None or self.head is None:
            return False
        start, end = self.listed.message_start_time, self.listed.message_end_time
        if (self.head.start_time, self.head.end_time) != (start, end):
            return False
        early = since_ns is not None and end < since_ns
        return early or (until_ns is not None and start > until_ns)
