"""Kernel of the break points."""

from __future__ import annotations

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.polygon._kernels import farthest_pair_of


@kernel
def _distinct(points: FloatArray, closed: bool) -> IntArray:
    """Return the first index of every run of equal neighbours."""
    count = len(points)
    order = np.empty(count, np.int64)
    size = 0
    for i in range(count):
        if size == 0 or (
            points[i, 0] != points[order[size - 1], 0] or points[i, 1] != points[order[size - 1], 1]
        ):
            order[size] = i
            size += 1
    if closed and size > 1:
        i = order[size - 1]
        if points[i, 0] == points[0, 0] and points[i, 1] == points[0, 1]:
            size -= 1  # the last run goes on in the first
    return order[:size].copy()


@kernel
def _bends(points: FloatArray, a: int, b: int, c: int, tolerance: float) -> bool:
    """Tell whether the curve turns at b by more than the tolerance, or turns back there."""
    ux, uy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    vx, vy = points[c, 0] - points[b, 0], points[c, 1] - points[b, 1]
    if ux * vx + uy * vy <= 0.0:
        return True
    chord = (ux + vx) ** 2 + (uy + vy) ** 2
    return bool((ux * vy - uy * vx) ** 2 > tolerance * tolerance * chord)


@kernel
def break_points_of(points: FloatArray, closed: bool, tolerance: float) -> IntArray:
    """Return the indices of the break points; a closed curve has two at least, if it can."""
    count = len(points)
    if count == 0:
        return np.empty(0, np.int64)
    order = _distinct(points, closed)
    size = len(order)
    kept = np.empty(size + 2, np.int64)
    total = 0
    if not closed:
        kept[0], total = 0, 1
    for k in range(0 if closed else 1, size if closed else size - 1):
        a, c = order[k - 1 if k > 0 else size - 1], order[k + 1 if k + 1 < size else 0]
        if size > 1 and _bends(points, a, order[k], c, tolerance):
            kept[total] = order[k]
            total += 1
    if not closed and count > 1:
        kept[total] = count - 1
        total += 1
    if closed and total < 2:
        kept[0], kept[1] = farthest_pair_of(points)
        total = 1 if kept[0] == kept[1] else 2
    return kept[:total].copy()
