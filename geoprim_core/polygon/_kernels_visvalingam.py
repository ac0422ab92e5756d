"""Kernel of Visvalingam and Whyatt's method."""

from __future__ import annotations

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.polygon._kernels import farthest_pair_of
from geoprim_core.polygon._kernels_heap import put, take_out


@kernel
def _area(points: FloatArray, a: int, b: int, c: int) -> float:
    ux, uy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    vx, vy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
    return float(0.5 * abs(ux * vy - uy * vx))


@kernel
def visvalingam_of(points: FloatArray, closed: bool, area: float, least: int) -> IntArray:
    """Drop the point of least triangle while that is below `area` and more than `least` are left.

    An open curve keeps its ends, a closed one its two mutually farthest points.
    """
    count = len(points)
    if count == 0:
        return np.empty(0, np.int64)
    first, second = 0, count - 1
    if closed:
        first, second = farthest_pair_of(points)
    before, after = np.arange(count) - 1, np.arange(count) + 1
    before[0], after[count - 1] = count - 1, 0
    kept = np.ones(count, np.bool_)
    items, place = np.empty(count, np.int64), np.full(count, -1)
    key, size = np.zeros(count), np.zeros(1, np.int64)
    for i in range(count):
        if i != first and i != second:
            put(items, place, key, size, i, _area(points, before[i], i, after[i]))
    left = count
    least = least if first != second else 1
    while size[0] > 0 and left > least:
        i = items[0]
        value = key[i]
        if value >= area:
            break
        take_out(items, place, key, size, i)
        kept[i] = False
        left -= 1
        a, b = before[i], after[i]
        after[a], before[b] = b, a
        for j in (a, b):
            if place[j] >= 0:  # effective areas never fall below that of a dropped point
                put(items, place, key, size, j, max(value, _area(points, before[j], j, after[j])))
    return np.flatnonzero(kept)
