"""Which schemas and channels a file has, and how far each can be believed."""

from __future__ import annotations

from enum import IntEnum
from typing import Any

from mcap.records import Channel, Schema


class Grade(IntEnum):
    """How far something read from a file can be believed."""

    WRONG = 0  # its checksum fails
    DOUBTFUL = 1  # its checksum cannot be had, and something around it is damaged
    PLAIN = 2  # it never had a checksum
    PROVED = 3  # its checksum holds


class Catalogue:
    """The schemas and channels of a file by their ids; the best proved description counts.

    Attributes
    ----------
    schemas, channels : dict
        Id -> record.
    conflicts : set of (kind, id)
        What is described in two ways by places whose checksums do not fail.
    """

    def __init__(self) -> None:
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}
        self.conflicts: set[tuple[str, int]] = set()
        self._unsettled: set[tuple[str, int]] = set()  # no side is better proved
        self._grades: dict[tuple[str, int], Grade] = {}

    def add(self, record: Schema | Channel, grade: Grade) -> None:
        """Take in a description."""
        table: dict[int, Any] = self.schemas if isinstance(record, Schema) else self.channels
        key = type(record).__name__.lower(), record.id
        old, known = self._grades.get(key, -1), table.get(record.id)
        if known is not None and known != record and min(grade, old) >= Grade.PLAIN:
            self.conflicts.add(key)
            if grade == old:
                self._unsettled.add(key)
        if grade > old:
            table[record.id], self._grades[key] = record, grade
            self._unsettled.discard(key)

    def doubt(self, number: int) -> str:
        """Return why the topic or the type of a channel may be wrong; empty when they are sure."""
        channel = self.channels.get(number)
        if channel is None:
            return "its channel is not described"
        keys = [("channel", number)]
        if channel.schema_id:
            keys.append(("schema", channel.schema_id))
        for key in keys:
            grade = self._grades.get(key)
            if grade is None:
                return "its type is not described"
            if grade < Grade.PLAIN:
                return f"its {key[0]} is described only in a damaged part"
            if key in self._unsettled:
                return f"its {key[0]} is described in two ways"
        return ""
