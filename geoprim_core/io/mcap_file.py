"""One MCAP file, read so that damage costs no more than it hit, and never without a word.

The libraries for MCAP stop at the first damaged record or refuse a file without its end. Here
`Scan` finds what lies where, `compare` holds it against the index at the end, and every chunk is
held against its checksum. A message is passed on as sure only when nothing speaks against it:

- the checksum of its chunk holds, or the file has no checksums at all;
- a message of a chunk in which the file ends comes marked as doubtful;
- one whose checksum fails is kept back, or comes marked when it is asked for;
- one that stands in a damaged file twice comes once.
"""

from __future__ import annotations

import heapq
import zlib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import IO, NamedTuple

from mcap.records import Attachment, Channel, Header, Message, Metadata, Schema, Statistics

from geoprim_core.errors import BagError
from geoprim_core.io.losses import Loss, tell_times
from geoprim_core.io.mcap_catalogue import Catalogue, Grade
from geoprim_core.io.mcap_chunks import LARGEST_CHUNK
from geoprim_core.io.mcap_extent import Extent
from geoprim_core.io.mcap_reading import Reading, read_extent
from geoprim_core.io.mcap_records import MAGIC, View, message_key, stream
from geoprim_core.io.mcap_scan import Scan
from geoprim_core.io.mcap_summary import compare, read_summary

_NOT_OURS = "no index tells that it belongs to this file"
# So many bytes of messages wait for earlier ones of later chunks, at most.
_WINDOW = 1 << 28
_VAIN_RATIO = 64


class Found(NamedTuple):
    """A message and why it may be wrong; empty where nothing speaks against it."""

    message: Message
    doubt: str


