"""Kernels that find the point of a stretch of a curve farthest from a line, also fast.

`farthest_by_scan` looks at every point. `farthest_by_hulls` needs the hulls of the curve's
blocks (`block_hulls`) and looks at O(log^2 n) corners only, whatever the curve's shape and even
where it crosses itself; both return the same point, the first of those that tie.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel

LEAF = 16  # points of the smallest block; each level doubles it
LOWEST = 3  # smaller blocks than those of this level are quicker looked through


class Hulls(NamedTuple):
    """Convex hulls of all aligned blocks of LEAF * 2^level points.

    The chains of a block stand at the block's own place in the row of its level, corners in
    order of (x, y); `lower` goes round below (small y), `upper` above.
    """

    lower: IntArray
    upper: IntArray
    lower_count: IntArray
    upper_count: IntArray


@kernel
def no_hulls() -> Hulls:
    """Return an empty table, of the type of a full one."""
    return Hulls(
        np.empty((0, 0), np.int64), np.empty((0, 0), np.int64),
        np.empty((0, 0), np.int64), np.empty((0, 0), np.int64),
    )  # fmt: skip


@kernel
def _bend(x: FloatArray, y: FloatArray, a: int, b: int, c: int) -> float:
    return float((x[b] - x[a]) * (y[c] - y[a]) - (y[b] - y[a]) * (x[c] - x[a]))


@kernel
def _append(
    x: FloatArray, y: FloatArray, chain: IntArray, start: int, size: int, i: int, side: float
) -> int:
    """Append a point to a chain that begins at start; return the chain's new size."""
    while size >= 2:
        if side * _bend(x, y, chain[start + size - 2], chain[start + size - 1], i) > 0.0:
            break
        size -= 1
    if size == 1 and x[chain[start]] == x[i] and y[chain[start]] == y[i]:
        size = 0  # of equal points one is enough
    chain[start + size] = i
    return size + 1


@kernel
def _before(x: FloatArray, y: FloatArray, a: int, b: int) -> bool:
    return bool(x[a] < x[b] or (x[a] == x[b] and y[a] < y[b]))


@kernel
def _merge(
    x: FloatArray, y: FloatArray, below: IntArray, counts: IntArray, above: IntArray,
    start: int, half: int, block: int, side: float,
) -> int:  # fmt: skip
    """Make the chain of a block from those of its halves; return its size."""
    i, j = start, start + half
    end_i, end_j = i + counts[2 * block], j + counts[2 * block + 1]
    size = 0
    while i < end_i or j < end_j:
        if j >= end_j or (i < end_i and _before(x, y, below[i], below[j])):
            size = _append(x, y, above, start, size, below[i], side)
            i += 1
        else:
            size = _append(x, y, above, start, size, below[j], side)
            j += 1
    return size


@kernel
def block_hulls(x: FloatArray, y: FloatArray, count: int) -> Hulls:
    """Return the hulls of all whole blocks of the first `count` points."""
    levels = 0
    while LEAF << levels <= count:
        levels += 1
    leaves = count // LEAF
    lower, upper = np.empty((levels, count), np.int64), np.empty((levels, count), np.int64)
    lower_count = np.zeros((levels, leaves), np.int64)
    upper_count = np.zeros((levels, leaves), np.int64)
    order = np.empty(LEAF, np.int64)
    for block in range(leaves):
        start = block * LEAF
        for k in range(LEAF):  # insertion: curves run mostly in order
            place = k
            while place > 0 and _before(x, y, start + k, order[place - 1]):
                order[place] = order[place - 1]
                place -= 1
            order[place] = start + k
        low, high = 0, 0
        for k in range(LEAF):
            low = _append(x, y, lower[0], start, low, order[k], 1.0)
            high = _append(x, y, upper[0], start, high, order[k], -1.0)
        lower_count[0, block], upper_count[0, block] = low, high
    for level in range(1, levels):
        half = LEAF << (level - 1)
        for block in range(leaves >> level):
            start = 2 * half * block
            lower_count[level, block] = _merge(
                x, y, lower[level - 1], lower_count[level - 1], lower[level], start, half, block,
                1.0,
            )  # fmt: skip
            upper_count[level, block] = _merge(
                x, y, upper[level - 1], upper_count[level - 1], upper[level], start, half, block,
                -1.0,
            )  # fmt: skip
    return Hulls(lower, upper, lower_count, upper_count)


