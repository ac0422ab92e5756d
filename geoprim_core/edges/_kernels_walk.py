"""Kernels that write the contours which the links of edge pixels make."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from geoprim_core._jit import kernel
from geoprim_core.edges._kernels_linking import APART
from geoprim_core.edges._kernels_pixels import NX, NY, OX, OY, SUBPIXEL_STEPS, direction


@kernel
def straighten(points: Any, fine: Any, angle: Any) -> Any:
    """Take the corner pixels out of stairs, in place, and return how many pixels are left.

    A pixel goes where those before and after it touch each other; of two such pixels in a row
    the one farther from the edge goes.
    """
    count = len(points)
    kept = min(1, count)
    for k in range(1, count):
        drop = False
        if k + 1 < count:
            drop = (
                abs(points[k + 1, 0] - points[kept - 1, 0]) <= 1.0
                and abs(points[k + 1, 1] - points[kept - 1, 1]) <= 1.0
            )
        if drop and k + 2 < count:
            rival = (
                abs(points[k + 2, 0] - points[k, 0]) <= 1.0
                and abs(points[k + 2, 1] - points[k, 1]) <= 1.0
            )
            if rival:
                here = (fine[k, 0] - points[k, 0]) ** 2 + (fine[k, 1] - points[k, 1]) ** 2
                there = (fine[k + 1, 0] - points[k + 1, 0]) ** 2
                there += (fine[k + 1, 1] - points[k + 1, 1]) ** 2
                drop = here >= there
        if not drop:
            for c in range(2):
                points[kept, c] = points[k, c]
                fine[kept, c] = fine[k, c]
            angle[kept] = angle[k]
            kept += 1
    return kept


@kernel
def leaps(xs: Any, ys: Any, k: Any, m: Any) -> Any:
    """Return whether a link leads to no neighbour."""
    other = m if m < APART else k
    return (abs(xs[other] - xs[k]) > 1) | (abs(ys[other] - ys[k]) > 1)


@kernel
def put_between(xs: Any, ys: Any, table: Any, k: Any, m: Any, point: Any, fine: Any) -> Any:
    """Write the pixel nearest to the middle of a leap and return its gradient angle."""
    for c in range(2):
        k_at = xs[k] if c == 0 else ys[k]
        m_at = xs[m] if c == 0 else ys[m]
        middle = 0.5 * (k_at + table[k, OX + c] + m_at + table[m, OX + c])
        fine[c] = math.floor(middle * SUBPIXEL_STEPS) / SUBPIXEL_STEPS
        low, high = max(k_at, m_at) - 1, min(k_at, m_at) + 1
        point[c] = min(max(math.floor(fine[c] + 0.5), low), high)
    return direction(table[k, NX] + table[m, NX], table[k, NY] + table[m, NY])


@kernel
def walk(xs: Any, ys: Any, table: Any, angle: Any, before: Any, after: Any, min_length: Any) -> Any:
    """Return the contours that the links make: pixels, sub-pixel points, angles, ends, closed.

    Where a link leaps over a pixel, the pixel nearest to its middle is put in. `min_length` is at
    least 2.
    """
    count = len(xs)
    seen = np.zeros(count, np.bool_)
    room = 0
    for j in range(count):
        room += (after[j] < APART) | (before[j] < APART)
        room += leaps(xs, ys, np.uint32(j), after[j])
    points = np.empty((room, 2), np.float64)
    fine = np.empty((room, 2), np.float64)
    tilt = np.empty(room, np.float64)
    ends = np.empty(room // 2, np.int64)
    closed = np.empty(room // 2, np.bool_)
    size = 0
    curves = 0
    k: Any
    for ring in range(2):  # open chains from their heads, then what is left: the rings
        for head in range(count):
            linked = before[head] < APART
            if (after[head] >= APART) | (linked != (ring == 1)) | seen[head]:
                continue
            length = 0
            k = np.uint32(head)
            while k < APART and not seen[k]:
                seen[k] = True
                m = after[k]
                length += 2 if leaps(xs, ys, k, m) else 1
                k = m
            if length < min_length:  # most chains in noise: not worth writing
                continue
            start = size
            k = np.uint32(head)
            while True:
                points[size, 0] = xs[k]
                points[size, 1] = ys[k]
                fine[size, 0] = xs[k] + table[k, OX]
                fine[size, 1] = ys[k] + table[k, OY]
                tilt[size] = angle[k]
                size += 1
                m = after[k]
                if leaps(xs, ys, k, m):
                    middle = put_between(xs, ys, table, k, m, points[size], fine[size])
                    tilt[size] = np.float32(middle)
                    size += 1
                k = m
                if k >= APART or k == head:
                    break
            size = start + straighten(points[start:size], fine[start:size], tilt[start:size])
            if size - start < min_length:
                size = start
                continue
            near_x = abs(points[size - 1, 0] - points[start, 0]) <= 1.0
            near_y = abs(points[size - 1, 1] - points[start, 1]) <= 1.0
            ends[curves] = size
            closed[curves] = near_x and near_y
            curves += 1
    return points[:size], fine[:size], tilt[:size], ends[:curves], closed[:curves]
