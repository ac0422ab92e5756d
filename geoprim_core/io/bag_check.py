"""What a bag holds, and whether all of it can be read."""

from __future__ import annotations

import os
import zlib
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from geoprim_core.errors import BagError
from geoprim_core.io.bags import BagReader
from geoprim_core.io.definitions import same_fields
from geoprim_core.io.losses import Losses
from geoprim_core.io.mcap_file import McapFile

_BLOCK = 1 << 22


@dataclass(frozen=True)
class TopicReport:
    """A topic of a bag.

    Attributes
    ----------
    name, type : str
    count : int
        Messages that can be read.
    lost : int or None
        Messages that cannot; None where the bag does not tell.
    doubtful : int
        Messages among `count` that may be wrong.
    bad : int
        Messages among `count` whose bytes are not of their type.
    reason : str
        What the first of the bad ones has.
    """

    name: str
    type: str
    count: int
    lost: int | None
    doubtful: int = 0
    bad: int = 0
    reason: str = ""


@dataclass(frozen=True)
class BagReport:
    """What a bag holds and what it has lost.

    Attributes
    ----------
    path : Path
    bytes : int
    files : int
    span_ns : (int, int) or None
        First and last log time.
    topics : tuple of TopicReport
    metadata, attachments : int
        Number of these records.
    losses : Losses
    faults : tuple of str
        What is wrong beside the losses.
    notes : tuple of str
        What is odd and costs nothing.
    """

    path: Path
    bytes: int
    files: int
    span_ns: tuple[int, int] | None
    topics: tuple[TopicReport, ...]
    metadata: int
    attachments: int
    losses: Losses
    faults: tuple[str, ...]
    notes: tuple[str, ...]

    @property
    def messages(self) -> int:
        """The number of messages that can be read."""
        return sum(topic.count for topic in self.topics)

    @property
    def exit_code(self) -> int:
        """0 for a whole bag, 1 where parts are lost, 2 where nothing can be used."""
        usable = self.messages - sum(topic.bad for topic in self.topics)
        if self.losses or self.faults:
            return 1 if usable else 2
        return 0

    def __str__(self) -> str:
        width = max([5, *(len(t.name) for t in self.topics)])
        kind = max([4, *(len(t.type) for t in self.topics)])
        lines = [
            self._heading(),
            f"{'topic':{width}}  {'type':{kind}}   count  lost  doubtful  bad",
        ]
        for t in self.topics:
            lost = "?" if t.lost is None else str(t.lost)
            row = f"{t.name:{width}}  {t.type:{kind}}  {t.count:6d}  {lost:>4}"
            lines.append(f"{row}  {t.doubtful:8d}  {t.bad:3d}")
        lines += [f"bad: topic {t.name}: {t.reason}" for t in self.topics if t.bad]
        lines += [f"lost: {reason}" for reason in self.losses.reasons]
        lines += [f"fault: {fault}" for fault in self.faults]
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes), self._verdict()])

    def _heading(self) -> str:
        start, end = self.span_ns or (0, 0)
        return (
            f"{self.path}: {self.bytes} bytes in {self.files} "
            f"{'file' if self.files == 1 else 'files'}, {self.messages} messages in "
            f"{(end - start) / 1e9:.3f} s from {start / 1e9:.3f} s, {self.metadata} metadata "
            f"records, {self.attachments} attachments"
        )

    def _verdict(self) -> str:
        losses = self.losses
        if not losses:
            return "whole" if not self.faults else "the messages are all there; see the faults"
        count = f"{losses.messages}" if losses.exact else f"at least {losses.messages}"
        return (
            f"{losses.parts} parts with {losses.bytes} bytes are damaged or missing; messages "
            f"lost: {count}, doubtful: {losses.doubtful}"
        )


