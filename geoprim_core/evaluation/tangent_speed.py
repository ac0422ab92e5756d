"""How long each tangent method takes for a pixel, measured on one processor."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core.synthetic.boundaries import without_repeats
from geoprim_core.tangent import TABLE

SIZES = (1_000, 1_000_000)


@dataclass(frozen=True)
class TangentTimes:
    """Times of tangent methods: `nanoseconds` is (methods, sizes) a pixel, NaN: not measured."""

    names: tuple[str, ...]
    sizes: tuple[int, ...]
    nanoseconds: FloatArray

    def markdown(self) -> str:
        """Return the table: method, nanoseconds a pixel on a circle of so many pixels."""
        heads = [f"ns a pixel, {size:,} px" for size in self.sizes]
        lines = [f"| method | {' | '.join(heads)} |", "|---|" + "---:|" * len(heads)]
        for name, row in zip(self.names, self.nanoseconds, strict=True):
            cells = ["" if math.isnan(value) else f"{value:,.0f}" for value in row]
            lines.append(f"| {name} | {' | '.join(cells)} |")
        return "\n".join(lines)


def pixel_circle(pixels: int) -> FloatArray:
    """Return a closed 8-connected digital circle of about so many pixels about the origin.

    Examples
    --------
    >>> circle = pixel_circle(1000)
    >>> len(circle), float(np.hypot(*circle.T).max().round())
    (1000, 177.0)
    """
    radius = pixels / (4.0 * math.sqrt(2.0))
    reach = int(radius / math.sqrt(2.0)) + 1
    u = np.arange(-reach, reach + 1.0)
    side = np.stack([u, np.floor(np.sqrt(radius**2 - u**2) + 0.5)], axis=1)
    sides = [side[np.abs(u) <= side[:, 1]]]
    for _ in range(3):
        sides.append(np.stack([sides[-1][:, 1], -sides[-1][:, 0]], axis=1))
    return without_repeats(np.concatenate(sides), closed=True)


def measure_tangents(
    names: Iterable[str],
    sizes: Iterable[int] = SIZES,
    *,
    repeat: int = 5,
    largest_hybrid: int = 100_000,
    after_method: Callable[[], object] = lambda: None,
) -> TangentTimes:
    """Time methods with their defaults on digital circles; the least of `repeat` runs counts.

    Parameters
    ----------
    names : names of the tangent table
    sizes : pixels of the circles
    repeat : int
    largest_hybrid : int
        Hybrid methods are measured on no longer curve.
    after_method : called after every method

    Examples
    --------
    >>> times = measure_tangents(["deb", "lr1_h3"], [200, 400], repeat=1, largest_hybrid=300)
    >>> np.isnan(times.nanoseconds).tolist()
    [[False, False], [False, True]]
    """
    chosen, lengths = tuple(names), tuple(sizes)
    circles = [pixel_circle(size) for size in lengths]
    table = np.full((len(chosen), len(circles)), np.nan)
    for i, name in enumerate(chosen):
        for k, circle in enumerate(circles):
            if len(circle) <= largest_hybrid or "_h" not in name:
                table[i, k] = _nanoseconds(name, circle, repeat)
        after_method()
    return TangentTimes(chosen, lengths, table)


def _nanoseconds(name: str, circle: FloatArray, repeat: int) -> float:
    function, params = TABLE[name].function, TABLE[name].params()
    function(circle[:64], closed=False, params=params)  # compiles
    times = []
    for _ in range(repeat):
        start = time.thread_time()  # other work on the machine does not count
        function(circle, closed=True, params=params)
        times.append(time.thread_time() - start)
    return min(times) / len(circle) * 1e9
