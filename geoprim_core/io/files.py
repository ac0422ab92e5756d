"""Folders and tables that commands write; what cannot be written is one line that says why."""

from __future__ import annotations

import csv
import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from geoprim_core.errors import FileError


def make_folder(path: str | os.PathLike[str]) -> Path:
    """Make a folder and those above it, and return it.

    Raises
    ------
    FileError
        It cannot be made, as where a file stands in its way.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     folder = make_folder(Path(place, "a", "b"))
    ...     found = folder.is_dir()
    >>> found
    True
    """
    folder = Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        file = next((p for p in (folder, *folder.parents) if p.exists() and not p.is_dir()), None)
        reason = problem.strerror if file is None else f"{file} is a file, not a folder"
        raise FileError(f"cannot write to {folder}: {reason}") from None
    return folder


def write_table(
    path: str | os.PathLike[str], heading: Sequence[str], rows: Iterable[Iterable[object]]
) -> None:
    """Write comma-separated values with a heading, and the folders above the file.

    Raises
    ------
    FileError
        The file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     write_table(Path(place, "t.csv"), ["x", "y"], [(1, 2.5)])
    ...     text = Path(place, "t.csv").read_text()
    >>> text.split()
    ['x,y', '1,2.5']
    """
    make_folder(Path(path).parent)
    try:
        with open(path, "w", newline="") as file:
            table = csv.writer(file)
            table.writerow(heading)
            table.writerows(rows)
    except OSError as problem:
        raise FileError(f"cannot write {path}: {problem.strerror}") from None
