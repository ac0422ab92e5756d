"""How long the polygon methods take, beside other libraries, on one processor."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core.evaluation.speed import one_processor
from geoprim_core.polygon import TABLE, OptimalParams, approximate, optimal
from geoprim_core.types import Contours

# Peer -> the statements that make `run`, a call without arguments, from `curves`, a list of (n, 2)
# float64 arrays, each closed by its first point where `closed`.
PEERS = {
    "shapely": (
        "import shapely, numpy\n"
        "lines = numpy.array([shapely.linestrings(c) for c in curves])\n"
        "run = lambda: shapely.simplify(lines, 1.0, preserve_topology=False)\n"
    ),
    "opencv": (
        "import cv2\n"
        "cv2.setNumThreads(1)\n"
        "pixels = [c.astype(numpy.int32) for c in curves]\n"
        "run = lambda: [cv2.approxPolyDP(p, 1.0, False) for p in pixels]\n"
    ),
}
_SCRIPT = """import sys, time, numpy
data = numpy.load(sys.argv[1])
curves = numpy.split(data["points"], data["offsets"][1:-1])
if data["closed"]:
    curves = [numpy.vstack([c, c[:1]]) for c in curves]
{peer}
best = float("inf")
for _ in range(int(sys.argv[2])):
    start = time.perf_counter()
    run()
    best = min(best, time.perf_counter() - start)
