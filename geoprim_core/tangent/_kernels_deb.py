"""Kernels of DEB."""

from __future__ import annotations

import math
from typing import cast

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel

# Typed, as numba may compile a kernel anew for each literal number.
BACK, AHEAD = cast(int, np.int64(-1)), cast(int, np.int64(1))


@kernel
def _longest_step(curve: FloatArray, closed: bool) -> float:
    longest = 0.0
    for i in range(0 if closed else 1, len(curve)):
        j = i - 1 if i > 0 else len(curve) - 1
        dx, dy = curve[i, 0] - curve[j, 0], curve[i, 1] - curve[j, 1]
        longest = max(longest, dx * dx + dy * dy)
    return math.sqrt(longest)


@kernel
def _skipped(radius: float, longest: float) -> int:
    """Return how many steps cannot lead to the circle, each being the longest of the curve."""
    near = radius - math.sqrt(0.5)
    return max(0, math.ceil(min(near / longest * (1.0 - 1e-12), 1e9)) - 1)


@kernel
def _neighbour(
    curve: FloatArray, start: int, step: int, closed: bool, radius: float, skipped: int
) -> int:
    """Return the first pixel in one direction whose distance is the radius up to 1 / sqrt(2).

    The answer is -1 where an open curve ends, or a closed one is back at its start, before.
    """
    count = len(curve)
    if skipped >= count:
        return -1
    low = max(0.0, radius - math.sqrt(0.5)) ** 2
    high = (radius + math.sqrt(0.5)) ** 2
    x, y = curve[start, 0], curve[start, 1]
    i = start + step * skipped
    if closed:
        i += count if i < 0 else (-count if i >= count else 0)
    for _ in range(count - 1 - skipped):
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
def deb_chords(
    points: FloatArray, offsets: IntArray, closed: BoolArray, radii: FloatArray
) -> FloatArray:
    """Return the chords (N, 2) from P1 to P2 at every pixel of all contours, NaN where undefined.

    There is one radius for every pixel, or one for all.
    """
    chords = np.full((len(points), 2), np.nan)
    alike = len(radii) == 1
    for k in range(len(offsets) - 1):
        curve = points[offsets[k] : offsets[k + 1]]
        longest = _longest_step(curve, closed[k])
        if longest == 0.0:
            continue
        radius, skipped = 0.0, 0
        for i in range(len(curve)):
            if not alike or i == 0:
                radius = radii[0] if alike else radii[offsets[k] + i]
                skipped = _skipped(radius, longest)
            back = _neighbour(curve, i, BACK, closed[k], radius, skipped)
            if back < 0:
                continue
            ahead = _neighbour(curve, i, AHEAD, closed[k], radius, skipped)
            if ahead < 0:
                continue
            dx, dy = curve[ahead, 0] - curve[back, 0], curve[ahead, 1] - curve[back, 1]
            if dx != 0.0 or dy != 0.0:
                chords[offsets[k] + i, 0], chords[offsets[k] + i, 1] = dx, dy
    return chords


@kernel
def deb_curvature(curve: FloatArray, closed: bool, radii: FloatArray) -> FloatArray:
    """Return the curvature of the circle through P1, the pixel and P2, NaN where undefined."""
    curvature = np.full(len(curve), np.nan)
    longest = _longest_step(curve, closed)
    if longest == 0.0:
        return curvature
    for i in range(len(curve)):
        radius = radii[0] if len(radii) == 1 else radii[i]
        skipped = _skipped(radius, longest)
        back = _neighbour(curve, i, BACK, closed, radius, skipped)
        ahead = _neighbour(curve, i, AHEAD, closed, radius, skipped)
        if back < 0 or ahead < 0:
            continue
        ax, ay = curve[i, 0] - curve[back, 0], curve[i, 1] - curve[back, 1]
        bx, by = curve[ahead, 0] - curve[i, 0], curve[ahead, 1] - curve[i, 1]
        sides = math.hypot(ax, ay) * math.hypot(bx, by) * math.hypot(ax + bx, ay + by)
        if sides > 0.0:
            curvature[i] = 2.0 * (ax * by - ay * bx) / sides
    return curvature
