"""Kernels of the optimal polygon: table of segment errors, layers of the dynamic programme, traces.

Nodes are the pixels of the unrolled curve: node i of a closed curve of `count` pixels is pixel
i % count. Row r of the table holds the errors of the segments r -> r + 1, r + 2, ... up to the
last one that can be part of a polygon within the limit; segments beyond the limit inside a row
are infinite. The kinds of error are numbers: 0 ISE, 1 sum of distances, 2 largest distance, 3 ISE
of the segments whose largest distance is at most `reach`.
"""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel

TIE = 1e-9  # weight of (length of the curve - length of the polygon): the longest of equals wins


@kernel
def _least_residual(sxx: float, sxy: float, syy: float) -> float:
    """Return the least sum of squared distances to a line through the first pixel."""
    half = 0.5 * (sxx + syy)
    largest = half + math.sqrt((0.5 * (sxx - syy)) ** 2 + sxy * sxy)
    if largest <= 0.0:
        return 0.0
    return (sxx * syy - sxy * sxy) / largest - 1e-12 * half


@kernel
def _distance_sum(x: FloatArray, y: FloatArray, i: int, j: int, dx: float, dy: float) -> float:
    total = 0.0
    if dx == 0.0 and dy == 0.0:
        for k in range(i + 1, j):
            total += math.sqrt((x[k] - x[i]) ** 2 + (y[k] - y[i]) ** 2)
        return total
    for k in range(i + 1, j):
        total += abs(dx * (y[k] - y[i]) - dy * (x[k] - x[i]))
    return total / math.sqrt(dx * dx + dy * dy)


@kernel
def _distance_max(x: FloatArray, y: FloatArray, i: int, j: int, dx: float, dy: float) -> float:
    largest = 0.0
    if dx == 0.0 and dy == 0.0:
        for k in range(i + 1, j):
            largest = max(largest, (x[k] - x[i]) ** 2 + (y[k] - y[i]) ** 2)
        return math.sqrt(largest)
    for k in range(i + 1, j):
        largest = max(largest, abs(dx * (y[k] - y[i]) - dy * (x[k] - x[i])))
    return largest / math.sqrt(dx * dx + dy * dy)


@kernel
def segment_table(
    x: FloatArray, y: FloatArray, count: int, kind: int, limit: float, reach: float, most: int
) -> tuple[IntArray, FloatArray]:
    """Return row offsets (count + 1,) and the errors; no offsets when more than `most` are needed.

    `x`, `y` hold the nodes: `count` of them for an open curve, 2 count - 1 for a closed one. The
    scan of a row ends as soon as the best line through its first pixel leaves a residual that no
    longer segment can undercut: residuals only grow with the number of pixels.
    """
    nodes = len(x)
    step = 0.0
    for k in range(1, nodes):
        step = max(step, math.hypot(x[k] - x[k - 1], y[k] - y[k - 1]))
    ceiling, share = limit, np.inf
    if kind == 1:  # a largest distance m lies on flanks: m^2 / step <= sum of distances
        ceiling = limit * math.sqrt(step * limit)
    elif kind == 2:
        ceiling, share = np.inf, limit * limit
    elif kind == 3:
        share = reach * reach
    first = np.zeros(count + 1, np.int64)
    table = np.empty(16 * count + 16)
    size = 0
    for i in range(count):
        end = min(i + count, nodes)
        sxx = sxy = syy = length = 0.0
        used = size
        for j in range(i + 1, end):
            if size >= len(table):
                if size >= most:
                    return first[:0], table[:0]
                larger = np.empty(2 * len(table))
                larger[:size] = table[:size]
                table = larger
            dx, dy = x[j] - x[i], y[j] - y[i]
            length += math.sqrt((x[j] - x[j - 1]) ** 2 + (y[j] - y[j - 1]) ** 2)
            square = dx * dx + dy * dy
            if kind == 1:
                error = _distance_sum(x, y, i, j, dx, dy)
                kept = error <= limit
            elif kind == 2:
                error = _distance_max(x, y, i, j, dx, dy)
                kept = error <= limit
            else:
                error = sxx + syy
                if square > 0.0:
                    error = max((dx * dx * syy + dy * dy * sxx) - 2.0 * dx * dy * sxy, 0.0) / square
                kept = error <= limit
                if kept and kind == 3:
                    kept = _distance_max(x, y, i, j, dx, dy) <= reach
            if kind != 2:
                error += TIE * max(length - math.sqrt(square), 0.0)
            table[size] = error if kept else np.inf
            size += 1
            if kept:
                used = size
            sxx += dx * dx
            sxy += dx * dy
            syy += dy * dy
            residual = _least_residual(sxx, sxy, syy)
            if residual > ceiling or residual > share * (j - i):
                break
        size = used
        first[i + 1] = size
    return first, table[:size].copy()


@kernel
def links_back(first: IntArray, low: int, span: int, links: int, goal: int) -> IntArray:
    """Return for k = 0 .. links the lowest node from which k segments may reach `goal`."""
    count = len(first) - 1
    back = np.empty(links + 1, np.int64)
    back[0] = goal - low
    node = min(goal - low, span)
    farthest = np.empty(span + 1, np.int64)
    most = -1
    for i in range(span + 1):
        row = (low + i) % count
        most = max(most, i + first[row + 1] - first[row])
        farthest[i] = most  # of all nodes up to i
    for k in range(1, links + 1):
        target = back[k - 1]
        while node > 0 and farthest[node - 1] >= target:
            node -= 1
        back[k] = node
    return back