print(best)
"""


def outlines(count: int = 1000, seed: int = 0) -> Contours:
    """Return closed digital outlines of some 100 to 600 pixels.

    Examples
    --------
    >>> contours = outlines(3)
    >>> bool(contours.closed.all()), bool((np.diff(contours.offsets) > 80).all())
    (True, True)
    """
    generator = np.random.default_rng(seed)
    curves = [_outline(int(n), generator) for n in generator.integers(100, 600, count)]
    offsets = np.cumsum([0, *map(len, curves)])
    return Contours(np.concatenate(curves), offsets, np.ones(count, bool))


def _outline(pixels: int, generator: np.random.Generator) -> FloatArray:
    t = np.linspace(0.0, 2.0 * np.pi, 40 * pixels, endpoint=False)
    radius = np.full(len(t), pixels / 6.5)
    for lobes in range(2, 7):
        phase = generator.uniform(0.0, 2.0 * np.pi)
        radius += pixels / 6.5 * generator.uniform(0.0, 0.25) / lobes * np.cos(lobes * t + phase)
    outline = np.rint(np.stack([radius * np.cos(t), radius * np.sin(t)], axis=1))
    distinct: FloatArray = outline[(outline != np.roll(outline, 1, axis=0)).any(axis=1)]
    return distinct


def long_wave(count: int = 100_000) -> FloatArray:
    """Return a long digital sine."""
    x = np.arange(count)
    return np.stack([x, np.rint(300.0 * np.sin(x / 500.0))], axis=1)


def comb(count: int = 100_000, tooth: int = 10) -> FloatArray:
    """Return a comb, on which plain splitting is quadratic."""
    k = np.arange(count)
    column, step = np.divmod(k, tooth)
    y = np.where(column % 2 == 0, step, tooth - 1 - step)
    return np.stack([2.0 * column, y], axis=1)


def spiral(count: int = 100_000) -> FloatArray:
    """Return a square digital spiral."""
    sides = np.repeat(np.arange(1, int(np.sqrt(count)) + 2), 2)
    turns = np.repeat(np.arange(len(sides)) % 4, sides)[: count - 1]
    steps = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)])[turns]
    points: FloatArray = np.vstack([[(0, 0)], np.cumsum(steps, axis=0)]).astype(np.float64)
    return points


def _one(points: FloatArray) -> Contours:
    return Contours(points, np.array([0, len(points)]), np.array([False]))


WORKLOADS: dict[str, Callable[[], Contours]] = {
    "1,000 outlines": outlines,
    "wave, 100,000": lambda: _one(long_wave()),
    "comb, 100,000": lambda: _one(comb()),
    "spiral, 100,000": lambda: _one(spiral()),
}


LONGEST = {"optimal": 10_000}
"""Pixels of the longest curve that a method is timed on: an exact polygon refuses more states."""
_ENOUGH = 5.0  # seconds of one method on one workload after which it is not run again

OPTIMAL_CASES = ((600, 40), (5000, 40), (5000, 300))
"""Pixels of a closed outline, and N: the lengths at which an exact polygon is asked for."""


@dataclass(frozen=True, slots=True, eq=False)
class PolygonTimes:
    """Seconds of every method and peer on every workload; NaN where there is no answer."""

    workloads: tuple[str, ...]
    points: tuple[int, ...]
    seconds: Mapping[str, Sequence[float]]
    reference: str

    def markdown(self) -> str:
        """Return microseconds a point, and in brackets the ratio to the reference."""
        lines = ["| method | " + " | ".join(self.workloads) + " |"]
        lines.append("|---|" + "---:|" * len(self.workloads))
        base = self.seconds[self.reference]
        for name, times in self.seconds.items():
            cells = [
                "-" if np.isnan(t) else f"{t / n * 1e6:.3f} ({t / b:.2f})"
                for t, n, b in zip(times, self.points, base, strict=True)
            ]
            lines.append(f"| {name} | " + " | ".join(cells) + " |")
        head = f"Microseconds a point (ratio to {self.reference}), the least of the runs:\n\n"
        return head + "\n".join(lines) + "\n"


def measure_polygons(
    methods: Sequence[str] = TABLE.names,
    workloads: Mapping[str, Callable[[], Contours]] = WORKLOADS,
    pythons: Mapping[str, str] | None = None,
    repeat: int = 5,
) -> PolygonTimes:
    """Time methods and peers on the same curves, one processor, one thread.

    A peer that is not installed in the Python that runs it, or ends by itself, has NaN.

    Examples
    --------
    >>> few = {"few": lambda: outlines(2)}
    >>> times = measure_polygons(["rdp_mod"], few, {"opencv": sys.executable}, repeat=1)
    >>> list(times.seconds)
    ['opencv', 'rdp_mod']
    """
    chosen = dict.fromkeys(PEERS, sys.executable) if pythons is None else pythons
    curves = {name: make() for name, make in workloads.items()}
    with one_processor():
        seconds = {
            peer: [time_peer(peer, python, c, repeat) for c in curves.values()]
            for peer, python in chosen.items()
        }
        for method in methods:
            approximate(_one(np.zeros((3, 2))), method)  # compiled before the clock starts
            seconds[method] = [_time_method(method, c, repeat) for c in curves.values()]
    answered = [name for name, times in seconds.items() if not np.isnan(times).all()]
    reference = next(name for name in ("shapely", "opencv", *methods) if name in answered)
    points = tuple(len(c.points) for c in curves.values())
    return PolygonTimes(tuple(curves), points, seconds, reference)


def _time_method(method: str, contours: Contours, repeat: int) -> float:
    """Return the least seconds; NaN where a curve is too long for the method."""
    if np.diff(contours.offsets).max() > LONGEST.get(method, np.inf):
        return float("nan")
    return _least_time(lambda: approximate(contours, method), repeat)


def _least_time(run: Callable[[], object], repeat: int) -> float:
    best, begin = np.inf, time.perf_counter()
    for _ in range(repeat):
        start = time.perf_counter()
        run()
        best = min(best, time.perf_counter() - start)
        if time.perf_counter() - begin > _ENOUGH:
            break
    return float(best)


def measure_optimal(
    cases: Sequence[tuple[int, int]] = OPTIMAL_CASES, repeat: int = 5, seed: int = 0
) -> str:
    """Return a Markdown table: milliseconds of the polygon of N vertices and least ISE.

    Examples
    --------
    >>> measure_optimal(((100, 8),), repeat=1).splitlines()[0]
    '| optimal, closed | N | ms |'
    """
    lines = ["| optimal, closed | N | ms |", "|---|---:|---:|"]
    generator = np.random.default_rng(seed)
    with one_processor():
        for pixels, vertices in cases:
            curve = _outline(pixels, generator)
            params = OptimalParams(vertices, measure="ise")
            optimal(curve[:50], closed=True, params=OptimalParams(5, measure="ise"))  # compiled
            best = _least_time(lambda c=curve, p=params: optimal(c, closed=True, params=p), repeat)  # type: ignore[misc]
            lines.append(f"| {len(curve)} px | {vertices} | {1e3 * best:.1f} |")
    return "\n".join(lines) + "\n"


def time_peer(peer: str, python: str, contours: Contours, repeat: int) -> float:
    """Return the least seconds of a peer in a Python of its own; NaN where it gives none."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "curves.npz"
        np.savez(
            file, points=contours.points, offsets=contours.offsets, closed=contours.closed.all()
        )
        script = _SCRIPT.format(peer=PEERS[peer])
        command = [python, "-c", script, str(file), str(repeat)]
        try:
            done = subprocess.run(command, capture_output=True, timeout=120, check=True, text=True)
        except (OSError, subprocess.SubprocessError):
            return float("nan")
        return float(done.stdout)
