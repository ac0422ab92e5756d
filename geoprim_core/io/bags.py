"""Reading MCAP bags, whole or damaged, without ROS; `BagWriter` writes them.

Examples
--------
>>> import tempfile
>>> from geoprim_core.io.record import header
>>> with tempfile.TemporaryDirectory() as folder:
...     path = Path(folder) / "small.mcap"
...     with BagWriter(path) as bag:
...         bag.write("stamps", header(5, "camera"), log_time_ns=5)
...     reader = BagReader(path)
...     [message.decoded.frame_id for message in reader.messages()]
['camera']
>>> reader.topics()
(Topic(name='stamps', type='std_msgs/msg/Header', count=1),)
"""

from __future__ import annotations

import heapq
import os
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cache
from itertools import chain, pairwise
from pathlib import Path
from typing import Any

from mcap.records import Channel, Message, Schema
from rosbags.typesys.store import Typestore

from geoprim_core.errors import BagError
from geoprim_core.io.bag_folder import open_files
from geoprim_core.io.bag_messages import (
    IMAGE_TYPES,
    BagImage,
    BagMessage,
    BagRecord,
    Topic,
    bag_image,
)
from geoprim_core.io.bag_writer import BagWriter
from geoprim_core.io.definitions import message_texts, new_typestore, split_schema, typestore
from geoprim_core.io.losses import Losses
from geoprim_core.io.mcap_file import Found, McapFile

__all__ = [
    "IMAGE_TYPES",
    "BagImage",
    "BagMessage",
    "BagReader",
    "BagRecord",
    "BagWriter",
    "Losses",
    "Topic",
    "bag_image",
]

_ANY_TIME = 1 << 64  # log times are unsigned 64-bit numbers


