"""Kernels of similarity and saliency, thesis 5.5.1 and 5.5.2."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.fitting._kernels_distance import signed_distances
from geoprim_core.fitting._kernels_overlap import overlap_bound, overlap_of
from geoprim_core.fitting._kernels_shape import boxes_of

PARTS = 8  # pieces of an arc between which the swept angle is summed


@kernel
def swept_angle(
    points: FloatArray, start: int, stop: int, closed: bool, x: float, y: float
) -> float:
    """Return the angle in [0, 2 pi] that an arc subtends at a centre, along the arc."""
    total = 0.0
    dx, dy = points[start, 0] - x, points[start, 1] - y
    steps = PARTS + 1 if closed else PARTS
    for part in range(1, steps + 1):
        i = start if part > PARTS else start + part * (stop - 1 - start) // PARTS
        ex, ey = points[i, 0] - x, points[i, 1] - y
        total += math.atan2(dx * ey - dy * ex, dx * ex + dy * ey)
        dx, dy = ex, ey
    return min(abs(total), 2.0 * math.pi)


@kernel
def circumference_ratios(
    points: FloatArray,
    arc_offsets: IntArray,
    closed: BoolArray,
    ellipses: FloatArray,
    arc: IntArray,
    offsets: IntArray,
) -> FloatArray:
    """Return c (n,) of (5-10) for every hypothesis."""
    ratios = np.empty(len(ellipses))
    for n in range(len(ellipses)):
        total = 0.0
        for k in arc[offsets[n] : offsets[n + 1]]:
            total += swept_angle(
                points,
                arc_offsets[k],
                arc_offsets[k + 1],
                closed[k],
                ellipses[n, 0],
                ellipses[n, 1],
            )
        ratios[n] = min(1.0, total / (2.0 * math.pi))
    return ratios


@kernel
def cap_height(share: float) -> float:
    """Return the height, in radii, of the cap that holds a share of a disc's area."""
    low, high = 0.0, 2.0
    for _ in range(50):
        h = 0.5 * (low + high)
        area = math.acos(1.0 - h) - (1.0 - h) * math.sqrt(h * (2.0 - h))
        if area < share * math.pi:
            low = h
        else:
            high = h
    return high


@kernel
def far_boxes(a: FloatArray, b: FloatArray, height: float) -> bool:
    """Say whether one box cuts a cap of more than `height` half-widths off the other's ellipse."""
    for axis in range(2):
        half_a, half_b = 0.5 * (a[axis + 2] - a[axis]), 0.5 * (b[axis + 2] - b[axis])
        low, high = b[axis] - a[axis], a[axis + 2] - b[axis + 2]
        if max(low, high) > height * half_a or max(-low, -high) > height * half_b:
            return True
    return False


@kernel
def representatives(ellipses: FloatArray, order: IntArray, threshold: float) -> BoolArray:
    """Return the mask of the ellipses that no earlier one of `order` is similar to.

    Two cheap bounds come before the overlap itself: the ratio of areas, and the caps that the
    box of one ellipse cuts off the other.
    """
    boxes = boxes_of(ellipses)
    height = cap_height(1.0 - threshold)
    gone = np.zeros(len(ellipses), np.bool_)
    for i in range(len(order)):
        a = order[i]
        if gone[a]:
            continue
        for j in range(i + 1, len(order)):
            b = order[j]
            if gone[b] or far_boxes(boxes[a], boxes[b], height):
                continue
            if overlap_bound(ellipses[a], ellipses[b]) > threshold:
                gone[b] = overlap_of(ellipses[a], ellipses[b]) > threshold
    return ~gone


@kernel
def turn_between(
    points: FloatArray, arc_offsets: IntArray, ends: FloatArray, e1: int, e2: int
) -> float:
    """Return the turn in [0, pi] from one arc into the next, at their nearest end points."""
    best, turn = np.inf, 0.0
    for i in range(2):
        for j in range(2):
            p = points[arc_offsets[e1] if i == 0 else arc_offsets[e1 + 1] - 1]
            q = points[arc_offsets[e2] if j == 0 else arc_offsets[e2 + 1] - 1]
            distance = math.hypot(p[0] - q[0], p[1] - q[1])
            if distance < best:
                best = distance
                leaving = ends[e1, i] + (math.pi if i == 0 else 0.0)
                entering = ends[e2, j] + (math.pi if j == 1 else 0.0)
                turn = abs(math.atan2(math.sin(entering - leaving), math.cos(entering - leaving)))
    return turn


@kernel
def ring_order(
    points: FloatArray, arc_offsets: IntArray, group: IntArray, x: float, y: float
) -> IntArray:
    """Return the arcs of a group in their order around a centre, the widest gap left open."""
    at = np.empty(len(group))
    for i in range(len(group)):
        middle = points[(arc_offsets[group[i]] + arc_offsets[group[i] + 1]) // 2]
        at[i] = math.atan2(middle[1] - y, middle[0] - x)
    order = np.argsort(at, kind="mergesort")
    first, widest = 0, -1.0
    for i in range(len(group)):
        gap = at[order[i]] - at[order[i - 1]] + (2.0 * math.pi if i == 0 else 0.0)
        if gap > widest:
            first, widest = i, gap
    ring = np.empty(len(group), np.int64)
    for i in range(len(group)):
        ring[i] = group[order[(first + i) % len(group)]]
    return ring


@kernel
def continuity_ratios(
    points: FloatArray,
    arc_offsets: IntArray,
    ends: FloatArray,
    ellipses: FloatArray,
    arc: IntArray,
    offsets: IntArray,
) -> FloatArray:
    """Return phi (n,) of (5-13) for every hypothesis."""
    ratios = np.ones(len(ellipses))
    for n in range(len(ellipses)):
        group = arc[offsets[n] : offsets[n + 1]]
        if len(group) > 1:
            ring = ring_order(points, arc_offsets, group, ellipses[n, 0], ellipses[n, 1])
            total = 0.0
            for i in range(len(ring) - 1):
                turn = turn_between(points, arc_offsets, ends, ring[i], ring[i + 1])
                total += 1.0 - turn / math.pi
            ratios[n] = min(1.0, max(0.0, total / (len(ring) - 1)))
    return ratios


@kernel
def alignment_ratios(
    points: FloatArray,
    arc_offsets: IntArray,
    ellipses: FloatArray,
    arc: IntArray,
    offsets: IntArray,
    limit: float,
) -> FloatArray:
    """Return a (n,) of (5-12) for every hypothesis."""
    ratios = np.zeros(len(ellipses))
    for n in range(len(ellipses)):
        near, count = 0, 0
        for k in arc[offsets[n] : offsets[n + 1]]:
            pixels = points[arc_offsets[k] : arc_offsets[k + 1]]
            near += (np.abs(signed_distances(pixels, ellipses[n])) < limit).sum()
            count += len(pixels)
        ratios[n] = near / max(count, 1)
    return ratios
