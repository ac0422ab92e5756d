"""Kernels of the splitting methods: RDP, RDP-mod and PRO, thesis 2.3.1 and 2.5.1.

One loop serves all three; `test` says when a segment is good enough: a bound rule of
`_kernels` (0 to 5), TOLERANCE, or one of the two forms of PRO.
"""

from __future__ import annotations

import math
from typing import cast

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.polygon._kernels import deviation_bound_of, farthest_pair_of
from geoprim_core.polygon._kernels_reach import (
    Hulls,
    block_hulls,
    farthest_by_hulls,
    farthest_by_scan,
    no_hulls,
)
from geoprim_core.polygon._kernels_segments import running_moments, squared_error

TOLERANCE = -1  # largest deviation
PRO = -2  # precision and reliability, s_max between any two pixels
PRO_FIRST = -3  # s_max from the first pixel
# Points looked at, a point of the curve, before the hulls are worth their price.
# Typed: numba may compile a kernel anew for a literal number.
FIRST, ONE = cast(int, np.int64(0)), cast(int, np.int64(1))
PATIENCE = 48


@kernel
def _widest(x: FloatArray, y: FloatArray, low: int, high: int) -> float:
    """Return the largest distance from the first pixel."""
    best = 0.0
    for i in range(low + 1, high + 1):
        best = max(best, (x[i] - x[low]) ** 2 + (y[i] - y[low]) ** 2)
    return math.sqrt(best)


@kernel
def _diameter(x: FloatArray, y: FloatArray, low: int, high: int) -> float:
    """Return the largest distance between any two pixels."""
    piece = np.empty((high + 1 - low, 2))
    piece[:, 0], piece[:, 1] = x[low : high + 1], y[low : high + 1]
    i, j = farthest_pair_of(piece)
    return math.hypot(piece[i, 0] - piece[j, 0], piece[i, 1] - piece[j, 1])


@kernel
def _sums(x: FloatArray, y: FloatArray, low: int, high: int) -> tuple[float, float]:
    """Return the sums of the distances from the segment's line, and of their squares."""
    dx, dy = x[high] - x[low], y[high] - y[low]
    first, second = 0.0, 0.0
    if dx == 0.0 and dy == 0.0:
        for i in range(low + 1, high):
            square = (x[i] - x[low]) ** 2 + (y[i] - y[low]) ** 2
            first += math.sqrt(square)
            second += square
        return first, second
    for i in range(low + 1, high):
        value = dx * (y[i] - y[low]) - dy * (x[i] - x[low])
        first += abs(value)
        second += value * value
    return first / math.sqrt(dx * dx + dy * dy), second / (dx * dx + dy * dy)


@kernel
def _is_balanced(
    x: FloatArray, y: FloatArray, low: int, high: int, test: int, limit: float, sums: FloatArray
) -> bool:
    """Tell whether precision and reliability are within the limit, (2-21) and errata P1, P2.

    The diameter is only computed where cheaper bounds of it leave the answer open.
    """
    count = high + 1 - low
    if len(sums) > 0:  # clearly too much, by the moments: no need to look at every pixel
        if squared_error(x, y, sums, low, high) > (1.001 * limit * limit + 0.001) * count:
            return False
    first, second = _sums(x, y, low, high)
    if second > limit * limit * count:
        return False
    if first <= limit * math.hypot(x[high] - x[low], y[high] - y[low]):
        return True
    widest = _widest(x, y, low, high)
    if first <= limit * widest:
        return True
    if test == PRO_FIRST or first > limit * 2.0 * widest:
        return False
    return first <= limit * _diameter(x, y, low, high)


@kernel
def _is_good(
    x: FloatArray, y: FloatArray, low: int, high: int, test: int, limit: float,
    deviation: float, sums: FloatArray,
) -> bool:  # fmt: skip
    if test >= 0:
        return deviation <= deviation_bound_of(test, x[high] - x[low], y[high] - y[low])
    if test == TOLERANCE:
        return deviation <= limit
    if deviation * deviation > limit * limit * (high + 1 - low):
        return False  # one pixel alone is too much for the precision
    return _is_balanced(x, y, low, high, test, limit, sums)


@kernel
def _split_on(
    x: FloatArray, y: FloatArray, test: int, limit: float, kept: BoolArray, stack: IntArray,
    size: int, low: int, hulls: Hulls, sums: FloatArray, patience: int,
) -> tuple[int, int]:  # fmt: skip
    """Split from `low` on until the stack is empty or patience ends; return stack size and low."""
    while size > 0 and patience > 0:
        high = stack[size - 1]
        if high - low > 1:
            if len(hulls.lower) > 0:
                place, deviation = farthest_by_hulls(x, y, hulls, low, high)
            else:
                place, deviation = farthest_by_scan(x, y, low, high)
                patience -= high - low
            if not _is_good(x, y, low, high, test, limit, deviation, sums):
                kept[place] = True
                stack[size] = place
                size += 1
                continue
        low = high
        size -= 1
    return size, low


@kernel
def _split(
    x: FloatArray, y: FloatArray, test: int, limit: float,
    kept: BoolArray, stack: IntArray, size: int,
) -> None:  # fmt: skip
    """Mark the vertices between the stacked indices, the last of the curve lowest."""
    last = stack[0]
    patience = PATIENCE * (last + 64)
    none = np.zeros((0, 5))
    size, low = _split_on(x, y, test, limit, kept, stack, size, FIRST, no_hulls(), none, patience)
    if size > 0:
        hulls = block_hulls(x, y, last + 1)
        sums = running_moments(x, y, last + 1) if test < TOLERANCE else none
        _split_on(x, y, test, limit, kept, stack, size, low, hulls, sums, ONE)


@kernel
def split_curves(
    points: FloatArray, offsets: IntArray, closed: BoolArray, test: int, limit: float
) -> tuple[IntArray, IntArray]:
    """Return the vertex indices of all contours and their offsets."""
    counts = np.diff(offsets)
    longest = counts.max() + 1 if len(counts) else 1
    x, y = np.empty(longest), np.empty(longest)
    kept, stack = np.empty(longest, np.bool_), np.empty(longest + 1, np.int64)
    indices = np.empty(len(points), np.int64)
    polygon_offsets = np.zeros(len(offsets), np.int64)
    total = 0
    for k in range(len(counts)):
        count = counts[k]
        contour = points[offsets[k] : offsets[k + 1]]
        first = 0
        kept[: count + 1] = False
        if count > 0 and closed[k]:
            first, second = farthest_pair_of(contour)
            for i in range(count + 1):
                source = first + i if first + i < count else first + i - count
                x[i], y[i] = contour[source, 0], contour[source, 1]
            kept[0] = kept[second - first] = True
            stack[0], stack[1] = count, second - first
            _split(x, y, test, limit, kept, stack, 2 if second > first else 1)
        elif count > 0:
            x[:count], y[:count] = contour[:, 0], contour[:, 1]
            kept[0] = kept[count - 1] = True
            stack[0] = count - 1
            _split(x, y, test, limit, kept, stack, ONE)
        for i in range(count):
            if kept[i - first if i >= first else i - first + count]:
                indices[total] = i
                total += 1
        polygon_offsets[k + 1] = total
    return indices[:total].copy(), polygon_offsets
