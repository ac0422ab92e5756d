"""Kernels of search region and associated convexity, thesis 5.4.1 and 5.4.2."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel


@kernel
def end_directions(angle: FloatArray, offsets: IntArray) -> FloatArray:
    """Return the first and the last defined direction (K, 2) of every arc."""
    ends = np.full((len(offsets) - 1, 2), np.nan)
    for k in range(len(offsets) - 1):
        for i in range(offsets[k], offsets[k + 1]):
            if not math.isnan(angle[i]):
                if math.isnan(ends[k, 0]):
                    ends[k, 0] = angle[i]
                ends[k, 1] = angle[i]
    return ends


@kernel
def region_of(
    first: FloatArray,
    middle: FloatArray,
    last: FloatArray,
    ends: FloatArray,
    half_planes: FloatArray,
) -> bool:
    """Write the three half-planes (nx, ny, c): n . p >= c of one search region, (5-2).

    The middle pixel is inside the first two and outside the third. A straight arc has none.
    """
    chord = math.hypot(last[0] - first[0], last[1] - first[1])
    if chord < 1e-9 or math.isnan(ends[0]):
        return False
    for side in range(3):
        at = last if side == 1 else first
        if side < 2:
            nx, ny = -math.sin(ends[side]), math.cos(ends[side])
        else:
            nx, ny = (first[1] - last[1]) / chord, (last[0] - first[0]) / chord
        height = nx * (middle[0] - at[0]) + ny * (middle[1] - at[1])
        if abs(height) < 1e-9:
            return False
        sign = 1.0 if (height > 0.0) == (side < 2) else -1.0
        half_planes[side, 0] = sign * nx
        half_planes[side, 1] = sign * ny
        half_planes[side, 2] = sign * (nx * at[0] + ny * at[1])
    return True


@kernel
def search_regions(
    points: FloatArray, offsets: IntArray, closed: BoolArray, ends: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Return the half-planes (K, 3, 3) of every arc and which arcs have a region."""
    count = len(offsets) - 1
    half_planes = np.zeros((count, 3, 3))
    defined = np.zeros(count, np.bool_)
    for k in range(count):
        start, stop = offsets[k], offsets[k + 1]
        if not closed[k]:
            middle = points[(start + stop) // 2]
            defined[k] = region_of(points[start], middle, points[stop - 1], ends[k], half_planes[k])
    return half_planes, defined


@kernel
def boxes_of(points: FloatArray, offsets: IntArray) -> FloatArray:
    """Return x_min, y_min, x_max, y_max (K, 4) of every arc."""
    boxes = np.empty((len(offsets) - 1, 4))
    for k in range(len(boxes)):
        boxes[k, :2] = np.inf
        boxes[k, 2:] = -np.inf
        for i in range(offsets[k], offsets[k + 1]):
            for j in range(2):
                boxes[k, j] = min(boxes[k, j], points[i, j])
                boxes[k, j + 2] = max(boxes[k, j + 2], points[i, j])
    return boxes


@kernel
def is_inside(
    half_planes: FloatArray,
    points: FloatArray,
    start: int,
    stop: int,
    box: FloatArray,
    slack: float,
) -> bool:
    """Say whether all points of one arc lie in one search region.

    The three points that fail most often are looked at first; a box that lies inside spares the
    look at every point.
    """
    for i in (start, stop - 1, (start + stop) // 2):
        for side in range(3):
            nx, ny, c = half_planes[side]
            if nx * points[i, 0] + ny * points[i, 1] < c - slack:
                return False
    for side in range(3):
        nx, ny, c = half_planes[side]
        lowest = nx * (box[0] if nx > 0.0 else box[2]) + ny * (box[1] if ny > 0.0 else box[3])
        if lowest >= c - slack:
            continue
        for i in range(start, stop):
            if nx * points[i, 0] + ny * points[i, 1] < c - slack:
                return False
    return True


@kernel
def arcs_inside(
    points: FloatArray,
    offsets: IntArray,
    half_planes: FloatArray,
    defined: BoolArray,
    candidates: BoolArray,
    slack: float,
) -> BoolArray:
    """Return (K, K): a candidate pair where arc j lies completely in the region of arc k."""
    count = len(offsets) - 1
    boxes = boxes_of(points, offsets)
    inside = np.zeros((count, count), np.bool_)
    for k in range(count):
        if not defined[k]:
            continue
        for j in range(count):
            if candidates[k, j] and j != k:
                inside[k, j] = is_inside(
                    half_planes[k], points, offsets[j], offsets[j + 1], boxes[j], slack
                )
    return inside


@kernel
def nearest_to_line(
    points: FloatArray, start: int, stop: int, origin: FloatArray, along: FloatArray
) -> int:
    """Return the index of the point nearest to the line through `origin` along `along`."""
    best, smallest = start, np.inf
    for i in range(start, stop):
        x, y = points[i, 0] - origin[0], points[i, 1] - origin[1]
        distance = abs(along[0] * y - along[1] * x)
        if distance < smallest:
            best, smallest = i, distance
    return best


@kernel
def convexity_gap(points: FloatArray, offsets: IntArray, e1: int, e2: int) -> float:
    """Return the right side of (5-3) minus its left side for two arcs, in pixels."""
    p1 = (points[offsets[e1]] + points[offsets[e1 + 1] - 1]) / 2
    p2 = (points[offsets[e2]] + points[offsets[e2 + 1] - 1]) / 2
    along = p2 - p1
    apart = math.hypot(along[0], along[1])
    q1 = points[nearest_to_line(points, offsets[e1], offsets[e1 + 1], p1, along)]
    q2 = points[nearest_to_line(points, offsets[e2], offsets[e2 + 1], p1, along)]
    outer = math.hypot(q2[0] - q1[0], q2[1] - q1[1])
    first = math.hypot(q1[0] - p1[0], q1[1] - p1[1])
    return first + apart + math.hypot(q2[0] - p2[0], q2[1] - p2[1]) - outer


@kernel
def associated_pairs(
    points: FloatArray, offsets: IntArray, candidates: BoolArray, tolerance: float
) -> BoolArray:
    """Return (K, K): the candidate pairs whose convexity is associated, (5-3)."""
    count = len(offsets) - 1
    associated = np.zeros((count, count), np.bool_)
    for k in range(count):
        for j in range(count):
            if candidates[k, j]:
                if candidates[j, k] and j < k:
                    associated[k, j] = associated[j, k]
                else:
                    associated[k, j] = convexity_gap(points, offsets, k, j) <= tolerance
    return associated
