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
NOWHERE = 0  # a place that touches none: beside the ends of open chains
GLANCE = 8  # pixels


@inner_kernel
def touch(cell: Any, i: Any, j: Any) -> Any:
    """Return whether two pixels are neighbours or the same."""
    return (abs(cell[i, 0] - cell[j, 0]) <= 1) & (abs(cell[i, 1] - cell[j, 1]) <= 1)


@inner_kernel
def distance(offset: Any, k: Any) -> Any:
    """Return the squared distance of a pixel from the edge; it is exact."""
    return offset[k, 0] * offset[k, 0] + offset[k, 1] * offset[k, 1]


@inner_kernel
def is_darker(cell: Any, tilt: Any, k: Any, m: Any) -> Any:
    """Return whether pixel k lies on the darker side of m, or across the gradient before it."""
    here, there = np.float64(tilt[k]), np.float64(tilt[m])
    brighter = (cell[k, 0] - cell[m, 0]) * (math.cos(here) + math.cos(there))
    brighter += (cell[k, 1] - cell[m, 1]) * (math.sin(here) + math.sin(there))
    return brighter < 0.0 or (brighter == 0.0 and k < m)


@inner_kernel
def join_ends(order: Any, starts: Any, stops: Any, first: Any) -> None:
    """Put the last pixel of each ring before its first one and the first after the last."""
    for c in range(first, len(starts)):
        order[starts[c] - 1] = order[stops[c] - 1]
        order[stops[c]] = order[starts[c]]


@inner_kernel
def mark_corners(
    cell: Any, order: Any, starts: Any, stops: Any, rings: Any, state: Any, corners: Any
) -> Any:
    """Write the state of all pixels and the places of the corners; return how many they are.

    A corner is a pixel of which both neighbours touch. The places beside a chain have the state
    of the pixels that are there, in a ring its other end.
    """
    for j in range(1, len(order) - 1):
        state[j] = touch(cell, order[j - 1], order[j + 1])
    for c in range(len(starts)):
        state[starts[c] - 1] = LEAN
        state[stops[c]] = LEAN
    for c in range(rings, len(starts)):
        if stops[c] - starts[c] <= 2:
            state[starts[c]] = LEAN
            state[stops[c] - 1] = LEAN
    size = np.uint64(0)
    for j in range(1, len(order) - 1):
        corners[size] = j
        size += np.uint64(state[j])
    for c in range(rings, len(starts)):
        state[starts[c] - 1] = state[stops[c] - 1]
        state[stops[c]] = state[starts[c]]
    return np.int64(size)


@inner_kernel
def settle_corners(cell: Any, tilt: Any, offset: Any, order: Any, corners: Any, state: Any) -> None:
    """Set the state of the corners to `GOES` that go before those beside them do.

    Of two it is the one farther from the edge or, in a tie, the darker one.
    """
    for j in corners:
        k, m, n = order[j], order[j - np.uint32(1)], order[j + np.uint32(1)]
        alone_m = state[j - np.uint32(1)] == LEAN
        alone_n = state[j + np.uint32(1)] == LEAN
        far, far_m, far_n = distance(offset, k), distance(offset, m), distance(offset, n)
        wins_m, wins_n = alone_m | (far > far_m), alone_n | (far > far_n)
        if (far == far_m) & (not alone_m):
            wins_m = is_darker(cell, tilt, k, m)
        if (far == far_n) & (not alone_n):
            wins_n = is_darker(cell, tilt, k, n)
        state[j] = GOES if wins_m & wins_n else CORNER


@inner_kernel
def drop_corners(order: Any, state: Any, rank: Any, starts: Any, stops: Any) -> Any:
    """Take what goes out of the order, in place; return how many places are left."""
    kept = np.uint64(0)
    for j in range(len(order)):
        order[kept] = order[j]
        rank[j] = kept
        kept += np.uint64(state[j] != GOES)
    for c in range(len(starts)):
        starts[c] = rank[starts[c]]
        stops[c] = rank[stops[c]]
    return np.int64(kept)


