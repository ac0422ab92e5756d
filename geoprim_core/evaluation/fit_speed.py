"""How long the ellipse fits take, one call and ten thousand arcs, beside those of others.

Seconds are those of the processor, which other work on the machine disturbs least.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core.errors import InputError
from geoprim_core.evaluation.speed import one_processor
from geoprim_core.fitting import TABLE, fit_ellipses, point_at
from geoprim_core.types import Contours, Ellipse

_SLOW = 40e-6  # a fit that takes longer is timed on a tenth of the arcs
_RUN = 1e-3  # seconds of calls that are timed together


@dataclass(frozen=True, slots=True)
class FitTime:
    """Seconds of a fit: least and median of a single call, least of a batch and a loop, an arc."""

    name: str
    single: float
    median: float
    batch: float
    loop: float


def random_arcs(count: int, seed: int = 1) -> list[FloatArray]:
    """Return arcs (n, 2) of 50 to 300 noisy points of random ellipses.

    Parameters
    ----------
    count : int
    seed : int

    Examples
    --------
    >>> all(50 <= len(arc) <= 300 for arc in random_arcs(5))
    True
    """
    random = np.random.default_rng(seed)
    arcs = []
    for _ in range(count):
        major = random.uniform(20, 150)
        x, y, ratio, angle = random.uniform((0, 0, 0.2, 0), (600, 600, 1, 3))
        ellipse = Ellipse(x, y, major, major * ratio, angle)
        points, start = int(random.integers(50, 301)), random.uniform(0, 6)
        t = np.linspace(start, start + random.uniform(1.5, 6.2), points)
        arcs.append(point_at(ellipse, t) + random.normal(0, 0.4, (points, 2)))
    return arcs


def measure_fits(
    peers: Mapping[str, Callable[[Any], object]],
    arcs: int = 10_000,
    repeat: int = 15,
    after_round: Callable[[], object] | None = None,
) -> list[FitTime]:
    """Time every method of ours and of others in one run on one processor, by turns.

    A single call has 300 points. Ours take all arcs in one call, others in a loop and as float32.

    Parameters
    ----------
    peers : mapping of name to callable(points)
    arcs : int
    repeat : int
    after_round : callable or None
        Called after every round over the methods, for a progress bar.

    Raises
    ------
    InputError
        A repeat or a number of arcs below 1.

    Examples
    --------
    >>> [t.name for t in measure_fits({}, arcs=2, repeat=1)][:2]
    ['nsaf', 'ellifit']
    """
    if arcs < 1 or repeat < 1:
        raise InputError("arcs, repeat", "at least one of each", f"{arcs}, {repeat}")
    own = random_arcs(arcs)
    ours, narrow = _Arcs.of(own), [arc.astype(np.float32) for arc in own]
    t = np.linspace(0.0, 4.0, 300)
    points = point_at(Ellipse(320, 240, 90, 50, 0.7), t)
    points += np.random.default_rng(2).normal(0, 0.4, points.shape)
    single: dict[str, Callable[[], object]] = {
        row.name: _call(row.function, points) for row in TABLE
    }
    single |= {name: _call(fit, points.astype(np.float32)) for name, fit in peers.items()}
    with one_processor():
        seconds = _by_turns(single, repeat, after_round)
        batch: dict[str, Callable[[], object]] = {}
        loops: dict[str, Callable[[], object]] = {}
        shares = {}
        for name in single:
            share = arcs if seconds[name].min() < _SLOW else max(arcs // 10, 1)
            shares[name] = share
            if name in peers:
                batch[name] = partial(_loop, peers[name], narrow[:share])
            else:
                batch[name] = partial(fit_ellipses, ours.first(share), name)
                loops[f"{name} by single calls"] = partial(_loop, TABLE[name].function, own[:share])
        batches = _by_turns(batch | loops, min(repeat, 7), after_round)
    return [
        FitTime(
            name,
            float(seconds[name].min()),
            float(np.median(seconds[name])),
            float(batches[name].min()) / shares[name],
            float(batches.get(f"{name} by single calls", batches[name]).min()) / shares[name],
        )
        for name in single
    ]


def fit_speed_markdown(rows: Iterable[FitTime], reference: str) -> str:
    """Return the table: microseconds, and ratios to the reference's single call and loop.

    Examples
    --------
    >>> rows = [FitTime("a", 2e-6, 3e-6, 1e-6, 4e-6), FitTime("b", 4e-6, 4e-6, 2e-6, 2e-6)]
    >>> print(fit_speed_markdown(rows, "b").splitlines()[-2])
    | a | 2.0 | 3.0 | 0.50 | 1.00 | 4.0 | 2.0 |
    """
    rows = list(rows)
    base = next((row for row in rows if row.name == reference), None)
    lines = [
        f"| method | one call, least us | median us | to {reference} | batch us an arc | "
        f"times faster than a loop of its calls | than one of {reference} |",
        "|---|---:|---:|---:|---:|---:|---:|",
    ]
    for row in rows:
        ratio = f"{row.single / base.single:.2f}" if base else ""
        gain = f"{base.batch / row.batch:.1f}" if base else ""
        cells = f"{row.single * 1e6:.1f} | {row.median * 1e6:.1f} | {ratio}"
        own = f"{row.loop / row.batch:.1f}"
        lines.append(f"| {row.name} | {cells} | {row.batch * 1e6:.2f} | {own} | {gain} |")
    return "\n".join(lines) + "\n"


@dataclass(frozen=True, slots=True, eq=False)
class _Arcs:
    contours: Contours

    @classmethod
    def of(cls, arcs: list[FloatArray]) -> _Arcs:
        offsets = np.cumsum([0, *(len(arc) for arc in arcs)])
        return cls(Contours(np.concatenate(arcs), offsets, np.zeros(len(arcs), bool)))

    def first(self, count: int) -> Contours:
        whole = self.contours
        offsets = whole.offsets[: count + 1]
        return Contours(whole.points[: offsets[-1]], offsets, whole.closed[:count])


def _call(function: Callable[[Any], object], points: Any) -> Callable[[], object]:
    return lambda: function(points)


def _by_turns(
    calls: Mapping[str, Callable[[], object]],
    repeat: int,
    after_round: Callable[[], object] | None,
) -> dict[str, FloatArray]:
    """Return seconds a call (repeat,); the methods take turns, so that all see the same load."""
    counts = {}
    for name, call in calls.items():
        call()
        least = min(_seconds(call, 1) for _ in range(3))
        counts[name] = max(1, int(_RUN / max(least, 1e-9)))
    seconds = {name: np.empty(repeat) for name in calls}
    for k in range(repeat):
        for name, call in calls.items():
            seconds[name][k] = _seconds(call, counts[name])
        if after_round is not None:
            after_round()
    return seconds


def _seconds(call: Callable[[], object], count: int) -> float:
    start = time.process_time()
    for _ in range(count):
        call()
    return (time.process_time() - start) / count


def _loop(fit: Callable[[Any], object], arcs: list[Any]) -> None:
    for arc in arcs:
        fit(arc)
