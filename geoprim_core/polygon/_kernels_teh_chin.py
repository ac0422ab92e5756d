"""Kernels of Teh and Chin's method: region of support, significance, suppression in passes."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel


@kernel
def _ends(i: int, k: int, count: int) -> tuple[int, int]:
    return (i - k) % count, (i + k) % count


@kernel
def _chord(points: FloatArray, i: int, k: int) -> tuple[float, float]:
    """Return l_ik and the signed distance d_ik of point i from the chord i-k .. i+k."""
    a, c = _ends(i, k, len(points))
    dx, dy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
    length = math.sqrt(dx * dx + dy * dy)
    if length == 0.0:
        return 0.0, 0.0
    side = dx * (points[i, 1] - points[a, 1]) - dy * (points[i, 0] - points[a, 0])
    return length, side / length


@kernel
def _support(points: FloatArray, i: int, limit: int) -> int:
    """Return k_i: the region grows until its chord, or the ratio d / l, does so no longer."""
    length, distance = _chord(points, i, 1)
    for k in range(1, limit):
        longer, farther = _chord(points, i, k + 1)
        if length >= longer:
            return k
        if distance > 0.0 and distance * longer >= farther * length:
            return k
        if distance < 0.0 and distance * longer <= farther * length:
            return k
        length, distance = longer, farther
    return limit


@kernel
def _significance(points: FloatArray, i: int, k: int) -> float:
    """Return 1 + cosine of the angle at point i between its k-th neighbours: 0 where straight."""
    a, c = _ends(i, k, len(points))
    ux, uy = points[a, 0] - points[i, 0], points[a, 1] - points[i, 1]
    vx, vy = points[c, 0] - points[i, 0], points[c, 1] - points[i, 1]
    product = math.sqrt((ux * ux + uy * uy) * (vx * vx + vy * vy))
    return 1.0 + (ux * vx + uy * vy) / product if product > 0.0 else 0.0


@kernel
def _is_straight(points: FloatArray, i: int) -> bool:
    """Tell whether the curve goes straight on at point i, or does not move there."""
    a, c = _ends(i, 1, len(points))
    ux, uy = points[i, 0] - points[a, 0], points[i, 1] - points[a, 1]
    vx, vy = points[c, 0] - points[i, 0], points[c, 1] - points[i, 1]
    return bool(ux * vy - uy * vx == 0.0 and ux * vx + uy * vy >= 0.0)


@kernel
def _drop_weaker(value: FloatArray, support: IntArray, alive: BoolArray, closed: bool) -> None:
    """First pass: drop a point if one within half its region of support is more significant."""
    count = len(value)
    for i in range(count):
        half = support[i] // 2
        for j in range(i - half, i + half + 1):
            if (closed or (j >= 0 and j < count)) and value[i] < value[j % count]:
                alive[i] = False
                break


@kernel
def _drop_narrow(value: FloatArray, support: IntArray, alive: BoolArray) -> None:
    """Third pass: of neighbours drop those of a region of one point that are not stronger."""
    count = len(value)
    before = alive.copy()
    for i in range(count):
        a, c = _ends(i, 1, count)
        if alive[i] and support[i] == 1 and (before[a] or before[c]):
            alive[i] = value[i] > value[a] and value[i] > value[c]


@kernel
def _thin_groups(value: FloatArray, support: IntArray, alive: BoolArray, first: int) -> None:
    """Fourth pass: of two neighbours the stronger stays, of a longer group its two ends."""
    count = len(value)
    at = 0
    while at < count:
        i = (first + at) % count
        size = 0
        while size < count - at and alive[(i + size) % count]:
            size += 1
        if size == 2:
            j = (i + 1) % count
            weaker = value[i] < value[j] or (value[i] == value[j] and support[i] < support[j])
            alive[i if weaker else j] = False
        for k in range(1, size - 1):
            alive[(i + k) % count] = False
        at += max(size, 1)


@kernel
def teh_chin_of(points: FloatArray, closed: bool, one_step: bool, limit: int) -> BoolArray:
    """Tell which points are dominant; those of an open curve's ends are left to the caller."""
    count = len(points)
    support, value = np.ones(count, np.int64), np.zeros(count)
    alive = np.ones(count, np.bool_)
    for i in range(count):
        room = (count - 1) // 2 if closed else min(i, count - 1 - i)
        if room >= 1:
            support[i] = _support(points, i, min(room, limit))
            value[i] = _significance(points, i, 1 if one_step else support[i])
    _drop_weaker(value, support, alive, closed)
    for i in range(count):
        alive[i] = alive[i] and not _is_straight(points, i)
    if not closed:
        alive[0] = alive[count - 1] = False
    _drop_narrow(value, support, alive)
    first = 0  # a point from which no group is cut in two
    for i in range(count):
        if not alive[i]:
            first = i
            break
    _thin_groups(value, support, alive, first)
    return alive