class BagReader:
    """Reads an MCAP file or the folder of a rosbag2 recording.

    A file that is cut off or damaged is read as far as it goes, chunk by chunk; `losses` tells
    what is missing. A message whose checksum fails is kept back; one whose checksum is cut off
    with the rest of its chunk comes with a `doubt`.

    Parameters
    ----------
    path : path of an .mcap file, or of a folder with such files
    keep_doubtful : bool
        Also pass on messages whose checksum fails, with a `doubt`.

    Attributes
    ----------
    files : tuple of Path
        The .mcap files.

    Raises
    ------
    BagError
        There is no such file, it is empty or it is not MCAP.
    """

    def __init__(self, path: str | os.PathLike[str], *, keep_doubtful: bool = False) -> None:
        self.path = Path(path)
        self._bag = open_files(self.path, keep_doubtful=keep_doubtful)
        self._files = self._bag.files
        self.files = tuple(file.path for file in self._files)
        self._stores: dict[tuple[str, bytes], Typestore] = {}
        for file in self._files:
            if file.statistics is None:
                file.survey()
        self._topics = self._survey()

    def topics(self) -> tuple[Topic, ...]:
        """Return the topics, sorted by name."""
        return self._topics

    def prove(self) -> Losses:
        """Read every message of the bag and return all that is lost."""
        for file in self._files:
            file.survey()
        self._topics = self._survey()
        return self.losses

    @property
    def parts(self) -> tuple[McapFile, ...]:
        """The files of the bag."""
        return tuple(self._files)

    @property
    def losses(self) -> Losses:
        """What could not be read, as far as noticed until now."""
        parts = list(self._bag.losses)
        for file in self._files:
            name = f"{file.path.name}: " if len(self._files) > 1 else ""
            parts += [replace(p, reason=name + p.reason) for p in file.losses.values()]
        notes = [*self._bag.notes, *(n for file in self._files for n in file.notes.values())]
        return Losses.of(parts, missing=self._missing(), doubtful=self._doubtful(), notes=notes)

    def _missing(self) -> int | None:
        counts = [file.missing for file in self._files]
        known = [count for count in counts if count is not None]
        if self._bag.uncounted or len(known) < len(counts):
            return None
        return sum(known) + sum(loss.messages for loss in self._bag.losses)

    def _doubtful(self) -> int | None:
        read = all(file.tallies is not None for file in self._files)
        return sum(file.doubtful for file in self._files) if read else None

    @property
    def metadata(self) -> dict[str, dict[str, str]]:
        """The metadata records of the bag: name -> values."""
        return {name: values for file in self._files for name, values in file.metadata}

    def topic(self, name: str) -> Topic:
        """Return the topic of a name, with or without a leading slash.

        Raises
        ------
        BagError
            There is none; the text lists those that there are, with their types.
        """
        for topic in self._topics:
            if topic.name.lstrip("/") == name.lstrip("/"):
                return topic
        present = ", ".join(f"{t.name} ({t.type}, {t.count})" for t in self._topics)
        text = f"{self.path} has no topic {name!r}; its topics: {present or 'none at all'}"
        raise BagError(f"{text}; {self.losses}" if self.losses else text)

    @property
    def time_range(self) -> tuple[int, int]:
        """The earliest and the latest log time of the bag in nanoseconds; (0, 0) when empty."""
        ranges = [file.span for file in self._files]
        known = [times for times in ranges if times is not None]
        return min((t[0] for t in known), default=0), max((t[1] for t in known), default=0)

    def offered_qos(self, name: str) -> str:
        """Return the QoS profiles of the publishers of a topic, in the YAML of rosbag2.

        Empty where the bag does not tell.
        """
        found = [
            channel.metadata.get("offered_qos_profiles", "")
            for file in self._files
            for channel in file.channels.values()
            if channel.topic == self.topic(name).name
        ]
        return next((text for text in found if text), "")

    def messages(
        self,
        topics: Iterable[str] | None = None,
        since_ns: int | None = None,
        until_ns: int | None = None,
    ) -> Iterator[BagMessage]:
        """Yield the messages of some topics, or of all, in the order of their log times.

        With `since_ns` and `until_ns` only those of these log times, both ends included; the
        parts of the file that hold none of them are not read.

        Raises
        ------
        BagError
            A topic is missing.
        """
        names = None if topics is None else {self.topic(name).name for name in topics}
        first = -_ANY_TIME if since_ns is None else since_ns
        last = _ANY_TIME if until_ns is None else until_ns
        found = self._messages(names, since_ns, until_ns)
        return (m for m in found if first <= m.log_time_ns <= last)

    def images(self, topic: str = "image") -> Iterator[BagImage]:
        """Yield the images of a topic; one that cannot be used comes as None with the reason.

        Raises
        ------
        BagError
            The topic is missing or does not hold images.
        """
        found = self.topic(topic)
        if found.type not in IMAGE_TYPES:
            expected = " or ".join(IMAGE_TYPES)
            raise BagError(f"topic {found.name} holds {found.type}, expected {expected}")
        return (bag_image(message) for message in self._messages({found.name}))

    def records(self) -> Iterator[BagRecord]:
        """Yield all messages in the order of their log times as the records that they are."""
        for file, found in self._found(None):
            channel = file.channels[found.message.channel_id]
            yield BagRecord(channel, file.schemas.get(channel.schema_id), *found)

    def _messages(
        self, names: set[str] | None, since_ns: int | None = None, until_ns: int | None = None
    ) -> Iterator[BagMessage]:
        found = self._found(names, since_ns, until_ns)
        return (self._bag_message(file, one) for file, one in found)

    def _found(
        self, names: set[str] | None, since_ns: int | None = None, until_ns: int | None = None
    ) -> Iterator[tuple[McapFile, Found]]:
        parts = [self._found_in(file, names, since_ns, until_ns) for file in self._files]
        spans = [span for file in self._files if (span := file.span) is not None]
        if all(before[1] <= after[0] for before, after in pairwise(spans)):
            return chain.from_iterable(parts)
        return heapq.merge(*parts, key=lambda part: part[1].message.log_time)

    def _found_in(
        self, file: McapFile, names: set[str] | None, since_ns: int | None, until_ns: int | None
    ) -> Iterator[tuple[McapFile, Found]]:
        chosen = {c for c, channel in file.channels.items() if names and channel.topic in names}
        wanted = None if names is None else chosen
        return ((file, found) for found in file.messages(wanted, since_ns, until_ns))

    def _bag_message(self, file: McapFile, found: Found) -> BagMessage:
        message = found.message
        channel = file.channels[message.channel_id]
        schema = file.schemas.get(channel.schema_id)
        name = "" if schema is None else schema.name
        text = schema.data.decode(errors="replace") if schema is not None else ""
        return BagMessage(
            channel.topic,
            name,
            message.log_time,
            message.data,
            text,
            lambda: self._decode(channel, schema, message),
            found.doubt,
            channel.message_encoding,
        )

    def _decode(self, channel: Channel, schema: Schema | None, message: Message) -> Any:
        where = f"topic {channel.topic}, message at {message.log_time} ns"
        if schema is None or channel.message_encoding != "cdr":
            raise BagError(f"{where}: expected a CDR message of a known type")
        try:
            return self._store(schema).deserialize_cdr(message.data, schema.name)
        except Exception as error:  # whatever the decoder makes of damaged bytes
            text = f"{type(error).__name__} {error}".strip()
            raise BagError(f"{where}: cannot be decoded as {schema.name} ({text})") from None

    def _store(self, schema: Schema) -> Typestore:
        """Return types that define the one of a schema as the bag does."""
        if schema.encoding != "ros2msg" or schema.name in _standard().fielddefs:
            return typestore()
        key = (schema.name, schema.data)
        if key not in self._stores:
            parts = split_schema(schema.name, schema.data.decode(errors="replace"))
            own = {name: text for name, text in parts.items() if name not in _standard().fielddefs}
            ours = own.items() <= message_texts().items()
            self._stores[key] = typestore() if ours else new_typestore(own)
        return self._stores[key]

    def _survey(self) -> tuple[Topic, ...]:
        """Return the topics with the numbers that were read, or else those that the file tells."""
        counts: dict[tuple[str, str], int] = {}
        for file in self._files:
            told = {} if file.statistics is None else file.statistics.channel_message_counts
            tallies = told if file.tallies is None else file.tallies
            for number, channel in file.channels.items():
                schema = file.schemas.get(channel.schema_id)
                key = channel.topic, "" if schema is None else schema.name
                counts[key] = counts.get(key, 0) + tallies.get(number, 0)
        return tuple(Topic(name, kind, n) for (name, kind), n in sorted(counts.items()))


@cache
def _standard() -> Typestore:
    """Return the types of ROS 2 Jazzy alone."""
    return new_typestore({})
