"""What a process takes of the machine, and whether that grows."""

from __future__ import annotations

import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from geoprim_core._check import FloatArray

_MB = 1024.0  # kilobytes, as the system tells them


class Sample(NamedTuple):
    """What a process takes: memory in megabytes (2^20 bytes), threads, handles, segments.

    `resident` is all that is in memory, `shared_out` counts shared pages in parts (PSS),
    `anonymous` is what the process has allocated itself, and `segments` are those of Fast DDS
    that it has mapped, its own and those of its peers.
    """

    resident: float
    shared_out: float
    anonymous: float
    threads: int
    handles: int
    segments: int


def sample(pid: int) -> Sample | None:
    """Return what a process takes now, or None where it has ended."""
    folder = Path("/proc", str(pid))
    with suppress(OSError, KeyError):
        memory = _numbers(folder / "smaps_rollup")
        maps = (folder / "maps").read_text(errors="replace").splitlines()
        segments = {line.rpartition("/")[2] for line in maps if "/dev/shm/fastrtps_" in line}
        return Sample(
            memory["Rss"] / _MB,
            memory["Pss"] / _MB,
            memory["Anonymous"] / _MB,
            _numbers(folder / "status")["Threads"],
            len(os.listdir(folder / "fd")),
            len(segments),
        )
    return None


def _numbers(path: Path) -> dict[str, int]:
    found = {}
    for line in path.read_text().splitlines():
        name, _, value = line.partition(":")
        word = value.split()[0] if value.split() else ""
        if word.isdigit():
            found[name] = int(word)
    return found


@dataclass(frozen=True)
class Drift:
    """A straight line through a measured course.

    Attributes
    ----------
    slope, start : float
        Growth per unit of x, and the value at x = 0.
    error : float
        Standard error of the slope. Neighbouring samples are alike, and counted as the fewer
        independent ones that they are worth.
    """

    slope: float
    start: float
    error: float


def drift(x: FloatArray, y: FloatArray) -> Drift:
    """Fit a line by least squares; three samples at least, else the error is infinite.

    Examples
    --------
    >>> x = np.arange(50.0)
    >>> found = drift(x, 2.0 + 0.5 * x)
    >>> round(found.slope, 6), round(found.start, 6), found.error < 1e-6
    (0.5, 2.0, True)
    """
    if len(x) < 3:
        return Drift(0.0, float(np.mean(y)) if len(y) else 0.0, float("inf"))
    from_mean = x - x.mean()
    spread = float(from_mean @ from_mean)
    slope = float(from_mean @ y) / spread
    rest = y - y.mean() - slope * from_mean
    variance = float(rest @ rest) / (len(x) - 2)
    worth = _independent(rest)
    error = np.sqrt(variance / spread * len(x) / worth)
    return Drift(slope, float(y.mean() - slope * x.mean()), float(error))


def _independent(rest: FloatArray) -> float:
    """Return how many independent values a course is worth, by its autocorrelation at lag 1."""
    power = float(rest @ rest)
    alike = float(rest[1:] @ rest[:-1]) / power if power > 0 else 0.0
    alike = min(max(alike, 0.0), 1.0)
    return max(2.0, len(rest) * (1.0 - alike) / (1.0 + alike))
