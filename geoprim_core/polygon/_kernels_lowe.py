"""Kernel of Lowe's method, thesis 2.6.3: splitting all the way, then the most significant."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.polygon._kernels import farthest_pair_of
from geoprim_core.polygon._kernels_reach import block_hulls, farthest_by_hulls, no_hulls

LONG = 1024  # points of a curve that is worth its hulls


@kernel
def _turned(points: FloatArray, closed: bool) -> tuple[FloatArray, FloatArray, int, int]:
    """Return x, y from a start on, the start, and the first vertex after it.

    A closed curve starts at one of its two mutually farthest points and comes back to it.
    """
    count = len(points)
    first, second = 0, count - 1
    if closed:
        first, second = farthest_pair_of(points)
    total = count + 1 if closed else count
    x, y = np.empty(total), np.empty(total)
    for i in range(total):
        source = first + i if first + i < count else first + i - count
        x[i], y[i] = points[source, 0], points[source, 1]
    return x, y, first, second - first


@kernel
def lowe_of(points: FloatArray, closed: bool, shortest: float, floor: float) -> IntArray:
    """Return the vertices that Lowe's significance chooses among all splits."""
    count = len(points)
    if count == 0:
        return np.empty(0, np.int64)
    x, y, first, middle = _turned(points, closed)
    last = len(x) - 1
    hulls = block_hulls(x, y, last + 1) if last > LONG else no_hulls()
    # Nodes of the binary tree; a child's number is above its parent's.
    low, high = np.empty(2 * last + 2, np.int64), np.empty(2 * last + 2, np.int64)
    child, value = np.full(2 * last + 2, -1), np.empty(2 * last + 2)
    low[0], high[0], size = 0, middle, 1
    if closed and middle > 0:
        low[1], high[1], size = middle, last, 2
    roots = size
    node = 0
    while node < size:
        a, b = low[node], high[node]
        length = math.hypot(x[b] - x[a], y[b] - y[a])
        deviation = 0.0
        place = a
        if b - a > 1:
            place, deviation = farthest_by_hulls(x, y, hulls, a, b)
        value[node] = length / max(deviation, floor)
        if deviation > 0.0 and (length >= shortest or deviation >= shortest):
            child[node] = size
            low[size], high[size] = a, place
            low[size + 1], high[size + 1] = place, b
            size += 2
        node += 1
    best = value.copy()
    for node in range(size - 1, -1, -1):
        if child[node] >= 0:
            below = max(best[child[node]], best[child[node] + 1])
            if below > value[node]:
                best[node] = below
            else:
                child[node] = -1
    kept = np.zeros(count, np.bool_)
    chosen = np.zeros(size, np.bool_)
    chosen[:roots] = True
    for node in range(size):
        if chosen[node] and child[node] >= 0:
            chosen[child[node]] = chosen[child[node] + 1] = True
        elif chosen[node]:
            kept[(first + low[node]) % count] = True
            kept[(first + high[node]) % count] = True
    return np.flatnonzero(kept)