def inspect_bag(path: str | os.PathLike[str], *, thorough: bool = True) -> BagReport:
    """Return what a bag holds and what it has lost.

    Parameters
    ----------
    path : path of an .mcap file or of a rosbag2 folder
    thorough : bool
        Read and decode every message; else only what the index tells is read, unless it is
        damaged.

    Raises
    ------
    BagError
        Nothing of it can be read.

    Examples
    --------
    >>> import tempfile
    >>> from geoprim_core.io.bags import BagWriter
    >>> from geoprim_core.io.record import header
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "small.mcap"
    ...     with BagWriter(path) as bag:
    ...         bag.write("stamps", header(5, "camera"), log_time_ns=5)
    ...     report = inspect_bag(path)
    >>> report.topics, report.exit_code
    ((TopicReport(name='stamps', type='std_msgs/msg/Header', count=1, lost=0, doubtful=0, bad=0, \
reason=''),), 0)
    """
    reader = BagReader(path)
    bad: dict[str, tuple[int, str]] = {}
    doubtful: Counter[str] = Counter()
    faults: list[str] = []
    if thorough:
        reader.prove()
        _read_all(reader, bad, doubtful)
        faults = [fault for file in reader.parts for fault in _faults(file)]
    faults += [f"topic {name}: {count} bad messages" for name, (count, _) in bad.items()]
    lost = _lost(reader)
    topics = tuple(
        TopicReport(
            t.name, t.type, t.count, None if lost is None else lost[t.name], doubtful[t.name],
            *bad.get(t.name, (0, "")),
        )
        for t in reader.topics()
    )  # fmt: skip
    spans = [span for file in reader.parts if (span := file.span) is not None]
    return BagReport(
        reader.path,
        sum(file.path.stat().st_size for file in reader.parts),
        len(reader.files),
        (min(s[0] for s in spans), max(s[1] for s in spans)) if spans else None,
        topics,
        sum(len(file.metadata) for file in reader.parts),
        sum(len(file.attachments) for file in reader.parts),
        reader.losses,
        tuple(faults),
        (*reader.losses.notes, *_notes(reader)),
    )


def _read_all(reader: BagReader, bad: dict[str, tuple[int, str]], doubtful: Counter[str]) -> None:
    for message in reader.messages():
        doubtful[message.topic] += bool(message.doubt)
        if message.encoding != "cdr":
            continue  # not of ROS 2 and not ours to judge
        try:
            _ = message.decoded
        except BagError as error:
            count, first = bad.get(message.topic, (0, str(error)))
            bad[message.topic] = count + 1, first


def _lost(reader: BagReader) -> Counter[str] | None:
    """Return how many messages each topic has lost, None where nothing tells."""
    lost: Counter[str] = Counter()
    if reader.losses and not reader.losses.exact:
        return None
    for file in reader.parts:
        if file.statistics is None:
            if file.losses:
                return None
            continue
        for number, channel in file.channels.items():
            count = file.statistics.channel_message_counts.get(number, 0)
            read = count if file.tallies is None else file.tallies[number]
            lost[channel.topic] += count - read
    return lost


def _faults(file: McapFile) -> list[str]:
    """Return what is wrong with a file though its messages can be read."""
    faults = []
    for offset, length in file.attachments:
        try:
            file.attachment(offset, length)
        except BagError as error:
            faults.append(str(error))
    end, crc = file.data_end
    if end is not None and crc and not file.losses and _data_crc(file, end) != crc:
        faults.append(f"{file.path}: the checksum of all data fails, no single part shows why")
    return faults


def _data_crc(file: McapFile, end: int) -> int:
    """Return the checksum of everything before the record that ends the data."""
    crc, left = 0, end - 13
    with file.open() as opened:
        while left > 0 and (block := opened.read(min(_BLOCK, left))):
            crc, left = zlib.crc32(block, crc), left - len(block)
    return crc


def _notes(reader: BagReader) -> list[str]:
    notes = []
    if "geoprim_repair" in reader.metadata:
        told = reader.metadata["geoprim_repair"].get("losses", "")
        notes.append(f"this bag was made by a repair: {told}")
    unprotected = sum(file.unprotected for file in reader.parts)
    if unprotected:
        notes.append(f"{unprotected} messages have no checksum: damage inside them cannot be seen")
    for file in reader.parts:
        for schema in file.schemas.values():
            if schema.encoding == "ros2msg" and not same_fields(
                schema.name, schema.data.decode(errors="replace")
            ):
                notes.append(f"the text of {schema.name} in the bag is not that of ROS 2 Jazzy")
    return notes
