"""Writing MCAP bags that ROS 2 and Foxglove read: compressed chunks with CRC."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self

from mcap.records import Attachment, Channel, Message, Schema
from mcap.writer import CompressionType, Writer

from geoprim_core.errors import FileError, InputError
from geoprim_core.io.definitions import schema_text, serialize, type_hash, typestore
from geoprim_core.io.record import Record, stamp_of

COMPRESSIONS = {
    "zstd": CompressionType.ZSTD,
    "lz4": CompressionType.LZ4,
    "none": CompressionType.NONE,
}


class BagWriter:
    """Writes an MCAP bag; a context manager.

    The bag appears under its name when the block ends without an exception. Until then it grows
    beside it under a temporary name, which is removed when the block fails; a bag that was there
    before then stays as it was.

    Parameters
    ----------
    path : path of the .mcap file
    chunk_bytes : int
        Messages are packed together up to this size; what is damaged later is lost by the chunk.
    profile : str
        Whose conventions the bag follows.
    compression : {"zstd", "lz4", "none"}
        How the chunks are compressed.
    in_place : bool
        Grow under the final name, and keep what was written whatever happens: for a recording,
        where half of it is worth more than nothing.

    Raises
    ------
    InputError
        The compression is not known.
    FileError
        The file cannot be written; also raised while writing, when the disk is full.

    Examples
    --------
    >>> import tempfile
    >>> from geoprim_core.io.record import header
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with BagWriter(Path(folder) / "small.mcap") as bag:
    ...         bag.write("stamps", header(5, "camera"), log_time_ns=5)
    ...     [file.name for file in Path(folder).iterdir()]
    ['small.mcap']
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        chunk_bytes: int = 1 << 20,
        profile: str = "ros2",
        *,
        compression: str = "zstd",
        in_place: bool = False,
    ) -> None:
        if compression not in COMPRESSIONS:
            raise InputError("compression", f"one of {', '.join(COMPRESSIONS)}", compression)
        self.path = Path(path)
        part = self.path.with_name(f".{self.path.name}.{os.getpid()}.part")
        self._temporary = self.path if in_place else part
        self._schemas: dict[tuple[str, str], int] = {}
        self._channels: dict[tuple[str, int], int] = {}
        self._counts: dict[int, int] = {}
        self._copied_schemas: dict[tuple[str, str, bytes], int] = {}
        self._copied_channels: dict[tuple[Any, ...], int] = {}
        try:
            if self.path.is_dir():
                raise IsADirectoryError(None, "it is a folder")
            self._file: IO[bytes] = self._temporary.open("wb")
        except OSError as error:
            raise _unwritable(self.path, error) from None
        self._writer = Writer(self._file, chunk_bytes, COMPRESSIONS[compression])
        self._writer.start(profile=profile, library="geoprim")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Finish the bag, or remove what was written when the block failed."""
        if kind is not None:
            self.discard()
        else:
            self.close()

    def write(self, topic: str, record: Record, log_time_ns: int | None = None) -> None:
        """Write a message; its time is the stamp of its header unless one is given.

        Raises
        ------
        InputError
            The type or the fields of the record are not known.
        FileError
            The disk is full.
        """
        time = stamp_of(record) if log_time_ns is None else log_time_ns
        self.write_raw(topic, record.type, serialize(record), time)

    def write_raw(
        self,
        topic: str,
        type_name: str,
        data: bytes,
        log_time_ns: int,
        definition: str = "",
        offered_qos: str = "",
    ) -> None:
        """Write a message that is serialised already.

        `definition` is the schema text of a type that neither ROS 2 Jazzy nor geoprim_msgs has;
        `offered_qos`, heeded at the first message of a topic, the profiles of its publishers as
        rosbag2 writes them.
        """
        try:
            channel = self._channel(topic, type_name, definition, offered_qos)
            count = self._counts[channel] = self._counts.get(channel, -1) + 1
            self._writer.add_message(channel, log_time_ns, data, log_time_ns, count)
        except OSError as error:
            raise _unwritable(self.path, error) from None

    def write_copy(self, channel: Channel, schema: Schema | None, message: Message) -> None:
        """Write a message of another bag as it is there, with its channel and schema."""
        try:
            number = self.add_channel(channel, schema)
            self._writer.add_message(
                number, message.log_time, message.data, message.publish_time, message.sequence
            )
        except OSError as error:
            raise _unwritable(self.path, error) from None

    def add_channel(self, channel: Channel, schema: Schema | None) -> int:
        """Describe a channel as another bag does; return its number here."""
        number = 0
        if schema is not None:
            key = (schema.name, schema.encoding, schema.data)
            if key not in self._copied_schemas:
                text = self._writer.register_schema(schema.name, schema.encoding, schema.data)
                self._copied_schemas[key] = text
            number = self._copied_schemas[key]
        facts = tuple(sorted(channel.metadata.items()))
        place = (channel.topic, channel.message_encoding, number, facts)
        if place not in self._copied_channels:
            self._copied_channels[place] = self._writer.register_channel(
                channel.topic, channel.message_encoding, number, channel.metadata
            )
        return self._copied_channels[place]

    def add_attachment(self, attachment: Attachment) -> None:
        """Write a file that belongs to the bag."""
        part = attachment
        try:
            self._writer.add_attachment(
                part.create_time, part.log_time, part.name, part.media_type, part.data
            )
        except OSError as error:
            raise _unwritable(self.path, error) from None

    def add_metadata(self, name: str, values: Mapping[str, str]) -> None:
        """Write a named record of texts that belongs to the whole bag."""
        try:
            self._writer.add_metadata(name, dict(values))
        except OSError as error:
            raise _unwritable(self.path, error) from None

    def flush(self) -> None:
        """End the chunk and hand all to the system, so that it outlives this process."""
        try:
            self._writer.flush()
        except OSError as error:
            raise _unwritable(self.path, error) from None

    @property
    def size(self) -> int:
        """Bytes written until now, without the chunk that is still growing."""
        return self._file.tell()

    def close(self) -> None:
        """Finish the bag and put it in place."""
        if self._file.closed:
            return
        try:
            self._writer.finish()
            self._file.close()
            if self._temporary != self.path:
                self._temporary.replace(self.path)
        except OSError as error:
            self.discard()
            raise _unwritable(self.path, error) from None

    def discard(self) -> None:
        """Stop writing and remove what was written, unless it is kept whatever happens."""
        with contextlib.suppress(OSError):  # a full disk again; what was buffered is not wanted
            self._file.close()
        if self._temporary != self.path:
            self._temporary.unlink(missing_ok=True)

    def _channel(self, topic: str, type_name: str, definition: str, offered_qos: str) -> int:
        known = not definition or type_name in typestore().fielddefs
        text = schema_text(type_name) if known else definition
        schema = self._schemas.get((type_name, text))
        if schema is None:
            schema = self._writer.register_schema(type_name, "ros2msg", text.encode())
            self._schemas[type_name, text] = schema
        channel = self._channels.get((topic, schema))
        if channel is None:
            metadata = {"topic_type_hash": type_hash(type_name)} if known else {}
            metadata |= {"offered_qos_profiles": offered_qos} if offered_qos else {}
            channel = self._writer.register_channel(topic, "cdr", schema, metadata)
            self._channels[topic, schema] = channel
        return channel


def _unwritable(path: Path, error: OSError) -> FileError:
    return FileError(f"cannot write {path}: {error.strerror or error}")
