"""Kernels of the split into smooth arcs, thesis 5.3.1 and 5.3.2."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel


@kernel
def turn_angles(vertices: FloatArray, closed: bool) -> FloatArray:
    """Return the signed turn at every vertex (m,); 0 at the two ends of an open polygon."""
    count = len(vertices)
    turns = np.zeros(count)
    first, last = (0, count) if closed else (1, count - 1)
    for i in range(first, last):
        before = vertices[i] - vertices[i - 1 if i > 0 else count - 1]
        after = vertices[i + 1 if i + 1 < count else 0] - vertices[i]
        cross = before[0] * after[1] - before[1] * after[0]
        turns[i] = math.atan2(cross, before[0] * after[0] + before[1] * after[1])
    return turns


@kernel
def table_splits(different: BoolArray, cyclic: bool) -> BoolArray:
    """Return the splits that Table 5.3-1 puts on a sequence b of differing turns.

    A run of one '1' is split there, a run of two at both, a longer one at its first. What lies
    beyond the end of an open sequence is not known: a run that reaches it counts as a long one.
    """
    count = len(different)
    splits = np.zeros(count, np.bool_)
    for i in range(count):
        before = different[i - 1] if i > 0 else cyclic and different[count - 1]
        if not different[i] or before:
            continue
        splits[i] = True
        if i + 2 < count or (cyclic and count > 3):
            second, third = (i + 1) % count, (i + 2) % count
            if different[second] and not different[third]:
                splits[second] = True
    return splits


@kernel
def majority_sign(turns: FloatArray, at: int, cyclic: bool, window: int, max_turn: float) -> float:
    """Return the sign of the summed turns around one vertex.

    The window is even on both sides; an end of the contour or a sharp turn bounds it.
    """
    count = len(turns)
    total = turns[at]
    for k in range(1, min(window, (count - 1) // 2) + 1):
        i, j = at - k, at + k
        if not cyclic and (i < 0 or j >= count):
            break
        before, after = turns[i % count], turns[j % count]
        if abs(before) >= max_turn or abs(after) >= max_turn:
            break
        total += before + after
    return float(np.sign(total))


@kernel
def inflexions_from_first(turns: FloatArray, cyclic: bool) -> BoolArray:
    """Return the splits where turns are compared with the first one, (5-1)."""
    first = 0.0
    for turn in turns:
        if turn != 0.0:
            first = turn
            break
    different = np.zeros(len(turns), np.bool_)
    for i in range(len(turns)):
        different[i] = abs(turns[i] + first) < abs(turns[i]) + abs(first)
    return table_splits(different, cyclic)


@kernel
def inflexions_from_majority(
    turns: FloatArray, cyclic: bool, window: int, max_turn: float
) -> BoolArray:
    """Return the splits where turns are compared with their local majority.

    Lone turns against it are the cases 1 and 2 of Table 5.3-1; where the majority itself changes
    its sign, case 3, the split is at the first vertex of the new sign.
    """
    count = len(turns)
    signs = np.zeros(count)
    different = np.zeros(count, np.bool_)
    for i in range(count):
        if abs(turns[i]) < max_turn:
            signs[i] = majority_sign(turns, i, cyclic, window, max_turn)
            different[i] = turns[i] * signs[i] < 0.0
    splits = table_splits(different, cyclic)
    previous = 0.0
    for i in range(-count if cyclic else 0, count):  # a first lap finds the sign before vertex 0
        k = i % count
        if abs(turns[k]) >= max_turn:
            previous = 0.0
        elif signs[k] != 0.0:
            if i >= 0 and previous * signs[k] < 0.0:
                splits[k] = True
            previous = signs[k]
    return splits


@kernel
def split_vertices(
    vertices: FloatArray,
    closed: bool,
    max_turn: float,
    majority: bool,
    window: int,
    tolerance: float,
) -> BoolArray:
    """Return the mask (m,) of the polygon's vertices where its contour is split."""
    turns = turn_angles(vertices, closed)
    signed = np.where(np.abs(turns) >= tolerance, turns, 0.0)
    inner = signed if closed else signed[1:-1]
    if majority:
        found = inflexions_from_majority(inner, closed, window, max_turn)
    else:
        found = inflexions_from_first(inner, closed)
    splits = np.abs(turns) >= max_turn
    if closed:
        return splits | found
    splits[1:-1] |= found
    splits[0] = False
    splits[-1] = False
    return splits


@kernel
def piece_bounds(starts: IntArray, length: int, closed: bool) -> IntArray:
    """Return the bounds (n + 1,) of the pieces of one contour between its split points."""
    count = len(starts)
    bounds = np.empty(count + 1 if closed and count > 0 else count + 2, np.int64)
    if closed and count > 0:
        bounds[:count] = starts
        bounds[count] = starts[0] + length
    else:
        bounds[0] = 0
        bounds[1 : count + 1] = starts
        bounds[count + 1] = length
    return bounds


@kernel
def split_contours(
    points: FloatArray,
    offsets: IntArray,
    indices: IntArray,
    polygon_offsets: IntArray,
    closed: BoolArray,
    max_turn: float,
    majority: bool,
    window: int,
    tolerance: float,
    shortest: int,
) -> IntArray:
    """Return the arcs as rows: contour, start within it, number of points, closed or not.

    An arc runs from its split point up to, not including, the next one; on a closed contour it
    may run across the seam.
    """
    rows = np.empty((len(indices) + len(offsets) - 1, 4), np.int64)
    count = 0
    for k in range(len(offsets) - 1):
        polygon = indices[polygon_offsets[k] : polygon_offsets[k + 1]]
        starts = polygon[:0]
        if len(polygon) > 2:
            vertices = points[offsets[k] + polygon]
            mask = split_vertices(vertices, closed[k], max_turn, majority, window, tolerance)
            starts = polygon[mask]
        bounds = piece_bounds(starts, offsets[k + 1] - offsets[k], closed[k])
        for piece in range(len(bounds) - 1):
            length = bounds[piece + 1] - bounds[piece]
            if length >= shortest:
                rows[count, 0] = k
                rows[count, 1] = bounds[piece]
                rows[count, 2] = length
                rows[count, 3] = closed[k] and len(starts) == 0
                count += 1
    return rows[:count].copy()


@kernel
def gather_rows(offsets: IntArray, rows: IntArray) -> IntArray:
    """Return for every point of every arc its row in the contours' flat arrays."""
    found = np.empty(rows[:, 2].sum(), np.int64)
    at = 0
    for contour, start, length, _ in rows:
        whole = offsets[contour + 1] - offsets[contour]
        for i in range(length):
            found[at] = offsets[contour] + (start + i) % whole
            at += 1
    return found
