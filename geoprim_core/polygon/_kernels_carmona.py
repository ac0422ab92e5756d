"""Kernels of Carmona-Poyato's method and of its non-parametric form, thesis 2.5.3."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.polygon._kernels import deviation_bound_of
from geoprim_core.polygon._kernels_reach import Hulls, block_hulls, farthest_by_hulls, no_hulls
from geoprim_core.polygon._kernels_segments import distance_from_chord

STEP = 0.5  # by which d_tol grows from sweep to sweep, in pixels
LONG = 1024  # points of a curve that is worth its hulls


@kernel
def _first_vertex(points: FloatArray, vertices: IntArray) -> int:
    """Return which vertex of a closed curve is farthest from its neighbours' line."""
    count = len(vertices)
    best, chosen = -1.0, 0
    x, y = points[:, 0].copy(), points[:, 1].copy()
    for k in range(count):
        before, after = vertices[k - 1 if k > 0 else count - 1], vertices[(k + 1) % count]
        value = distance_from_chord(x, y, before, after, vertices[k])
        if value > best:
            best, chosen = value, k
    return chosen


@kernel
def _saving(x: FloatArray, y: FloatArray, a: int, v: int, b: int) -> float:
    """Return l_n, (2-64): by how much the polygon gets shorter without v."""
    first = math.sqrt((x[v] - x[a]) ** 2 + (y[v] - y[a]) ** 2)
    second = math.sqrt((x[b] - x[v]) ** 2 + (y[b] - y[v]) ** 2)
    return first + second - math.sqrt((x[b] - x[a]) ** 2 + (y[b] - y[a]) ** 2)


@kernel
def _may_go(x: FloatArray, y: FloatArray, hulls: Hulls, low: int, high: int, rule: int) -> bool:
    """Tell whether a segment keeps its bound; two neighbouring pixels always do."""
    bound = deviation_bound_of(rule, x[high] - x[low], y[high] - y[low])
    return high - low < 2 or farthest_by_hulls(x, y, hulls, low, high)[1] <= bound


@kernel
def _sweep(
    x: FloatArray, y: FloatArray, hulls: Hulls, after: IntArray, before: IntArray,
    changed: BoolArray, refused: BoolArray, tolerance: float, rule: int, left: int,
) -> tuple[int, float, float]:  # fmt: skip
    """Delete vertices whose distance (2-63) is below the tolerance, from the first to the last.

    Returns how many are left, the largest saving of a deletion (-1: there was none) and the
    least distance that was not below the tolerance.
    """
    longest, least = -1.0, np.inf
    last = len(x) - 1
    v = after[0]
    while v != last:
        a, b = before[v], after[v]
        distance = distance_from_chord(x, y, a, b, v)
        if distance >= tolerance:
            least = min(least, distance)
        elif left > 1 and not refused[v]:
            if rule < 0 or _may_go(x, y, hulls, a, b, rule):
                longest = max(longest, _saving(x, y, a, v, b))
                after[a], before[b] = b, a
                changed[a], changed[v] = True, False
                refused[a], refused[b] = False, False
                left -= 1
            else:
                refused[v] = True
        v = b
    return left, longest, least


@kernel
def _largest_deviation(
    x: FloatArray, y: FloatArray, hulls: Hulls, after: IntArray, changed: BoolArray,
    deviation: FloatArray, rule: int,
) -> tuple[float, bool]:  # fmt: skip
    """Return max d_n, (2-59), and whether a segment exceeds its bound (2-66); only look anew."""
    largest, violates = 0.0, False
    v, last = 0, len(x) - 1
    while v != last:
        b = after[v]
        if changed[v]:
            changed[v] = False
            deviation[v] = farthest_by_hulls(x, y, hulls, v, b)[1] if b - v > 1 else 0.0
            if rule >= 0 and b - v > 1:
                bound = deviation_bound_of(rule, x[b] - x[v], y[b] - y[v])
                violates = violates or deviation[v] > bound
        largest = max(largest, deviation[v])
        v = b
    return largest, violates


@kernel
def carmona_of(
    points: FloatArray, closed: bool, vertices: IntArray, rule: int, ratio: float, above: bool,
    refuse: bool,
) -> IntArray:  # fmt: skip
    """Delete break points in sweeps of growing tolerance; rule -1: until r_i passes the ratio.

    With a rule the sweep in which a segment exceeds its bound is the last one; with `refuse` as
    well, such deletions are refused one by one and the sweeps end when no vertex can go.
    """
    count = len(points)
    size = len(vertices)
    if size <= 2:
        return vertices.copy()
    start = vertices[_first_vertex(points, vertices)] if closed else 0
    total = count + 1 if closed else count
    x, y = np.empty(total), np.empty(total)
    for i in range(total):
        x[i], y[i] = points[(start + i) % count, 0], points[(start + i) % count, 1]
    hulls = block_hulls(x, y, total) if total > LONG else no_hulls()
    after, before = np.zeros(total, np.int64), np.zeros(total, np.int64)
    place = np.sort((vertices - start) % count)
    for k in range(size):
        following = place[k + 1] if k + 1 < size else total - 1
        if following > place[k]:
            after[place[k]], before[following] = following, place[k]
    changed, refused = np.zeros(total, np.bool_), np.zeros(total, np.bool_)
    deviation = np.zeros(total)
    left = size - 1  # the first vertex stays, and one other, the last of an open curve
    tolerance = STEP
    while True:
        checked = rule if refuse else -1
        left, longest, least = _sweep(
            x, y, hulls, after, before, changed, refused, tolerance, checked, left
        )
        if not refuse:
            largest, violates = _largest_deviation(x, y, hulls, after, changed, deviation, rule)
            says_something = rule < 0 and longest >= 0.0 and largest > 0.0
            if violates or (says_something and (longest >= ratio * largest) == above):
                break
        if least == np.inf and (longest < 0.0 or not refuse):
            break
        tolerance += STEP
        if longest < 0.0 and least > tolerance:  # nothing happens before
            tolerance = (math.floor(least / STEP) + 1.0) * STEP
    kept = np.zeros(count, np.bool_)
    v = 0
    while v < count:
        kept[(start + v) % count] = True
        if v == total - 1:
            break
        v = after[v]
    return np.flatnonzero(kept)
