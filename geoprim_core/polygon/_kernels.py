"""Kernels of the polygon room: error bounds, farthest pair of points.

The bound rules are numbers here: 0 thesis, 1 exact, 2 released, 3 dss4, 4 dss8, 5 tan.
"""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.digital._kernels_bounds import exact_slope_bound_of


@kernel
def _series(size: float, scale: float) -> float:
    return 1.0 - size / scale + (size / scale) ** 2


@kernel
def _released(length: float) -> float:
    """Return the released bound: the largest s tan(dphi) over all slopes.

    With k = sqrt(2) / s and z the sine of the slope's angle from a diagonal, s dphi is
    sqrt(2 (1 - z^2)) (1 + k z + (k z)^2); Newton steps find the z where that is largest.
    """
    k = math.sqrt(2.0) / length
    if k >= 1.0:
        return -1.0
    if length < 2.0:  # no two pixels are that far apart; the formula has a pole here
        length, k = 2.0, 0.5 * math.sqrt(2.0)
    z = min(k, 0.5)
    for _ in range(8):
        value = k + z * (2.0 * k * k - 1.0 - z * k * (2.0 + 3.0 * k * z))
        slope = 2.0 * k * k - 1.0 - z * k * (4.0 + 9.0 * k * z)
        step = value / slope
        z -= step
        if abs(step) < 1e-9:
            break
    largest = math.sqrt(2.0 * (1.0 - z * z)) * (1.0 + k * z + (k * z) ** 2)
    return length * math.tan(largest / length)


@kernel
def deviation_bound_of(rule: int, dx: float, dy: float) -> float:
    """Return d_max in pixels of a segment (dx, dy)."""
    length = math.hypot(dx, dy)
    if length == 0.0:
        return 0.0
    if rule == 2:
        return _released(length)
    if rule == 3:
        return (abs(dx) + abs(dy)) / length
    if rule == 4:
        return max(abs(dx), abs(dy)) / length
    return length * slope_bound_of(rule, dx, dy)


@kernel
def slope_bound_of(rule: int, dx: float, dy: float) -> float:
    """Return dphi_max in radians of a segment (dx, dy)."""
    length = math.hypot(dx, dy)
    if length == 0.0:
        return 0.5 * math.pi
    if rule == 2:
        return math.atan(_released(length) / length)
    if rule == 3:
        return min((abs(dx) + abs(dy)) / length / length, 0.5 * math.pi)
    if rule == 4:
        return min(max(abs(dx), abs(dy)) / length / length, 0.5 * math.pi)
    if rule == 5:
        return math.asin(min(math.sqrt(2.0) / length, 1.0))
    total = (abs(dx) + abs(dy)) / length
    if rule == 0:
        return math.atan(total / length * _series(total, length))
    return exact_slope_bound_of(dx, dy)


@kernel
def _row_ends(points: FloatArray) -> IntArray:
    """Return the first and last pixel of every row, rows in order; empty if y is not whole.

    No other pixel is a corner of the convex hull. Of equal pixels the one of lowest index counts.
    """
    count = len(points)
    top, bottom = points[0, 1], points[0, 1]
    for i in range(count):
        y = points[i, 1]
        if y != math.floor(y):
            return np.empty(0, np.int64)
        top, bottom = min(top, y), max(bottom, y)
    if bottom - top > 4.0 * count + 64.0:
        return np.empty(0, np.int64)
    rows = int(bottom - top) + 1
    left, right = np.full(rows, -1), np.full(rows, -1)
    for i in range(count):
        row = int(points[i, 1] - top)
        if left[row] < 0 or points[i, 0] < points[left[row], 0]:
            left[row] = i
        if right[row] < 0 or points[i, 0] > points[right[row], 0]:
            right[row] = i
    order = np.empty(2 * rows, np.int64)
    size = 0
    for row in range(rows):
        if left[row] >= 0:
            order[size] = left[row]
            size += 1
            if right[row] != left[row]:
                order[size] = right[row]
                size += 1
    return order[:size].copy()


@kernel
def _hull(points: FloatArray) -> IntArray:
    """Return the indices of the convex hull's corners, counter-clockwise, first ones of ties.

    Points that are no pixels are sorted along a direction of irrational slope, where those of a
    regular grid never tie.
    """
    order = _row_ends(points)
    if len(order) == 0:
        along = points[:, 0] + 0.6180339887498949 * points[:, 1]
        order = np.argsort(along, kind="mergesort")
    count = len(order)
    hull = np.empty(2 * count + 1, np.int64)
    size = 0
    for half in range(2):
        base = size
        for step in range(count):
            i = order[step] if half == 0 else order[count - 1 - step]
            px, py = points[i, 0], points[i, 1]
            if size > base and px == points[hull[size - 1], 0] and py == points[hull[size - 1], 1]:
                hull[size - 1] = min(hull[size - 1], i)
                continue
            while size - base >= 2:
                p, q = hull[size - 2], hull[size - 1]
                ax, ay = points[q, 0] - points[p, 0], points[q, 1] - points[p, 1]
                if ax * (py - points[p, 1]) - ay * (px - points[p, 0]) > 0.0:
                    break
                size -= 1
            hull[size] = i
            size += 1
        size -= 1  # the last corner of one half is the first of the other
    return hull[: max(size, 1)].copy()


@kernel
def _better(points: FloatArray, i: int, j: int, pair: IntArray, best: float) -> float:
    """Take the pair (i, j) when it is farther apart, or as far and of lower indices."""
    low, high = min(i, j), max(i, j)
    far = (points[i, 0] - points[j, 0]) ** 2 + (points[i, 1] - points[j, 1]) ** 2
    earlier = low < pair[0] or (low == pair[0] and high < pair[1])
    if far > best or (far == best and earlier):
        pair[0], pair[1] = low, high
        return far
    return best


@kernel
def farthest_pair_of(points: FloatArray) -> tuple[int, int]:
    """Return the indices i <= j of the two points farthest apart, by rotating calipers."""
    hull = _hull(points)
    count = len(hull)
    pair = np.array([hull[0], hull[0]])
    best = 0.0
    if count <= 3:
        for i in range(count):
            for j in range(i + 1, count):
                best = _better(points, hull[i], hull[j], pair, best)
        return pair[0], pair[1]
    j = 1
    for i in range(count):
        a, b = hull[i], hull[(i + 1) % count]
        ex, ey = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
        for _ in range(count):
            p, q = hull[j], hull[(j + 1) % count]
            rise = ex * (points[q, 1] - points[p, 1]) - ey * (points[q, 0] - points[p, 0])
            if rise < 0.0:
                break
            if rise == 0.0:  # parallel sides: all four pairs are antipodal
                best = _better(points, a, q, pair, best)
                best = _better(points, b, q, pair, best)
                best = _better(points, a, p, pair, best)
                best = _better(points, b, p, pair, best)
                break
            j = (j + 1) % count
        best = _better(points, a, hull[j], pair, best)
        best = _better(points, b, hull[j], pair, best)
    return pair[0], pair[1]
