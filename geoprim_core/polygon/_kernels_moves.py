"""Kernels of a vertex that moves: what its two segments cost, and where they cost least.

The cost of a segment is its squared error or its largest deviation; costs are added in the first
case, the larger one counts in the second.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel
from geoprim_core.polygon._kernels_reach import (
    Hulls,
    block_hulls,
    farthest_by_hulls,
    no_hulls,
)
from geoprim_core.polygon._kernels_segments import running_moments, squared_error

LONG = 1024  # points of a segment whose deviation is worth a look at the hulls


class Curve(NamedTuple):
    """A curve, written twice if it is closed, with what segments need."""

    x: FloatArray
    y: FloatArray
    sums: FloatArray
    hulls: Hulls
    size: int
    closed: bool
    by_error: bool
    window: int
    moves: int


@kernel
def curve_of(points: FloatArray, closed: bool, by_error: bool, window: int, moves: int) -> Curve:
    """Lay a curve out for the methods: coordinates, running sums, hulls where it is long."""
    count = len(points)
    total = 2 * count if closed else count
    x, y = np.empty(total), np.empty(total)
    for i in range(total):
        source = i if i < count else i - count
        x[i], y[i] = points[source, 0], points[source, 1]
    hulls = block_hulls(x, y, total) if total > LONG else no_hulls()
    return Curve(x, y, running_moments(x, y, total), hulls, count, closed, by_error, window, moves)


@kernel
def largest_deviation(x: FloatArray, y: FloatArray, hulls: Hulls, low: int, high: int) -> float:
    """Return the largest deviation of a segment."""
    dx, dy = x[high] - x[low], y[high] - y[low]
    length = math.sqrt(dx * dx + dy * dy)
    if high - low > LONG or length == 0.0:
        return farthest_by_hulls(x, y, hulls, low, high)[1]
    largest = 0.0
    for i in range(low + 1, high):
        largest = max(largest, abs(dx * (y[i] - y[low]) - dy * (x[i] - x[low])))
    return largest / length


@kernel
def error_between(
    x: FloatArray, y: FloatArray, sums: FloatArray, count: int, a: int, b: int
) -> float:
    """Return the squared error of the segment from vertex a on to vertex b."""
    return squared_error(x, y, sums, a, b if b > a else b + count)


@kernel
def place_of_least_error(
    x: FloatArray, y: FloatArray, sums: FloatArray, count: int, window: int, a: int, middle: int,
    last: int,
) -> tuple[int, float]:  # fmt: skip
    """Return the place of least squared error, as below, and the change of the error."""
    shift = count if middle >= count else 0
    now = squared_error(x, y, sums, a, middle)
    now += squared_error(x, y, sums, middle - shift, last - shift)
    place, best = middle, now - 1e-9 * (1.0 + now)  # rounding is no improvement
    for side in (-1, 1):
        q, idle = middle + side, 0
        while a < q < last and idle < window:
            idle += 1
            value = squared_error(x, y, sums, a, q)
            if value < best:
                value += squared_error(x, y, sums, q, last)
            if value < best:
                place, best, idle = q, value, 0
            q += side
    return place, (best - now if place != middle else 0.0)


@kernel
def _is_beyond(x: FloatArray, y: FloatArray, low: int, high: int, i: int, limit: float) -> bool:
    """Tell whether a point, if it is one of the segment's, is beyond a distance from its line."""
    dx, dy = x[high] - x[low], y[high] - y[low]
    value = abs(dx * (y[i] - y[low]) - dy * (x[i] - x[low]))
    return bool(low < i < high and value > limit * math.sqrt(dx * dx + dy * dy) > 0.0)


@kernel
def place_of_least_deviation(
    x: FloatArray, y: FloatArray, hulls: Hulls, window: int, a: int, middle: int, last: int
) -> tuple[int, float, float]:
    """Return where between a and last the vertex `middle` deviates least, and both deviations.

    Places are those of the curve written twice. The vertex stays where ties. The search goes
    from it either way and ends after `window` points without a gain. On a closed curve it may
    reach all of the curve but one point (a and last are the same).

    The points that were too far off at one place are looked at first at the next, which settles
    most places. Then comes the segment that has grown: it is the likelier one to fail.
    """
    place, best, first, second = middle, np.inf, 0.0, 0.0
    first_far, second_far = -1, -1
    for side in (0, -1, 1):  # first where it is
        q, idle = middle + side, 0
        while a < q < last and idle < window:
            idle += 1
            one = two = np.inf
            known = _is_beyond(x, y, a, q, first_far, best)
            if not known and not _is_beyond(x, y, q, last, second_far, best):
                for turn in range(2):
                    is_first = (turn == 0) == (side > 0)
                    low, high = (a, q) if is_first else (q, last)
                    dx, dy = x[high] - x[low], y[high] - y[low]
                    length = math.sqrt(dx * dx + dy * dy)
                    value, far = 0.0, low
                    if high - low > LONG or length == 0.0:
                        far, value = farthest_by_hulls(x, y, hulls, low, high)
                    else:
                        enough = best * length
                        for i in range(low + 1, high):
                            away = abs(dx * (y[i] - y[low]) - dy * (x[i] - x[low]))
                            if away > value:
                                value, far = away, i
                                if value > enough:
                                    break
                        value /= length
                    if is_first:
                        one, first_far = value, far
                    else:
                        two, second_far = value, far
                    if value >= best:
                        break
            if max(one, two) < best:
                place, best, idle = q, max(one, two), 0
                first, second = one, two
            if side == 0:
                best -= 1e-9 * (1.0 + best)  # rounding is no improvement
                break
            q += side
    return place, first, second