@kernel
def straighten(
    cell: Any, tilt: Any, offset: Any, order: Any, starts: Any, stops: Any, rings: Any
) -> None:
    """Take the corner pixels out of the stairs of all chains, in place.

    Of corners in a row goes what goes before its neighbours do: neither the way that the contour
    runs nor the start of a ring matters. The order has a place beside each end of a chain. All
    chains are looked at at once: most are too short for loops of their own.
    """
    size = len(order)
    state = np.zeros(size, np.uint8)
    rank = np.empty(size, np.uint32)
    corners = np.empty(size, np.uint32)
    while True:
        join_ends(order, starts, stops, rings)
        found = mark_corners(cell, order[:size], starts, stops, rings, state, corners)
        if found == 0:
            break
        settle_corners(cell, tilt, offset, order[:size], corners[:found], state)
        for c in range(rings, len(starts)):
            state[starts[c] - 1] = LEAN
            state[stops[c]] = LEAN
        size = drop_corners(order[:size], state, rank, starts, stops)


@inner_kernel
def far_end(cell: Any, offset: Any, order: Any) -> Any:
    """Return the place of the point of a closed contour that is farthest from the mean of all."""
    count = len(order)
    first, last = order[0], order[count - 1]
    if (cell[first, 0] == cell[last, 0]) & (cell[first, 1] == cell[last, 1]):
        return 0  # ends that share a pixel stay ends
    x = y = 0.0
    for k in order:
        x += cell[k, 0] + offset[k, 0]
        y += cell[k, 1] + offset[k, 1]
    most = -1.0
    start = 0
    for j in range(count):  # all but the squares is exact: the positions are whole 256ths
        k = order[j]
        dx = count * (cell[k, 0] + offset[k, 0]) - x
        dy = count * (cell[k, 1] + offset[k, 1]) - y
        if dx * dx + dy * dy > most:
            most = dx * dx + dy * dy
            start = j
    return start


@inner_kernel
def leaps(xs: Any, ys: Any, k: Any, m: Any) -> Any:
    """Return whether a link leads to no neighbour."""
    other = m if m < APART else k
    return (abs(xs[other] - xs[k]) > 1) | (abs(ys[other] - ys[k]) > 1)


@inner_kernel
def put_between(xs: Any, ys: Any, table: Any, k: Any, m: Any, cell: Any, offset: Any) -> Any:
    """Write the pixel nearest to the middle of a leap and return its gradient angle.

    In a tie it is the pixel on the brighter side. The middle is rounded to an even number of
    steps: pixels are even numbers of them, so a shift or a mirror changes nothing.
    """
    for c in range(2):
        k_at = xs[k] if c == 0 else ys[k]
        m_at = xs[m] if c == 0 else ys[m]
        middle = 0.5 * (k_at + table[k, OX + c] + m_at + table[m, OX + c])
        fine = (middle * SUBPIXEL_STEPS + ROUNDING - ROUNDING) / SUBPIXEL_STEPS
        nearest = math.floor(fine + 0.5)
        if nearest - fine == 0.5 and table[k, NX + c] + table[m, NX + c] < 0.0:
            nearest -= 1.0
        low, high = max(k_at, m_at) - 1, min(k_at, m_at) + 1
        cell[c] = min(max(nearest, low), high)
        offset[c] = fine - cell[c]
    return direction(table[k, NX] + table[m, NX], table[k, NY] + table[m, NY])


@kernel
def long_chains(xs: Any, ys: Any, before: Any, after: Any, min_length: Any, seen: Any) -> Any:
    """Return the first pixels of the open chains that may have `min_length` pixels.

    Only a few pixels of each are looked at, and marked as seen, without branches: most chains in
    noise are short, and where they end is a coin toss.
    """
    count = len(after)
    heads = np.empty(count, np.uint32)
    size = np.uint64(0)
    for k in range(count):
        heads[size] = k
        size += np.uint64((before[k] >= APART) & (after[k] < APART))
    kept = np.uint64(0)
    for head in heads[:size]:
        k = head
        length = 0
        linked = True
        for _ in range(min(min_length, GLANCE)):
            seen[k] = True
            length += (2 if leaps(xs, ys, k, after[k]) else 1) if linked else 0
            linked &= after[k] < APART
            k = after[k] if linked else k
        heads[kept] = head
        kept += np.uint64(linked | (length >= min_length))
    return heads[:kept]


