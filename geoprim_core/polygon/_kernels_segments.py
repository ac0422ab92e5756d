"""Kernels about one segment of a polygon: its squared error in O(1), its largest deviation."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel


@kernel
def running_moments(x: FloatArray, y: FloatArray, count: int) -> FloatArray:
    """Return the running sums of x, y, x x, x y, y y about the first point, (count + 1, 5)."""
    sums = np.zeros((count + 1, 5))
    for i in range(count):
        u, v = x[i] - x[0], y[i] - y[0]
        sums[i + 1, 0] = sums[i, 0] + u
        sums[i + 1, 1] = sums[i, 1] + v
        sums[i + 1, 2] = sums[i, 2] + u * u
        sums[i + 1, 3] = sums[i, 3] + u * v
        sums[i + 1, 4] = sums[i, 4] + v * v
    return sums


@kernel
def squared_error(x: FloatArray, y: FloatArray, sums: FloatArray, low: int, high: int) -> float:
    """Return the sum of the squared distances of the points low .. high from their segment.

    Distances are from the line through both ends, or from the end where they coincide.
    """
    count = high + 1 - low
    dx, dy = x[high] - x[low], y[high] - y[low]
    a, b = x[low] - x[0], y[low] - y[0]
    sx, sy = sums[high + 1, 0] - sums[low, 0], sums[high + 1, 1] - sums[low, 1]
    xx = sums[high + 1, 2] - sums[low, 2] - a * (2.0 * sx - count * a)
    xy = sums[high + 1, 3] - sums[low, 3] - a * sy - b * sx + count * a * b
    yy = sums[high + 1, 4] - sums[low, 4] - b * (2.0 * sy - count * b)
    length = dx * dx + dy * dy
    if length == 0.0:
        return float(max(xx + yy, 0.0))
    return float(max((dx * dx * yy + dy * dy * xx) - 2.0 * dx * dy * xy, 0.0) / length)


@kernel
def distance_from_chord(x: FloatArray, y: FloatArray, low: int, high: int, i: int) -> float:
    """Return the distance (2-18) of point i from the line low-high (or from low)."""
    dx, dy = x[high] - x[low], y[high] - y[low]
    if dx == 0.0 and dy == 0.0:
        return math.sqrt((x[i] - x[low]) ** 2 + (y[i] - y[low]) ** 2)
    cross = abs(dx * (y[i] - y[low]) - dy * (x[i] - x[low]))
    return float(cross / math.sqrt(dx * dx + dy * dy))
