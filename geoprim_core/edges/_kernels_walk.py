"""Kernels that write the contours which the links of edge pixels make."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.edges._kernels_linking import APART
from geoprim_core.edges._kernels_pixels import (
    NX,
    NY,
    OX,
    OY,
    ROUNDING,
    SUBPIXEL_STEPS,
    direction,
)

LEAN, CORNER, GOES = range(3)  # states of a pixel in `straighten`


@inner_kernel
def touch(points: Any, i: Any, j: Any) -> Any:
    """Return whether two pixels are neighbours or the same."""
    return (abs(points[i, 0] - points[j, 0]) <= 1.0) & (abs(points[i, 1] - points[j, 1]) <= 1.0)


@inner_kernel
def goes_first(points: Any, fine: Any, angle: Any, k: Any, m: Any) -> Any:
    """Return whether of two corner pixels k goes: it is farther from the edge, or darker."""
    far_k = (fine[k, 0] - points[k, 0]) ** 2 + (fine[k, 1] - points[k, 1]) ** 2
    far_m = (fine[m, 0] - points[m, 0]) ** 2 + (fine[m, 1] - points[m, 1]) ** 2
    if far_k != far_m:
        return far_k > far_m
    brighter = (points[k, 0] - points[m, 0]) * (math.cos(angle[k]) + math.cos(angle[m]))
    brighter += (points[k, 1] - points[m, 1]) * (math.sin(angle[k]) + math.sin(angle[m]))
    return brighter < 0.0 or (brighter == 0.0 and k < m)


@inner_kernel
def mark_corners(points: Any, start: Any, size: Any, ring: Any, state: Any) -> Any:
    """Set the state of every pixel to `CORNER` where both neighbours touch, else `LEAN`.

    Return whether there is a corner.
    """
    corners = 0
    for k in range(start + 1, size - 1):
        corner = touch(points, np.uint64(k - 1), np.uint64(k + 1))
        state[np.uint64(k)] = corner
        corners += corner
    state[start] = ring and touch(points, size - 1, start + 1)
    state[size - 1] = ring and touch(points, size - 2, start)
    return corners + state[start] + state[size - 1] > 0


@inner_kernel
def settle_corners(points: Any, fine: Any, angle: Any, start: Any, size: Any, state: Any) -> Any:
    """Set the state of the corners to `GOES` that go before those beside them do.

    Return the first of them.
    """
    first = size
    for k in range(start, size):
        if state[k] == LEAN:
            continue
        m, n = k - 1 if k > start else size - 1, k + 1 if k + 1 < size else start
        waits = state[m] != LEAN and not goes_first(points, fine, angle, k, m)
        waits = waits or (state[n] != LEAN and not goes_first(points, fine, angle, k, n))
        state[k] = CORNER if waits else GOES
        first = first if waits else min(first, k)
    return first


@inner_kernel
def straighten(
    points: Any, fine: Any, angle: Any, start: Any, size: Any, ring: Any, state: Any
) -> Any:
    """Take the corner pixels out of the stairs from `start` on, in place; return the new `size`.

    A corner is a pixel of which both neighbours touch. Of corners in a row goes what goes before
    its neighbours do: neither the way that the contour runs nor the start of a ring matters.
    `state` is scratch.
    """
    while size > start + 2 and mark_corners(points, start, size, ring, state):
        kept = settle_corners(points, fine, angle, start, size, state)
        for k in range(kept + 1, size):
            if state[k] != GOES:
                for c in range(2):
                    points[kept, c] = points[k, c]
                    fine[kept, c] = fine[k, c]
                angle[kept] = angle[k]
                kept += 1
        size = kept
    return size


@kernel
def begin_at_the_far_end(points: Any, fine: Any, angle: Any) -> None:
    """Let a closed contour begin, in place, with the point farthest from the mean of all."""
    count = len(points)
    if (points[0] == points[count - 1]).all():
        return  # ends that share a pixel stay ends
    x = y = 0.0
    for k in range(count):
        x += fine[k, 0]
        y += fine[k, 1]
    most = -1.0
    start = 0
    for k in range(count):  # all but the squares is exact: the positions are whole 256ths
        dx, dy = count * fine[k, 0] - x, count * fine[k, 1] - y
        if dx * dx + dy * dy > most:
            most = dx * dx + dy * dy
            start = k
    for rows in (points, fine):
        rows[:] = np.concatenate((rows[start:], rows[:start]))
    angle[:] = np.concatenate((angle[start:], angle[:start]))


@inner_kernel
def leaps(xs: Any, ys: Any, k: Any, m: Any) -> Any:
    """Return whether a link leads to no neighbour."""
    other = m if m < APART else k
    return (abs(xs[other] - xs[k]) > 1) | (abs(ys[other] - ys[k]) > 1)


@inner_kernel
def put_between(xs: Any, ys: Any, table: Any, k: Any, m: Any, point: Any, fine: Any) -> Any:
    """Write the pixel nearest to the middle of a leap and return its gradient angle.

    In a tie it is the pixel on the brighter side. The middle is rounded to an even number of
    steps: pixels are even numbers of them, so a shift or a mirror changes nothing.
    """
    for c in range(2):
        k_at = xs[k] if c == 0 else ys[k]
        m_at = xs[m] if c == 0 else ys[m]
        middle = 0.5 * (k_at + table[k, OX + c] + m_at + table[m, OX + c])
        fine[c] = (middle * SUBPIXEL_STEPS + ROUNDING - ROUNDING) / SUBPIXEL_STEPS
        nearest = math.floor(fine[c] + 0.5)
        if nearest - fine[c] == 0.5 and table[k, NX + c] + table[m, NX + c] < 0.0:
            nearest -= 1.0
        low, high = max(k_at, m_at) - 1, min(k_at, m_at) + 1
        point[c] = min(max(nearest, low), high)
    return direction(table[k, NX] + table[m, NX], table[k, NY] + table[m, NY])


@kernel
def walk(xs: Any, ys: Any, table: Any, angle: Any, before: Any, after: Any, min_length: Any) -> Any:
    """Return the contours that the links make: pixels, sub-pixel points, angles, ends, closed.

    Where a link leaps over a pixel, the pixel nearest to its middle is put in. A closed contour
    begins with its far end, not with the pixel that comes first in the image. `min_length` is at
    least 2.
    """
    count = len(xs)
    seen = np.zeros(count, np.bool_)
    room = 0  # for a pixel amidst each link: what is not written takes no memory
    for j in range(count):
        room += (after[j] < APART) | (before[j] < APART)
        room += after[j] < APART
    points = np.empty((room, 2), np.float64)
    fine = np.empty((room, 2), np.float64)
    tilt = np.empty(room, np.float64)
    state = np.empty(room, np.uint8)
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
            size = straighten(points, fine, tilt, start, size, ring == 1, state)
            if size - start < min_length:
                size = start
                continue
            ends[curves] = size
            closed[curves] = touch(points, size - 1, start)
            if closed[curves]:
                begin_at_the_far_end(points[start:size], fine[start:size], tilt[start:size])
            curves += 1
    return points[:size], fine[:size], tilt[:size], ends[:curves], closed[:curves]
