"""Kernels of the blurred segments: hull of a gliding window, maximal segments, vertices."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.polygon._kernels import deviation_bound_of


@kernel
def _cross(hull: FloatArray, i: int, j: int, x: float, y: float) -> float:
    ax, ay = hull[i, 0], hull[i, 1]
    side: float = (hull[j, 0] - ax) * (y - ay) - (hull[j, 1] - ay) * (x - ax)
    return side


@kernel
def _with_point(hull: FloatArray, size: int, x: float, y: float, after: FloatArray) -> int:
    """Write the convex hull of a hull and a point into `after`; return its number of corners.

    Corners turn one way round; of collinear points only the outer two are kept. -1: the point
    lies inside and nothing is written.
    """
    if size >= 3:
        begin = -1  # the first edge of the chain that the point sees
        for t in range(size):
            if (
                _cross(hull, t, (t + 1) % size, x, y) < 0.0
                and _cross(hull, (t + size - 1) % size, t, x, y) >= 0.0
            ):
                begin = t
        if begin < 0:
            return -1
        end = (begin + 1) % size
        while _cross(hull, end, (end + 1) % size, x, y) < 0.0:
            end = (end + 1) % size
        if _cross(hull, (begin + size - 1) % size, begin, x, y) == 0.0:
            begin = (begin + size - 1) % size
        if _cross(hull, end, (end + 1) % size, x, y) == 0.0:
            end = (end + 1) % size
        count, t = 0, end
        while True:
            after[count, 0], after[count, 1] = hull[t, 0], hull[t, 1]
            count += 1
            if t == begin:
                break
            t = (t + 1) % size
        after[count, 0], after[count, 1] = x, y
        return count + 1
    after[:size] = hull[:size]
    after[size, 0], after[size, 1] = x, y
    if size < 2:
        return -1 if size == 1 and x == hull[0, 0] and y == hull[0, 1] else size + 1
    side = _cross(hull, 0, 1, x, y)
    if side < 0.0:
        after[0], after[1] = hull[1], hull[0]
    if side != 0.0:
        return 3
    dx, dy = hull[1, 0] - hull[0, 0], hull[1, 1] - hull[0, 1]
    along = (x - hull[0, 0]) * dx + (y - hull[0, 1]) * dy
    if 0.0 <= along <= dx * dx + dy * dy:
        return -1
    after[0] = hull[1] if along < 0.0 else hull[0]
    after[1, 0], after[1, 1] = x, y
    return 2


@kernel
def _thickness(hull: FloatArray, size: int) -> float:
    """Return the least thickness of a hull along an axis, min over edges (rotating calipers)."""
    if size < 3:
        return 0.0
    least, far = np.inf, 1
    for t in range(size):
        u = (t + 1) % size
        while _cross(hull, t, u, hull[(far + 1) % size, 0], hull[(far + 1) % size, 1]) > _cross(
            hull, t, u, hull[far, 0], hull[far, 1]
        ):
            far = (far + 1) % size
        run = max(abs(hull[u, 0] - hull[t, 0]), abs(hull[u, 1] - hull[t, 1]))
        least = min(least, _cross(hull, t, u, hull[far, 0], hull[far, 1]) / run)
    return least


@kernel
def _fits(points: FloatArray, i: int, j: int, thickness: float, width: float, rule: int) -> bool:
    """Say whether a window from pixel i to pixel j may be so thick; rule -1: the fixed width."""
    if abs(j - i) <= 1:
        return True
    if rule < 0:
        return thickness <= width
    count = len(points)
    dx = points[j % count, 0] - points[i % count, 0]
    dy = points[j % count, 1] - points[i % count, 1]
    return thickness <= max(deviation_bound_of(rule, dx, dy), 1.0)


@kernel
def maximal_blurred_segments(
    points: FloatArray, closed: bool, width: float, rule: int
) -> tuple[IntArray, bool]:
    """Return first and last pixels (k, 2) of all maximal blurred segments, and if one is all.

    The window grows ahead while it fits. Then the next one is built backwards from the pixel
    that did not fit; its hull is the one to go on with.
    """
    count = len(points)
    found = np.empty((count + 1, 2), np.int64)
    hull, spare = np.empty((count + 2, 2)), np.empty((count + 2, 2))
    hull[0] = points[0]
    size, kept = 1, 0
    first = last = 0
    emitted = False
    end = 3 * count if closed else count
    while last + 1 < end:
        if closed and last - first + 1 >= count:
            return found[:0], True
        i = (last + 1) % count
        corners = _with_point(hull, size, points[i, 0], points[i, 1], spare)
        thickness = _thickness(hull, size) if corners < 0 else _thickness(spare, corners)
        if _fits(points, first, last + 1, thickness, width, rule):
            last += 1
            if corners >= 0:
                hull, spare, size = spare, hull, corners
            continue
        if closed and kept > 0 and first >= found[0, 0] + count:
            return found[:kept].copy(), False
        if emitted or not closed:
            found[kept, 0], found[kept, 1] = first, last
            kept += 1
        emitted = True
        last += 1
        hull[0] = points[i]
        size, start = 1, last
        while start - 1 > first:
            i = (start - 1) % count
            corners = _with_point(hull, size, points[i, 0], points[i, 1], spare)
            thickness = _thickness(hull, size) if corners < 0 else _thickness(spare, corners)
            if not _fits(points, start - 1, last, thickness, width, rule):
                break
            start -= 1
            if corners >= 0:
                hull, spare, size = spare, hull, corners
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