@kernel
def layers(
    first: IntArray,
    table: FloatArray,
    low: int,
    span: int,
    links: int,
    head: FloatArray,
    goal: int,
) -> FloatArray:
    """Return (links + 1, span + 1): least error of n segments from the first nodes to each node.

    Nodes low .. low + len(head) - 1 are the starts and cost `head`; nodes that cannot reach
    `goal` with the segments left are not expanded.
    """
    count = len(first) - 1
    back = links_back(first, low, span, links, goal)
    best = np.full((links + 1, span + 1), np.inf)
    best[0, : len(head)] = head
    lowest, highest = 0, len(head) - 1
    for n in range(links):
        now, after = best[n], best[n + 1]
        lowest = max(lowest, back[links - n])
        top = lowest
        for i in range(lowest, min(highest, span - 1) + 1):
            value = now[i]
            if value == np.inf:
                continue
            row = (low + i) % count
            begin = first[row]
            width = min(first[row + 1] - begin, span - i)
            for k in range(width):
                total = value + table[begin + k]
                if total < after[i + 1 + k]:
                    after[i + 1 + k] = total
            top = max(top, i + width)
        lowest, highest = lowest + 1, top
    return best


@kernel
def trace(
    first: IntArray,
    table: FloatArray,
    low: int,
    best: FloatArray,
    head: float,
    start: int,
    end: int,
    cap: float,
    child: IntArray,
) -> tuple[float, IntArray]:
    """Return the least error of a path start -> end of exactly len(best) - 1 segments, and it.

    `best` bounds from below what leads to a node, up to the constant `head`; only states that
    can stay within `cap` are visited, backwards from the end. Infinite: there is no such path.
    """
    count = len(first) - 1
    links = len(best) - 1
    span = best.shape[1] - 1
    widest = 0
    for row in range(count):
        widest = max(widest, first[row + 1] - first[row])
    now, before = np.full(span + 1, np.inf), np.full(span + 1, np.inf)
    now[end - low] = 0.0
    lowest, highest = end - low, end - low
    for n in range(links, 0, -1):
        before[:] = np.inf
        bottom, top = span, -1
        for j in range(highest, lowest - 1, -1):
            value = now[j]
            if value == np.inf:
                continue
            for i in range(j - 1, max(j - widest, start - low) - 1, -1):
                if value + best[n - 1, i] - head > cap:
                    continue
                row = (low + i) % count
                place = first[row] + j - i - 1
                if place >= first[row + 1]:
                    continue
                total = value + table[place]
                if total < before[i] and total + best[n - 1, i] - head <= cap:
                    before[i] = total
                    child[n - 1, i] = j
                    bottom, top = min(bottom, i), max(top, i)
        now, before = before, now
        lowest, highest = bottom, top
        if top < 0:
            break
    path = np.zeros(0, np.int64)
    total = now[start - low]
    if highest >= 0 and total < np.inf:
        path = np.empty(links + 1, np.int64)
        node = start - low
        for n in range(links + 1):
            path[n] = low + node
            if n < links:
                node = child[n, node]
        return total, path
    return np.inf, path


@kernel
def start_window(first: IntArray) -> tuple[int, int]:
    """Return (a, length): every closed polygon of the table has a vertex in a .. a + length."""
    count = len(first) - 1
    farthest = 0
    best, place = count - 1, 0
    for node in range(2 * count):
        if node >= count and farthest - node < best:
            best, place = max(farthest - node, 0), node - count
        row = node % count
        farthest = max(farthest, node + first[row + 1] - first[row])
    return place, best


@kernel
def fewest_links(
    first: IntArray, table: FloatArray, low: int, starts: int, closed: bool
) -> tuple[int, IntArray]:
    """Return the least number of segments round the curve (or along it) and such a path.

    Every start low .. low + starts is tried; any finite segment is allowed.
    """
    count = len(first) - 1
    span = count if closed else count - 1
    best = span + 1
    path = np.zeros(0, np.int64)
    hops, parent = np.empty(span + 1, np.int64), np.empty(span + 1, np.int64)
    for s in range(low, low + starts + 1):
        hops[:] = best
        hops[0] = 0
        for i in range(span):
            if hops[i] + 1 >= best:
                continue
            row = (s + i) % count
            for k in range(min(first[row + 1] - first[row], span - i)):
                if table[first[row] + k] < np.inf and hops[i] + 1 < hops[i + 1 + k]:
                    hops[i + 1 + k] = hops[i] + 1
                    parent[i + 1 + k] = i
        if hops[span] < best:
            best = hops[span]
            path = np.empty(best + 1, np.int64)
            node = span
            for n in range(best, -1, -1):
                path[n] = s + node
                if n > 0:
                    node = parent[node]
    return best, path


@kernel
def least_links(
    first: IntArray, table: FloatArray, low: int, starts: int, span: int, goal: int, cap: float
) -> int:
    """Return a number of segments below which no polygon's summed error is within `cap`.

    A path may end `starts` nodes off its own start, so that one pass serves all starts.
    """
    count = len(first) - 1
    now, after = np.full(span + 1, np.inf), np.full(span + 1, np.inf)
    now[: starts + 1] = 0.0
    for n in range(1, span + 1):
        after[:] = np.inf
        for i in range(span):
            value = now[i]
            if value > cap:
                continue
            row = (low + i) % count
            begin = first[row]
            for k in range(min(first[row + 1] - begin, span - i)):
                total = value + table[begin + k]
                if total < after[i + 1 + k]:
                    after[i + 1 + k] = total
        now, after = after, now
        for node in range(goal - low, span + 1):
            if now[node] <= cap:
                return n
    return span
