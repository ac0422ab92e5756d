"""A recording in a folder, cut into files by size or by time."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

from geoprim_core.errors import FileError
from geoprim_core.io.bag_writer import BagWriter


@dataclass(frozen=True)
class Split:
    """When a new file starts: after so many bytes or seconds, 0 for never."""

    bytes: int = 0
    seconds: float = 0.0

    def __bool__(self) -> bool:
        return self.bytes > 0 or self.seconds > 0


class SplitWriter:
    """Writes FOLDER/FOLDER_0.mcap, FOLDER_1.mcap and so on; each is a bag of its own.

    A file is complete as soon as the next one starts. `BagReader` reads the folder as one bag.

    Parameters
    ----------
    folder : the folder, made where it is missing
    split : when to start a new file
    compression : of the chunks, see `BagWriter`

    Raises
    ------
    FileError
        The folder cannot be made or holds a recording already.
    """

    def __init__(self, folder: Path, split: Split, compression: str = "zstd") -> None:
        self._folder, self._split, self._compression = folder, split, compression
        self._number = 0
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise FileError(f"cannot write {folder}: {error.strerror or error}") from None
        if any(folder.glob("*.mcap")):
            raise FileError(f"cannot write {folder}: it holds a recording already")
        self._bag = self._open()

    def write_raw(
        self,
        topic: str,
        type_name: str,
        data: bytes,
        log_time_ns: int,
        definition: str = "",
        offered_qos: str = "",
    ) -> None:
        """Write a message, into a new file where the present one is full."""
        if self._full():
            self._bag.close()
            self._number += 1
            self._bag = self._open()
        self._bag.write_raw(topic, type_name, data, log_time_ns, definition, offered_qos)

    def flush(self) -> None:
        """Hand all to the system."""
        self._bag.flush()

    def close(self) -> None:
        """Finish the last file."""
        self._bag.close()

    def _full(self) -> bool:
        long = 0 < self._split.seconds <= time.monotonic() - self._opened
        return long or 0 < self._split.bytes <= self._bag.size

    def _open(self) -> BagWriter:
        self._opened = time.monotonic()
        path = self._folder / f"{self._folder.name}_{self._number}.mcap"
        return BagWriter(path, compression=self._compression, in_place=True)


def open_recording(path: Path, split: Split, compression: str) -> BagWriter | SplitWriter:
    """Return the writer of a recording: of one file, or of a folder where it is split."""
    if split:
        return SplitWriter(path, split, compression)
    return BagWriter(path, compression=compression, in_place=True)
