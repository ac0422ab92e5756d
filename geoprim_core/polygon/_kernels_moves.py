"""Kernels of a vertex that moves: what its two segments cost, and where they cost least.

The cost of a segment is its squared error (`by_error`) or its largest deviation; costs are added
in the first case, the larger one counts in the second.
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
def largest_deviation(
    x: FloatArray, y: FloatArray, hulls: Hulls, low: int, high: int, enough: float, hint: int
) -> tuple[float, int]:
    """Return the largest deviation of a segment, or one beyond `enough`, and where it is.

    The point `hint` is looked at first: where one place of a vertex failed, the next will.
    """
    dx, dy = x[high] - x[low], y[high] - y[low]
    length = math.sqrt(dx * dx + dy * dy)
    if high - low > LONG or length == 0.0:
        place, value = farthest_by_hulls(x, y, hulls, low, high)
        return value, place
    enough *= length
    if low < hint < high:
        value = abs(dx * (y[hint] - y[low]) - dy * (x[hint] - x[low]))
        if value > enough:
            return value / length, hint
    best, place = 0.0, low
    for i in range(low + 1, high):
        value = abs(dx * (y[i] - y[low]) - dy * (x[i] - x[low]))
        if value > best:
            best, place = value, i
            if best > enough:
                break
    return best / length, place


@kernel
def cost_of(
    x: FloatArray, y: FloatArray, sums: FloatArray, hulls: Hulls, count: int, by_error: bool,
    a: int, b: int,
) -> float:  # fmt: skip
    """Return the cost of the segment from vertex a on to vertex b."""
    high = b if b > a else b + count
    if by_error:
        return squared_error(x, y, sums, a, high)
    return largest_deviation(x, y, hulls, a, high, np.inf, -1)[0]


@kernel
def joined_cost(
    x: FloatArray, y: FloatArray, sums: FloatArray, hulls: Hulls, count: int, by_error: bool,
    a: int, v: int, b: int,
) -> float:  # fmt: skip
    """Return the cost of the two segments a-v-b."""
    first = cost_of(x, y, sums, hulls, count, by_error, a, v)
    second = cost_of(x, y, sums, hulls, count, by_error, v, b)
    return first + second if by_error else max(first, second)


@kernel
def best_place(
    x: FloatArray, y: FloatArray, sums: FloatArray, hulls: Hulls, count: int, by_error: bool,
    window: int, a: int, v: int, b: int, now: float,
) -> tuple[int, float]:  # fmt: skip
    """Return where between a and b the vertex v costs least, and what; it stays where ties.

    The search goes from v either way and ends after `window` points without a gain. On a closed
    curve it may reach all of the curve but one point (a = b).
    """
    middle = v if v > a else v + count  # indices of the curve written twice
    last = b if b > a else b + count
    place, best = v, now - 1e-9 * (1.0 + now)  # rounding is no improvement
    first_hint, second_hint = -1, -1
    for side in (-1, 1):
        q, idle = middle + side, 0
        while a < q < last and idle < window:
            if by_error:
                value = squared_error(x, y, sums, a, q)
                if value < best:
                    value += squared_error(x, y, sums, q, last)
            else:
                value, first_hint = largest_deviation(x, y, hulls, a, q, best, first_hint)
                if value < best:
                    other, second_hint = largest_deviation(x, y, hulls, q, last, best, second_hint)
                    value = max(value, other)
            idle += 1
            if value < best:
                place, best, idle = q, value, 0
            q += side
    return (place if place < count else place - count), (best if place != v else now)
