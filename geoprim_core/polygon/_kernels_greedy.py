"""Kernels of the greedy polygon from which the optimal one starts: splits, then moves."""

from __future__ import annotations

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel


@kernel
def _sums(points: FloatArray) -> FloatArray:
    """Return the running sums of x, y, xx, xy, yy over three rounds of the curve."""
    count = len(points)
    sums = np.zeros((3 * count + 1, 5))
    for i in range(3 * count):
        x = points[i % count, 0] - points[0, 0]
        y = points[i % count, 1] - points[0, 1]
        sums[i + 1, 0] = sums[i, 0] + x
        sums[i + 1, 1] = sums[i, 1] + y
        sums[i + 1, 2] = sums[i, 2] + x * x
        sums[i + 1, 3] = sums[i, 3] + x * y
        sums[i + 1, 4] = sums[i, 4] + y * y
    return sums


@kernel
def _ise(points: FloatArray, sums: FloatArray, i: int, j: int) -> float:
    """Return the ISE of the segment from node i to node j (nodes -count .. 2 count - 1)."""
    count = len(points)
    px, py = points[i % count, 0] - points[0, 0], points[i % count, 1] - points[0, 1]
    dx = points[j % count, 0] - points[0, 0] - px
    dy = points[j % count, 1] - points[0, 1] - py
    a, b = i + 1 + count, j + count
    n = float(j - i - 1)
    sx, sy = sums[b, 0] - sums[a, 0], sums[b, 1] - sums[a, 1]
    sxx = sums[b, 2] - sums[a, 2] - 2.0 * px * sx + n * px * px
    sxy = sums[b, 3] - sums[a, 3] - px * sy - py * sx + n * px * py
    syy = sums[b, 4] - sums[a, 4] - 2.0 * py * sy + n * py * py
    square = dx * dx + dy * dy
    if square == 0.0:
        return float(max(sxx + syy, 0.0))
    return float(max((dx * dx * syy + dy * dy * sxx) - 2.0 * dx * dy * sxy, 0.0) / square)


@kernel
def _best_between(points: FloatArray, sums: FloatArray, i: int, j: int) -> tuple[int, float]:
    """Return the node strictly between i and j that splits them best, and the error left."""
    place, least = i + 1, np.inf
    for k in range(i + 1, j):
        error = _ise(points, sums, i, k) + _ise(points, sums, k, j)
        if error < least:
            place, least = k, error
    return place, least


@kernel
def _move(points: FloatArray, sums: FloatArray, nodes: IntArray, size: int, closed: bool) -> bool:
    """Move every vertex to its best place between its neighbours; say whether one moved."""
    count = len(points)
    moved = False
    for t in range(0 if closed else 1, size if closed else size - 1):
        left = nodes[t - 1] if t > 0 else nodes[size - 1] - count
        right = nodes[t + 1] if t < size - 1 else nodes[0] + count
        place, least = _best_between(points, sums, left, right)
        kept = _ise(points, sums, left, nodes[t]) + _ise(points, sums, nodes[t], right)
        if least < kept * (1.0 - 1e-12):
            nodes[t] = place
            moved = True
    if closed and (nodes[0] < 0 or nodes[0] >= count):  # stay within the three rounds
        nodes[:size] += count if nodes[0] < 0 else -count
    return moved


@kernel
def _split_best(points: FloatArray, sums: FloatArray, nodes: IntArray, ends: int) -> bool:
    """Insert the vertex that lowers the ISE most between the first `ends` nodes."""
    where, place, most = -1, 0, -np.inf
    for t in range(ends - 1):
        if nodes[t + 1] - nodes[t] > 1:
            node, left = _best_between(points, sums, nodes[t], nodes[t + 1])
            gain = _ise(points, sums, nodes[t], nodes[t + 1]) - left
            if gain > most:
                where, place, most = t, node, gain
    if where < 0:
        return False
    for t in range(ends, where + 1, -1):
        nodes[t] = nodes[t - 1]
    nodes[where + 1] = place
    return True


@kernel
def greedy_polygon(
    points: FloatArray, closed: bool, begin: IntArray, vertices: int, sweeps: int
) -> IntArray:
    """Return the nodes of a polygon of exactly that many vertices and a small ISE, in order.

    Segments of the polygon `begin` are split at their best pixel until there are enough; then
    vertices move to their best place between their neighbours.
    """
    count = len(points)
    sums = _sums(points)
    extra = 1 if closed else 0  # the first node comes again at the end of a closed polygon
    nodes = np.empty(vertices + 1 + extra, np.int64)
    ends = len(begin) + extra
    nodes[: len(begin)] = begin
    if closed:
        nodes[len(begin)] = begin[0] + count
    while ends - extra < vertices and _split_best(points, sums, nodes, ends):
        ends += 1
    for _ in range(sweeps):
        if not _move(points, sums, nodes, ends - extra, closed):
            break
    return nodes[: ends - extra].copy()
