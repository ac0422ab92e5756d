"""A damaged bag in, a whole bag with everything that is still readable out."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from geoprim_core.errors import BagError, FileError
from geoprim_core.io.bag_writer import BagWriter
from geoprim_core.io.bags import BagReader
from geoprim_core.io.losses import Losses

_METADATA = "geoprim_repair"


@dataclass(frozen=True)
class RepairReport:
    """What a repair did.

    Attributes
    ----------
    output : Path
    messages, doubtful, metadata, attachments : int
        How many were written; the doubtful ones are among the messages.
    losses : Losses
        What could not be read.
    faults : tuple of str
        Attachments that are damaged.
    """

    output: Path
    messages: int
    doubtful: int
    metadata: int
    attachments: int
    losses: Losses
    faults: tuple[str, ...]

    def __str__(self) -> str:
        lines = [
            f"{self.output}: {self.messages} messages, {self.metadata} metadata records and "
            f"{self.attachments} attachments written",
            str(self.losses),
            *(f"left out: {fault}" for fault in self.faults),
            *self.losses.notes,
        ]
        return "\n".join(lines)


def repair_bag(
    source: str | os.PathLike[str],
    output: str | os.PathLike[str] | None = None,
    *,
    keep_doubtful: bool = False,
    replace: bool = False,
) -> RepairReport:
    """Write a whole bag with everything that can be read of a damaged one.

    The new bag has the messages in the order of their log times, with their channels, schemas,
    sequence numbers and times, the metadata and the attachments; where something was lost, a
    metadata record `geoprim_repair` tells so.

    Parameters
    ----------
    source : path of an .mcap file or of a rosbag2 folder
    output : path, optional
        The new file; `<name>_repaired.mcap` beside the source unless given.
    keep_doubtful : bool
        Also write messages whose checksum fails.
    replace : bool
        Replace a file that is there already; never the source.

    Raises
    ------
    BagError
        Nothing of the bag can be read.
    FileError
        The new file is there already, is part of the source or cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from geoprim_core.io.record import header
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "cut.mcap"
    ...     with BagWriter(path) as bag:
    ...         bag.write("stamps", header(5, "camera"), log_time_ns=5)
    ...     _ = path.write_bytes(path.read_bytes()[:-40])
    ...     report = repair_bag(path)
    ...     BagReader(report.output).losses.parts, report.messages, report.losses.reasons
    (0, 1, ('the file is cut off or damaged for good at bytes 1026 to 1049, after 0.000 s',))
    """
    reader = BagReader(source, keep_doubtful=keep_doubtful)
    target = _target(reader, output, replace)
    losses = reader.prove()
    if losses and not any(topic.count for topic in reader.topics()):
        raise BagError(f"{reader.path}: no message can be read; {losses}")
    profiles = [file.profile for file in reader.parts if file.profile]
    with BagWriter(target, profile=profiles[0] if profiles else "ros2") as bag:
        _add_channels(reader, bag)
        messages, doubtful = _copy_messages(reader, bag)
        metadata = _copy_metadata(reader, bag)
        attachments, faults = _copy_attachments(reader, bag)
        if losses:
            bag.add_metadata(_METADATA, {"source": reader.path.name, "losses": str(losses)})
    return RepairReport(
        target, messages, doubtful, metadata, attachments, reader.losses, tuple(faults)
    )


def _target(reader: BagReader, output: str | os.PathLike[str] | None, replace: bool) -> Path:
    beside = reader.path.with_name(f"{reader.path.stem}_repaired.mcap")
    target = beside if output is None else Path(output)
    if any(target.resolve() == file.resolve() for file in reader.files):
        raise FileError(f"cannot write {target}: it is the bag that is read")
    if target.exists() and any(target.samefile(file) for file in reader.files):
        raise FileError(f"cannot write {target}: it is another name of the bag that is read")
    if target.exists() and not replace:
        raise FileError(f"cannot write {target}: it exists already")
    return target


def _add_channels(reader: BagReader, bag: BagWriter) -> None:
    """Describe every channel, those without a message too."""
    for file in reader.parts:
        for channel in file.channels.values():
            bag.add_channel(channel, file.schemas.get(channel.schema_id))


def _copy_messages(reader: BagReader, bag: BagWriter) -> tuple[int, int]:
    count = doubtful = 0
    for record in reader.records():
        bag.write_copy(record.channel, record.schema, record.message)
        count += 1
        doubtful += bool(record.doubt)
    return count, doubtful


def _copy_metadata(reader: BagReader, bag: BagWriter) -> int:
    records = [record for file in reader.parts for record in file.metadata]
    for name, values in records:
        bag.add_metadata(name, values)
    return len(records)


def _copy_attachments(reader: BagReader, bag: BagWriter) -> tuple[int, list[str]]:
    count, faults = 0, []
    for file in reader.parts:
        for offset, length in file.attachments:
            try:
                bag.add_attachment(file.attachment(offset, length))
                count += 1
            except BagError as error:
                faults.append(str(error))
    return count, faults