class McapFile:
    """The readable part of an MCAP file.

    Parameters
    ----------
    path : Path
    keep_doubtful : bool
        Also pass on messages whose checksum fails.

    Attributes
    ----------
    channels, schemas : dict
        Id -> record. Those that only stand inside chunks appear when the chunks are read.
    statistics : Statistics or None
        None where the end of the file is missing or cannot be believed.
    metadata : list of (name, values)
    profile : str
    attachments : list of (offset, length)
    losses : dict
        Place -> `Loss`, as far as noticed yet.
    notes : dict
        What is odd and costs nothing, by its kind.
    tallies : Counter or None
        Channel -> number of messages, when the whole file was read.
    doubtful, unprotected : int
        How many of these may be wrong, and how many never had a checksum.
    announced : int or None
        How many messages the file has by what stands outside of it.
    data_end : (int or None, int)
        Where the data section ends and its checksum.

    Raises
    ------
    BagError
        The file is missing, empty or not an MCAP file.
    """

    def __init__(self, path: Path, *, keep_doubtful: bool = False) -> None:
        self.path = path
        self.metadata: list[tuple[str, dict[str, str]]] = []
        self.profile = ""
        self.losses: dict[object, Loss] = {}
        self.notes: dict[str, str] = {}
        self.tallies: Counter[int] | None = None
        self.doubtful = self.unprotected = 0
        self.announced: int | None = None
        self._in_vain = 0  # bytes that were unpacked and failed their checksums
        self._strays = 0  # messages passed on that the index does not know of
        self._catalogue = Catalogue()
        self._keep = keep_doubtful
        with self.open() as file:
            _check_magic(path, file.read(len(MAGIC)))
            self._scan(View(file))

    @property
    def channels(self) -> dict[int, Channel]:
        """The channels by their ids."""
        return self._catalogue.channels

    @property
    def schemas(self) -> dict[int, Schema]:
        """The schemas by their ids."""
        return self._catalogue.schemas

    @property
    def missing(self) -> int | None:
        """How many messages are lost as far as noticed; None where nothing tells."""
        if self.tallies is None:  # then the index is whole, and each loss counts for itself
            sure = self.statistics is not None and self._counted == self.statistics.message_count
            return sum(loss.messages for loss in self.losses.values()) if sure else None
        announced = self.announced if self.statistics is None else self.statistics.message_count
        if announced is None or self._strays:
            return None
        return max(announced - sum(self.tallies.values()), 0)

    @property
    def span(self) -> tuple[int, int] | None:
        """First and last log time, as the chunks or what was read of them tell; None of nothing."""
        ends = [e.head.end_time if e.listed is None else e.listed.message_end_time
                for e in self._extents if e.head is not None]  # fmt: skip
        starts = [e.start_time for e in self._extents]
        return (min(starts), max(starts + ends)) if starts else None

    def open(self) -> IO[bytes]:
        """Open the file."""
        try:
            return self.path.open("rb")
        except OSError as error:
            raise BagError(f"cannot read {self.path}: {error.strerror or error}") from None

    def attachment(self, offset: int, length: int) -> Attachment:
        """Return an attachment.

        Raises
        ------
        BagError
            It is damaged.
        """
        with self.open() as file:
            body = View(file).at(offset, min(length, LARGEST_CHUNK))
        try:
            record = Attachment.read(stream(body))
            crc = int.from_bytes(body[-4:], "little")
        except Exception as error:  # whatever a parser makes of damaged bytes
            raise BagError(f"{self.path}: attachment at byte {offset}: {error}") from None
        if crc and crc != zlib.crc32(body[:-4]):
            raise BagError(f"{self.path}: attachment {record.name}: its checksum fails")
        return record

    def messages(
        self,
        channels: set[int] | None = None,
        since_ns: int | None = None,
        until_ns: int | None = None,
    ) -> Iterator[Found]:
        """Yield the messages of some channels, or all, in the order of their log times.

        Chunks that surely lie outside of the times asked for are not read; of those that are, all
        messages come.
        """
        seen: Counter[int] = Counter()
        newest = -1
        for found in self._sorted(channels, since_ns, until_ns):
            time = found.message.log_time
            if time < newest:
                late = (newest - time) / 1e9
                self.notes["order"] = f"messages come up to {late:.3f} s out of order"
            newest = max(time, newest)
            seen[found.message.channel_id] += 1
            yield found
        if since_ns is None and until_ns is None:
            self._count(seen, channels)

    def survey(self) -> None:
        """Read every message: count, sort and prove them, and find those that stand twice."""
        if self.tallies is not None:
            return
        self.tallies = Counter()
        with self.open() as file:
            view = View(file)
            grades = [self._first_look(view, extent) for extent in self._extents]
            seen: set[int] | None = set() if self.losses else None
            order = sorted(range(len(grades)), key=lambda i: (-grades[i], self._extents[i].orphan))
            for i in order:
                self._second_look(view, self._extents[i], seen)
        self._note_descriptions()
        read = ((e.offset, e.start_time, e.end_time) for e in self._extents if e.end_time)
        tell_times(self.losses.values(), read)

    def _sorted(
        self, channels: set[int] | None, since_ns: int | None, until_ns: int | None
    ) -> Iterator[Found]:
        pending: list[tuple[int, int, Found]] = []
        waiting = serial = 0
        with self.open() as file:
            view = View(file)
            for extent in sorted(self._extents, key=lambda e: (e.start_time, e.offset)):
                if channels is not None and extent.surely_without(channels):
                    continue
                if extent.surely_outside(since_ns, until_ns):
                    continue
                while pending and (pending[0][0] < extent.start_time or waiting > _WINDOW):
                    found = heapq.heappop(pending)[2]
                    waiting -= len(found.message.data)
                    yield found
                for found in self._read(view, extent)[1]:
                    if channels is None or found.message.channel_id in channels:
                        heapq.heappush(pending, (found.message.log_time, serial, found))
                        serial, waiting = serial + 1, waiting + len(found.message.data)
        while pending:
            yield heapq.heappop(pending)[2]

    def _read(self, view: View, extent: Extent) -> tuple[Reading, list[Found]]:
        """Return what an extent gives and which messages of it are passed on; note its loss."""
        reading = read_extent(view, extent, checksums=self._checksums)
        return reading, self._pass_on(extent, reading)

    def _pass_on(self, extent: Extent, reading: Reading) -> list[Found]:
        for record in reading.content.definitions:
            self._catalogue.add(record, reading.grade)
        doubt = reading.doubt
        if not doubt and (extent.stray or extent.orphan):
            doubt = _NOT_OURS
        passed, unknown = [], 0
        if reading.grade is not Grade.WRONG or self._keep:
            for i, message in enumerate(reading.content.messages):
                if message.channel_id not in self.channels:
                    unknown += 1
                elif i not in extent.repeated:
                    other = self._catalogue.doubt(message.channel_id)
                    passed.append(Found(message, doubt or other))
        self._note(extent, reading, len(passed) + len(extent.repeated), unknown)
        return passed

    def _note(self, extent: Extent, reading: Reading, passed: int, unknown: int) -> None:
        loss = reading.loss(extent, passed + unknown)
        if loss is not None:
            self.losses[extent.offset] = loss
        if unknown:
            text = "messages of a channel that is not described"
            loss = self.losses[extent.offset, "unknown"] = Loss(extent.offset, 0, text, unknown)
            times = [m.log_time for m in reading.content.messages]
            loss.span(min(times), max(times))
        if extent.repeated:
            text = f"{len(extent.repeated)} messages that stand in the file twice"
            self.losses[extent.offset, "repeated"] = Loss(extent.offset, 0, text)

    def _count(self, seen: Counter[int], channels: set[int] | None) -> None:
        """Note when fewer or more messages came than the file says, and nothing tells why."""
        if self.statistics is None or self.losses:
            return
        counts = self.statistics.channel_message_counts
        chosen = set(counts) | set(seen) if channels is None else channels
        expected = sum(counts.get(number, 0) for number in chosen)
        if expected != sum(seen.values()):
            text = f"{sum(seen.values())} messages were found where the index counts {expected}"
            self.losses["count"] = Loss(0, 0, text, max(expected - sum(seen.values()), 0))

    def _first_look(self, view: View, extent: Extent) -> Grade:
        extent.given_up = self._in_vain > _VAIN_RATIO * view.size + _WINDOW
        reading, _ = self._read(view, extent)
        self._in_vain += reading.unpacked if reading.grade is Grade.WRONG else 0
        times = [message.log_time for message in reading.content.messages]
        extent.start_time = min(times, default=extent.start_time)
        extent.end_time = max(times, default=0)
        return reading.grade

    def _second_look(self, view: View, extent: Extent, seen: set[int] | None) -> None:
        """Count the messages of an extent, best proved extents first."""
        reading = read_extent(view, extent, checksums=self._checksums)
        if seen is not None:
            keys = [message_key(message) for message in reading.content.messages]
            extent.repeated = {i for i, key in enumerate(keys) if key in seen}
            seen.update(keys)
        assert self.tallies is not None
        passed = self._pass_on(extent, reading)
        self.tallies.update(found.message.channel_id for found in passed)
        self.doubtful += sum(bool(found.doubt) for found in passed)
        self.unprotected += len(passed) if reading.grade is Grade.PLAIN else 0
        self._strays += len(passed) if extent.stray else 0
        if extent.orphan and reading.grade >= Grade.PLAIN and passed:
            none = Loss(extent.offset, 0, "what follows may belong to another file: no index tells")
            self.losses.setdefault("orphans", none).kept += len(passed)

    def _note_descriptions(self) -> None:
        """Note the topics and types that may be wrong."""
        for kind, number in sorted(self._catalogue.conflicts):
            text = f"{kind} {number} is described in two ways"
            self.losses[kind, number] = Loss(0, 0, text)
        for number, channel in sorted(self.channels.items()):
            doubt = self._catalogue.doubt(number)
            kept = 0 if self.tallies is None else self.tallies[number]
            if doubt and kept:
                text = f"topic {channel.topic}: {doubt}"
                self.losses["topic", number] = Loss(0, 0, text, kept=kept)

    def _scan(self, view: View) -> None:
        scan = Scan(view)
        if not scan.extents and not scan.records:
            raise BagError(f"{self.path} is not an MCAP file: no record of one is in it")
        summary = read_summary(scan)
        if summary is not None:
            compare(scan, summary)
        self.losses = dict(scan.losses.items())
        self._extents, self.attachments = scan.extents, scan.attachments
        self._counted = sum(extent.counted for extent in scan.extents)
        for extent in scan.extents:
            extent.orphan &= extent.listed is None and not extent.stray
        self._checksums = any(e.head is not None and e.head.crc for e in scan.extents)
        self.data_end = scan.summary, scan.data_crc
        self.statistics: Statistics | None = None if summary is None else summary.statistics
        disowned = summary is None or summary.disowned
        end = scan.summary if disowned else None
        for position, record in scan.records:
            self._file(record, Grade.PLAIN if end is None or position < end else Grade.DOUBTFUL)
        if summary is not None and not disowned:
            for record in summary.definitions:
                self._catalogue.add(record, Grade.PROVED if summary.proved else Grade.PLAIN)
        if self.losses or any(e.broken for e in scan.extents) or self.statistics is None:
            self.survey()
        self._note_descriptions()

    def _file(self, record: object, grade: Grade) -> None:
        if isinstance(record, (Schema, Channel)):
            self._catalogue.add(record, grade)
        elif isinstance(record, Metadata):
            self.metadata.append((record.name, dict(record.metadata)))
        elif isinstance(record, Header):
            self.profile = self.profile or record.profile


def _check_magic(path: Path, start: bytes) -> None:
    if start == MAGIC:
        return
    if not start:
        raise BagError(f"{path} is empty: 0 bytes")
    if start.startswith(b"SQLite"):
        raise BagError(f"{path} is an SQLite bag; convert it to MCAP with `ros2 bag convert`")
    if start.startswith(b"\x28\xb5\x2f\xfd"):
        raise BagError(f"{path} is compressed as a whole; unpack it with `zstd -d` first")
