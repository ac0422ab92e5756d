"""Which topics are played or recorded, and the part of a bag that is played; without ROS."""

from __future__ import annotations

import heapq
import re
from collections import deque
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from geoprim_core.errors import BagError, InputError
from geoprim_core.io.bags import BagMessage, BagReader, Topic


@dataclass(frozen=True)
class TopicFilter:
    """A choice of topics, by name and by pattern.

    Attributes
    ----------
    topics : collection of str
        Names to take, with or without a leading slash.
    regex : str
        Takes what it is found in, beside `topics`. Without both everything is taken.
    exclude_topics, exclude_regex
        What is left out of that.

    Raises
    ------
    InputError
        A pattern is not a regular expression.

    Examples
    --------
    >>> chosen = TopicFilter(topics=["image"], regex="^/left/", exclude_regex="depth$")
    >>> [n for n in ("/image", "/left/info", "/left/depth", "/right/info") if chosen.takes(n)]
    ['/image', '/left/info']
    """

    topics: Collection[str] = ()
    regex: str = ""
    exclude_topics: Collection[str] = ()
    exclude_regex: str = ""

    def __post_init__(self) -> None:
        for pattern in (self.regex, self.exclude_regex):
            try:
                re.compile(pattern)
            except re.error as problem:
                got = f"{pattern!r} ({problem})"
                raise InputError("regex", "a regular expression", got) from None

    def takes(self, name: str) -> bool:
        """Tell whether a topic is chosen."""
        everything = not (self.topics or self.regex)
        if not (everything or self.names(name) or (self.regex and re.search(self.regex, name))):
            return False
        if self.exclude_regex and re.search(self.exclude_regex, name):
            return False
        return not _same(name, self.exclude_topics)

    def names(self, name: str) -> bool:
        """Tell whether a topic is asked for by its name."""
        return _same(name, self.topics)

    def of(self, reader: BagReader) -> list[Topic]:
        """Return the chosen topics of a bag; a missing one that is named is a `BagError`."""
        for name in self.topics:
            reader.topic(name)
        return [topic for topic in reader.topics() if self.takes(topic.name)]


@dataclass(frozen=True, eq=False)
class BagRange:
    """The messages of some topics of a bag between two log times, both included.

    Attributes
    ----------
    reader : BagReader
    topics : names
    start_ns, end_ns : int
    latched : mapping of topic to int
        Topics whose last messages, so many of each, hold until newer ones come.

    Raises
    ------
    BagError
        The range ends before it starts.
    """

    reader: BagReader
    topics: Sequence[str]
    start_ns: int
    end_ns: int
    latched: Mapping[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.end_ns < self.start_ns:
            first, last = self.reader.time_range
            text = f"nothing to play between {self.start_ns} ns and {self.end_ns} ns"
            raise BagError(f"{self.reader.path}: {text}; the bag is from {first} ns to {last} ns")

    def messages(self, since_ns: int) -> Iterator[BagMessage]:
        """Yield the messages from some time to the end, by their log times."""
        return self.reader.messages(self.topics, since_ns, self.end_ns)

    def state_before(self, since_ns: int) -> Iterable[BagMessage]:
        """Return the latched messages that a reader would still have got at some time."""
        last: dict[str, deque[BagMessage]] = {n: deque(maxlen=d) for n, d in self.latched.items()}
        for message in self.reader.messages(list(last), until_ns=since_ns - 1) if last else ():
            last[message.topic].append(message)
        return heapq.merge(*last.values(), key=lambda message: message.log_time_ns)

    def between(self, start_ns: int | None = None, end_ns: int | None = None) -> BagRange:
        """Return a narrower range."""
        start = self.start_ns if start_ns is None else max(start_ns, self.start_ns)
        end = self.end_ns if end_ns is None else min(end_ns, self.end_ns)
        return replace(self, start_ns=start, end_ns=end)


def _same(name: str, names: Iterable[str]) -> bool:
    return name.lstrip("/") in {other.lstrip("/") for other in names}
