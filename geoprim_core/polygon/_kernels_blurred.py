"""Kernels of the blurred segments: strip of a gliding window, maximal segments, vertices."""

from __future__ import annotations

import math
from typing import cast

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.polygon._kernels import deviation_bound_of

# The state of a window: the axis measured along (0: y, 1: x), the indices of its points that are
# farthest out on either side of the strip, and for each axis two pairs of points (see `_strip`).
AXIS, TOP, BOTTOM, PAIRS = 0, 1, 2, 3
UNKNOWN = -1
ZERO = cast(int, np.int64(0))  # typed: numba may compile a kernel anew for a literal number


@kernel
def _start_pairs(points: FloatArray, low: int, high: int, pairs: IntArray, axis: int) -> bool:
    """Take two points that differ along the strip; say whether there are any."""
    for k in range(high, low, -1):
        if points[axis, k] != points[axis, low]:
            pairs[0], pairs[1], pairs[2], pairs[3] = k, low, low, k
            if points[axis, k] < points[axis, low]:
                pairs[0], pairs[1], pairs[2], pairs[3] = low, k, k, low
            return True
    return False


@kernel
def _strip(
    points: FloatArray, low: int, high: int, limit: float, state: IntArray, slope: FloatArray
) -> bool:
    """Find a strip of at most `limit` along the state's axis that holds the points low .. high.

    The thickness of the strip of slope m through the outermost points is convex in m, and every
    pair of points (t, b) bounds it from below by the line v_t - v_b - m (u_t - u_b). The pairs of
    the state are one of falling and one of rising line. Where they cross is the next slope; either
    the strip is thin enough there, or its own pair is a better bound, or the bound is too thick.
    """
    axis = state[AXIS]
    pairs = state[PAIRS + 4 * axis : PAIRS + 4 * axis + 4]
    if pairs[0] == UNKNOWN and not _start_pairs(points, low, high, pairs, axis):
        return False
    bound = -np.inf
    while True:
        a1 = points[1 - axis, pairs[0]] - points[1 - axis, pairs[1]]
        b1 = points[axis, pairs[0]] - points[axis, pairs[1]]
        a2 = points[1 - axis, pairs[2]] - points[1 - axis, pairs[3]]
        b2 = points[axis, pairs[2]] - points[axis, pairs[3]]
        before, bound = bound, (a2 * b1 - a1 * b2) / (b1 - b2)
        if bound > limit or bound <= before:  # too thick, or the thinnest strip
            return bool(bound <= limit)
        m = (a1 - a2) / (b1 - b2)
        top, bottom, most, least = low, low, -np.inf, np.inf
        for k in range(low, high + 1):
            value = points[1 - axis, k] - m * points[axis, k]
            if value > most:
                most, top = value, k
            if value < least:
                least, bottom = value, k
        slope[0], state[TOP], state[BOTTOM] = m, top, bottom
        a = points[1 - axis, top] - points[1 - axis, bottom]
        b = points[axis, top] - points[axis, bottom]
        if most - least <= limit:
            return True
        if b == 0.0:  # the thinnest strip as well
            return bool(a <= limit)
        side = 0 if b > 0.0 else 2
        pairs[side], pairs[side + 1] = top, bottom


@kernel
def _joins(
    points: FloatArray, low: int, high: int, i: int, width: float, rule: int,
    state: IntArray, slope: FloatArray, trial: IntArray,
) -> bool:  # fmt: skip
    """Say whether the window low .. high, to which pixel i is new, fits; if so keep its state.

    Mostly the strip found last holds the new pixel as well. Rule -1 is the fixed width.
    """
    axis, m = state[AXIS], slope[0]
    value = points[1 - axis, i] - m * points[axis, i]
    most = points[1 - axis, state[TOP]] - m * points[axis, state[TOP]]
    least = points[1 - axis, state[BOTTOM]] - m * points[axis, state[BOTTOM]]
    thickness = max(value, most) - min(value, least)
    limit = width if rule < 0 else 1.0
    if rule >= 0 and thickness > limit:
        dx, dy = points[0, high] - points[0, low], points[1, high] - points[1, low]
        limit = max(deviation_bound_of(rule, dx, dy), 1.0)
    if thickness <= limit:
        if value > most:
            state[TOP] = i
        if value < least:
            state[BOTTOM] = i
        return True
    trial[:] = state
    for _ in range(2):
        if _strip(points, low, high, limit, trial, slope):
            state[:] = trial
            return True
        trial[AXIS] = 1 - trial[AXIS]
    slope[0] = m
    return False


