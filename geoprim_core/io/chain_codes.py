"""Curve files: JSON of Freeman chain codes, and CSV of published rows to compare with."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core.errors import FileError

_STEPS = np.array([(1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1)])


def decode_chain(code: str, start: tuple[float, float] = (0.0, 0.0)) -> FloatArray:
    """Return the pixels of a Freeman code: 0 is (+1, 0), 2 is (0, -1), y pointing down.

    The end pixel of a closed code, which is its start, is left out.

    Raises
    ------
    FileError
        The code holds something other than the digits 0 to 7.

    Examples
    --------
    >>> decode_chain("0642").tolist()
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    """
    if not set(code) <= set("01234567"):
        raise FileError("a chain code holds something other than the digits 0 to 7")
    steps = _STEPS[np.array([int(digit) for digit in code], dtype=np.int64)]
    curve = np.vstack([np.zeros((1, 2)), steps.cumsum(axis=0)]) + np.asarray(start, np.float64)
    pixels: FloatArray = curve[:-1] if len(curve) > 1 and (curve[-1] == curve[0]).all() else curve
    return pixels


def read_chain_codes(path: Path) -> dict[str, FloatArray]:
    """Read closed curves from JSON: {name: {"code": digits, "start": [x, y]}}.

    Raises
    ------
    FileError
        The file cannot be read, or is not of that form.
    """
    try:
        entries = json.loads(path.read_text())
        return {
            name: decode_chain(str(entry["code"]), tuple(entry.get("start", (0, 0))))
            for name, entry in entries.items()
        }
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as problem:
        raise FileError(f"{path}: no chain codes of curves ({problem})") from None


def read_published_rows(path: Path) -> list[dict[str, str]]:
    """Read rows of published tables: columns shape, method, param, M, N, MD, ISE and others.

    Raises
    ------
    FileError
        The file cannot be read or lacks one of those columns.
    """
    try:
        with path.open(newline="") as file:
            rows = list(csv.DictReader(file))
    except OSError as problem:
        raise FileError(f"{path}: {problem.strerror}") from None
    if not rows or not {"shape", "method", "param", "N", "ISE", "MD"} <= set(rows[0]):
        raise FileError(f"{path}: no columns shape, method, param, N, ISE, MD")
    return rows