@kernel
def rings_left(before: Any, after: Any, seen: Any) -> Any:
    """Return the linked pixels that have not been seen and are no heads."""
    left = np.empty(len(after), np.uint32)
    size = np.uint64(0)
    for k in range(len(after)):
        left[size] = k
        size += np.uint64((before[k] < APART) & (after[k] < APART) & (not seen[k]))
    return left[:size]


@kernel
def write_contours(
    cell: Any, offset: Any, tilt: Any, order: Any, starts: Any, stops: Any, min_length: Any
) -> Any:
    """Return the chains that are long enough: pixels, sub-pixel points, angles, offsets, closed."""
    total = 0
    curves = 0
    for c in range(len(starts)):
        length = stops[c] - starts[c]
        starts[curves], stops[curves] = starts[c], stops[c]
        total += length if length >= min_length else 0
        curves += length >= min_length
    points = np.empty((total, 2), np.float64)
    places = np.empty((total, 2), np.float64)
    angles = np.empty(total, np.float64)
    offsets = np.zeros(curves + 1, np.int64)
    closed = np.empty(curves, np.bool_)
    size = 0
    for c in range(curves):
        first, last = starts[c], stops[c]
        closed[c] = touch(cell, order[last - 1], order[first])
        middle = first + (far_end(cell, offset, order[first:last]) if closed[c] else 0)
        for begin, end in ((middle, last), (first, middle)):
            for j in range(begin, end):
                k = order[np.uint64(j)]
                points[size, 0] = cell[k, 0]
                points[size, 1] = cell[k, 1]
                places[size, 0] = cell[k, 0] + offset[k, 0]
                places[size, 1] = cell[k, 1] + offset[k, 1]
                angles[size] = tilt[k]
                size += 1
        offsets[c + 1] = size
    return points, places, angles, offsets, closed


@kernel
def walk(xs: Any, ys: Any, table: Any, angle: Any, before: Any, after: Any, min_length: Any) -> Any:
    """Return the contours that the links make: pixels, sub-pixel points, angles, offsets, closed.

    Where a link leaps over a pixel, the pixel nearest to its middle is put in. A closed contour
    begins with its far end, not with the pixel that comes first in the image. `min_length` is at
    least 2.
    """
    count = len(xs)
    seen = np.zeros(count, np.bool_)
    # A pixel amidst each link, and a place beside each end: what is not written takes no memory.
    room = 3 * count + 1
    cell = np.empty((room, 2), np.int32)
    offset = np.empty((room, 2), np.float32)
    tilt = np.empty(room, np.float32)
    order = np.empty(room, np.uint32)
    starts = np.empty(count, np.int64)
    stops = np.empty(count, np.int64)
    cell[NOWHERE, 0] = cell[NOWHERE, 1] = -9
    offset[NOWHERE, 0] = offset[NOWHERE, 1] = 0.0
    size = curves = 0
    rings: Any = np.int64(0)  # a constant would make a second specialisation
    k: Any
    for ring in range(2):  # open chains from their heads, then what is left: the rings
        if ring:
            rings = curves
            heads = rings_left(before, after, seen)
        else:
            heads = long_chains(xs, ys, before, after, min_length, seen)
        for head in heads:
            if ring and seen[head]:
                continue
            order[size] = NOWHERE
            start = size + 1
            size = start
            k = head
            while True:
                seen[k] = True
                cell[size, 0] = xs[k]
                cell[size, 1] = ys[k]
                offset[size, 0] = table[k, OX]
                offset[size, 1] = table[k, OY]
                tilt[size] = angle[k]
                order[size] = size
                size += 1
                m = after[k]
                if leaps(xs, ys, k, m):
                    tilt[size] = put_between(xs, ys, table, k, m, cell[size], offset[size])
                    order[size] = size
                    size += 1
                k = m
                if k >= APART or k == head:
                    break
            if size - start < min_length:
                size = start - 1
                continue
            order[size] = NOWHERE
            starts[curves] = start
            stops[curves] = size
            curves += 1
            size += 1
    straighten(cell, tilt, offset, order[:size], starts[:curves], stops[:curves], rings)
    return write_contours(cell, offset, tilt, order, starts[:curves], stops[:curves], min_length)