@kernel
def _begin(state: IntArray, slope: FloatArray, i: int) -> None:
    """Make the window the pixel i alone."""
    state[:] = UNKNOWN
    state[AXIS], state[TOP], state[BOTTOM], slope[0] = 0, i, i, 0.0


@kernel
def maximal_blurred_segments(
    points: FloatArray, closed: bool, width: float, rule: int
) -> tuple[IntArray, bool]:
    """Return first and last pixels (k, 2) of all maximal blurred segments, and if one is all.

    The window grows ahead while it fits. Then the next one is built backwards from the pixel
    that did not fit; its strip is the one to go on with.
    """
    count = len(points)
    found = np.empty((count + 1, 2), np.int64)
    end = 3 * count if closed else count
    rounds = np.empty((2, end))  # one row x, one row y
    for i in range(end):
        rounds[0, i], rounds[1, i] = points[i % count, 0], points[i % count, 1]
    state, trial, slope = np.empty(PAIRS + 8, np.int64), np.empty(PAIRS + 8, np.int64), np.empty(1)
    _begin(state, slope, ZERO)
    first, last, kept, emitted = ZERO, ZERO, ZERO, False
    while last + 1 < end:
        if closed and last - first + 1 >= count:
            return found[:0], True
        last += 1
        if _joins(rounds, first, last, last, width, rule, state, slope, trial):
            continue
        if closed and kept > 0 and first >= found[0, 0] + count:
            return found[:kept].copy(), False
        if emitted or not closed:
            found[kept, 0], found[kept, 1] = first, last - 1
            kept += 1
        emitted = True
        _begin(state, slope, last)
        start = last
        while start - 1 > first:
            if not _joins(rounds, start - 1, last, start - 1, width, rule, state, slope, trial):
                break
            start -= 1
        first = start
    if not closed:
        found[kept, 0], found[kept, 1] = first, last
        kept += 1
    return found[:kept].copy(), False


@kernel
def _sharpest(points: FloatArray, left: int, low: int, high: int, right: int) -> tuple[int, float]:
    """Return the pixel low .. high from which left and right span the least angle; its cosine."""
    count = len(points)
    place, most = low, -2.0
    for i in range(low, high + 1):
        ax = points[left % count, 0] - points[i % count, 0]
        ay = points[left % count, 1] - points[i % count, 1]
        bx = points[right % count, 0] - points[i % count, 0]
        by = points[right % count, 1] - points[i % count, 1]
        size = math.sqrt((ax * ax + ay * ay) * (bx * bx + by * by))
        value = (ax * bx + ay * by) / size if size > 0.0 else -1.0
        if value > most:
            place, most = i, value
    return place, most


@kernel
def _reach(found: IntArray, count: int, q: int) -> int:
    """Return the last segment (numbered on over rounds) that shares a pixel with segment q."""
    size = len(found)
    p = q + 1
    while found[(p + 1) % size, 0] + count * ((p + 1) // size) <= found[q % size, 1] + count * (
        q // size
    ):
        p += 1
    return p


@kernel
def vertices_of(points: FloatArray, found: IntArray, closed: bool) -> IntArray:
    """Return one pixel of each zone that a segment and the last one it meets have in common.

    Two vertices in a row lie in one blurred segment. A closed curve starts at its sharpest zone.
    """
    count, size = len(points), len(found)
    nodes = np.empty(count + 2, np.int64)
    if not closed:
        nodes[0] = 0
        kept, q = 1, 0
        while q < size - 1:
            p = q + 1
            while p + 1 < size and found[p + 1, 0] <= found[q, 1]:
                p += 1
            nodes[kept], _ = _sharpest(points, found[q, 0], found[p, 0], found[q, 1], found[p, 1])
            kept += 1
            q = p
        nodes[kept] = count - 1
        return nodes[: kept + 1].copy()
    begin, sharp = 0, -2.0
    for q in range(size):
        p = _reach(found, count, q)
        low, right = found[p % size, 0] + count * (p // size), found[p % size, 1]
        _, value = _sharpest(points, found[q, 0], low, found[q, 1], right)
        if value > sharp:
            begin, sharp = q, value
    q, kept = begin, 0
    while kept < count:
        p = _reach(found, count, q)
        low, right = found[p % size, 0] + count * (p // size), found[p % size, 1]
        high = found[q % size, 1] + count * (q // size)
        nodes[kept], _ = _sharpest(points, found[q % size, 0], low, high, right)
        kept += 1
        if right + count * (p // size) >= nodes[0] + count:
            break
        q = p
    return nodes[:kept].copy()