@kernel
def _corner(
    x: FloatArray, y: FloatArray, chain: IntArray, start: int, size: int, side: float,
    dx: float, dy: float,
) -> int:  # fmt: skip
    """Return the corner of a chain where side (dx y - dy x) is least, by bisection (dx >= 0)."""
    low, high = 0, size - 1
    while low < high:
        middle = (low + high) // 2
        a, b = chain[start + middle], chain[start + middle + 1]
        if side * (dx * (y[b] - y[a]) - dy * (x[b] - x[a])) < 0.0:
            low = middle + 1
        else:
            high = middle
    return int(chain[start + low])


@kernel
def _reach(
    x: FloatArray, y: FloatArray, hulls: Hulls, level: int, block: int,
    i: int, dx: float, dy: float,
) -> float:  # fmt: skip
    """Return the largest distance of a block from the line through i along (dx, dy), times |d|."""
    start = block * (LEAF << level)
    if dx < 0.0:
        dx, dy = -dx, -dy
    low = _corner(x, y, hulls.lower[level], start, hulls.lower_count[level, block], 1.0, dx, dy)
    high = _corner(x, y, hulls.upper[level], start, hulls.upper_count[level, block], -1.0, dx, dy)
    return float(
        max(
            abs(dx * (y[low] - y[i]) - dy * (x[low] - x[i])),
            abs(dx * (y[high] - y[i]) - dy * (x[high] - x[i])),
        )
    )


@kernel
def _farthest_of_stretch(
    x: FloatArray, y: FloatArray, low: int, high: int, i: int, dx: float, dy: float
) -> tuple[int, float]:
    best, place = -1.0, low
    for k in range(low, high):
        value = abs(dx * (y[k] - y[i]) - dy * (x[k] - x[i]))
        if value > best:
            best, place = value, k
    return place, best


@kernel
def farthest_by_scan(x: FloatArray, y: FloatArray, low: int, high: int) -> tuple[int, float]:
    """Return index and distance of the point between low and high farthest from their line.

    Where the two coincide it is the distance from that point.
    """
    dx, dy = x[high] - x[low], y[high] - y[low]
    if dx == 0.0 and dy == 0.0:
        best, place = -1.0, low
        for k in range(low + 1, high):
            value = (x[k] - x[low]) ** 2 + (y[k] - y[low]) ** 2
            if value > best:
                best, place = value, k
        return place, math.sqrt(max(best, 0.0))
    place, best = _farthest_of_stretch(x, y, low + 1, high, low, dx, dy)
    return place, best / math.sqrt(dx * dx + dy * dy)


@kernel
def farthest_by_hulls(
    x: FloatArray, y: FloatArray, hulls: Hulls, low: int, high: int
) -> tuple[int, float]:
    """Return the same as `farthest_by_scan` with the help of the blocks' hulls."""
    dx, dy = x[high] - x[low], y[high] - y[low]
    if high - low <= 64 * LEAF or len(hulls.lower) == 0 or (dx == 0.0 and dy == 0.0):
        return farthest_by_scan(x, y, low, high)
    levels = len(hulls.lower)
    unit = LEAF << LOWEST
    begin = (low + unit) // unit * unit
    end = high // unit * unit
    place, best = _farthest_of_stretch(x, y, low + 1, begin, low, dx, dy)
    chosen, chosen_level = -1, 0
    at = begin
    while at < end:  # the largest aligned block that fits
        level = LOWEST
        while level + 1 < levels and at % (LEAF << (level + 1)) == 0:
            if at + (LEAF << (level + 1)) > end:
                break
            level += 1
        value = _reach(x, y, hulls, level, at // (LEAF << level), low, dx, dy)
        if value > best:
            best, chosen, chosen_level = value, at, level
        at += LEAF << level
    last, value = _farthest_of_stretch(x, y, end, high, low, dx, dy)
    if value > best:
        best, place, chosen = value, last, -1
    if chosen >= 0:  # down to the leaf that holds the first of the farthest points
        for level in range(chosen_level - 1, LOWEST - 1, -1):
            if _reach(x, y, hulls, level, chosen // (LEAF << level), low, dx, dy) < best:
                chosen += LEAF << level
        place, best = _farthest_of_stretch(x, y, chosen, chosen + unit, low, dx, dy)
    return place, best / math.sqrt(dx * dx + dy * dy)
