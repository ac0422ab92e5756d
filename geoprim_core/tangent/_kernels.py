"""Kernels of the tangent room."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel


@kernel
def _neighbour(curve: FloatArray, start: int, step: int, closed: bool, radius: float) -> int:
    """Return the first pixel in one direction whose distance is the radius up to 1 / sqrt(2).

    The answer is -1 where an open curve ends, or a closed one is back at its start, before.
    """
    count = len(curve)
    low = max(0.0, radius - math.sqrt(0.5)) ** 2
    high = (radius + math.sqrt(0.5)) ** 2
    x, y = curve[start, 0], curve[start, 1]
    i = start
    for _ in range(count - 1):
        i += step
        if i < 0 or i >= count:
            if not closed:
                return -1
            i = count - 1 if i < 0 else 0
        far = (curve[i, 0] - x) ** 2 + (curve[i, 1] - y) ** 2
        if low <= far <= high:
            return i
    return -1


@kernel
def deb_of(points: FloatArray, offsets: IntArray, closed: BoolArray, radius: float) -> FloatArray:
    """Return the direction of travel at every pixel of all contours, NaN where undefined."""
    angle = np.full(len(points), np.nan)
    for k in range(len(offsets) - 1):
        curve = points[offsets[k] : offsets[k + 1]]
        for i in range(len(curve)):
            back = _neighbour(curve, i, -1, closed[k], radius)
            if back < 0:
                continue
            ahead = _neighbour(curve, i, 1, closed[k], radius)
            if ahead < 0:
                continue
            dx, dy = curve[ahead, 0] - curve[back, 0], curve[ahead, 1] - curve[back, 1]
            if dx != 0.0 or dy != 0.0:
                angle[offsets[k] + i] = math.atan2(dy, dx)
    return angle
