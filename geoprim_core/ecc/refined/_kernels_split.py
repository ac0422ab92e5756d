"""Kernels of the `refined` scheme: contours split into smooth arcs that an ellipse may fit."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_fit import add_point, add_shifted, fit_moments, offset_of

SAMPLES = 24  # points that tell how well an ellipse fits an arc


@inner_kernel
def mark_vertices(
    points: FloatArray,
    first: int,
    last: int,
    end: int,
    tolerance: float,
    stack: IntArray,
    vertex: BoolArray,
) -> None:
    """Mark the vertices strictly between two points of an open curve (Ramer-Douglas-Peucker).

    The last point is that at `end`: in a ring it follows that at `last` - 1. Of points as far from
    the chord the one amidst is taken, whichever way the curve runs.
    """
    stack[0] = first
    stack[1] = last
    top = 2
    while top > 0:
        j = stack[top - 1]
        i = stack[top - 2]
        top -= 2
        stop = end if j == last else j
        dx = points[stop, 0] - points[i, 0]
        dy = points[stop, 1] - points[i, 1]
        length = math.sqrt(dx * dx + dy * dy)
        worst = tolerance
        aside = 0.0
        at = -1
        for k in range(i + 1, j):
            ux = points[k, 0] - points[i, 0]
            uy = points[k, 1] - points[i, 1]
            along = 0.0
            if length > 1e-9:
                along = (ux * dx + uy * dy) / length
                off = abs(ux * dy - uy * dx) / length
                beyond = max(-along, along - length)
                if beyond > 0.0:
                    off = math.hypot(off, beyond)
            else:
                off = math.hypot(ux, uy)
            if off >= worst and (off > worst or (at >= 0 and abs(along - 0.5 * length) < aside)):
                worst = off
                aside = abs(along - 0.5 * length)
                at = k
        if at >= 0:
            vertex[at] = True
            stack[top] = i
            stack[top + 1] = at
            stack[top + 2] = at
            stack[top + 3] = j
            top += 4


@kernel
def cut_flags(
    points: FloatArray,
    corners: IntArray,
    count: int,
    closed: bool,
    max_turn: float,
    cut: BoolArray,
) -> None:
    """Flag the corners at which a polygon stops to be smooth.

    Cut are sharp turns, and changes of the turning direction by the majority of the turns around
    a corner, weighted by their angles (errata C1).
    """
    turns = np.zeros(count)
    for k in range(count):
        cut[k] = False
        if not closed and (k == 0 or k == count - 1):
            continue
        p, q, r = corners[(k - 1) % count], corners[k], corners[(k + 1) % count]
        ax, ay = points[q, 0] - points[p, 0], points[q, 1] - points[p, 1]
        bx, by = points[r, 0] - points[q, 0], points[r, 1] - points[q, 1]
        turns[k] = math.atan2(ax * by - ay * bx, ax * bx + ay * by)
        cut[k] = abs(turns[k]) > max_turn
    sign = 0.0
    previous = -1
    # A ring ends with the corner that it begins with, so that its seam is a side like others.
    for step in range(0 if closed else 1, count + 1 if closed else count - 1):
        k = step % count
        around = 0.0
        for side in (-1, 1):
            other = k + side
            if closed or 0 < other < count - 1:
                around += turns[other % count]
        now = 1.0 if turns[k] + 0.5 * around > 0.0 else -1.0
        if sign != 0.0 and now != sign and previous >= 0:
            # the change of sign lies on the side between two corners: cut at its milder end
            difference = abs(turns[previous]) - abs(turns[k])
            cut[previous] |= difference <= 0.0
            cut[k] |= difference >= 0.0
        sign = now
        previous = k


@kernel
def split_contours(
    points: FloatArray,
    offsets: IntArray,
    closed: BoolArray,
    tolerance: float,
    max_turn: float,
    min_length: int,
) -> tuple[IntArray, IntArray, BoolArray]:
    """Return point indices of all smooth arcs, one after the other, their offsets, all vertices.

    Arcs that meet share a point; an arc all round a ring ends with the point it begins with.
    """
    total = len(points)
    order = np.empty(2 * total + 1, np.int64)
    ends = np.empty(total // max(1, min_length - 1) + len(offsets) + 1, np.int64)
    ends[0] = 0
    arcs = 0
    used = 0
    stack = np.empty(2 * total + 8, np.int64)
    vertex = np.zeros(total, np.bool_)
    corners = np.empty(total + 2, np.int64)
    cut = np.empty(total + 2, np.bool_)
    for c in range(len(offsets) - 1):
        low, high = offsets[c], offsets[c + 1]
        size = high - low
        if size < min_length:
            continue
        ring = closed[c]
        if ring:
            far, at = -1.0, low + size // 2
            for k in range(low, high):
                d = math.hypot(points[k, 0] - points[low, 0], points[k, 1] - points[low, 1])
                if d > far:
                    far, at = d, k
            vertex[at] = True
            mark_vertices(points, low, at, at, tolerance, stack, vertex)
            mark_vertices(points, at, high, low, tolerance, stack, vertex)
        else:
            mark_vertices(points, low, high - 1, high - 1, tolerance, stack, vertex)
            vertex[high - 1] = True
        vertex[low] = True
        count = 0
        for k in range(low, high):
            if vertex[k]:
                corners[count] = k
                count += 1
        cut_flags(points, corners, count, ring, max_turn, cut)
        start = 0
        if ring:
            while start < count and not cut[start]:
                start += 1
            if start == count:  # a smooth ring is one arc
                for k in range(size + 1):
                    order[used] = low + k % size
                    used += 1
                arcs += 1
                ends[arcs] = used
                continue
        begin = corners[start]
        for step in range(1, count + 1 if ring else count):
            k = (start + step) % count
            stop = corners[k]
            if not (cut[k] or (not ring and k == count - 1)):
                continue
            run = (stop - begin) % size + 1 if ring else stop - begin + 1
            if ring and run == 1:
                run = size + 1
            if run >= min_length:
                for s in range(run):
                    order[used] = low + (begin - low + s) % size
                    used += 1
                arcs += 1
                ends[arcs] = used
            begin = stop
    return order[:used].copy(), ends[: arcs + 1].copy(), vertex


@inner_kernel
def part_rms(
    points: FloatArray,
    order: IntArray,
    breaks: IntArray,
    sides: FloatArray,
    i: int,
    j: int,
    max_rms: float,
    work: FloatArray,
    ellipse: FloatArray,
) -> float:
    """Return the rms distance of an arc from its break i to its break j to its own ellipse.

    Infinite where that is over `max_rms`, or where there is no ellipse.
    """
    first = order[breaks[i]]
    x0, y0 = points[first, 0], points[first, 1]
    reach = 1.0
    for k in range(i, j + 1):
        p = order[breaks[k]]
        reach = max(reach, abs(points[p, 0] - x0), abs(points[p, 1] - y0))
    work[:] = 0.0
    for k in range(i, j):
        p = order[breaks[k]]
        add_shifted(work, sides[k], points[p, 0] - x0, points[p, 1] - y0, 1.0 / reach)
    p = order[breaks[j]]
    add_point(work, (points[p, 0] - x0) / reach, (points[p, 1] - y0) / reach)
    if not fit_moments(work, x0, y0, 1.0 / reach, ellipse):
        return math.inf
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    size = breaks[j] - breaks[i]
    count = min(SAMPLES, size + 1)
    total = 0.0
    for k in range(count):
        back = count - 1 - k
        at = (min(k, back) * size) // (count - 1)
        p = order[breaks[i] + (at if k <= back else size - at)]
        d, _, _ = offset_of(ellipse, cos, sin, points[p, 0], points[p, 1])
        total += d * d
    rms = math.sqrt(total / count)
    return rms if rms < max_rms else math.inf


@kernel
def split_misfits(
    points: FloatArray,
    order: IntArray,
    ends: IntArray,
    vertex: BoolArray,
    max_rms: float,
    min_length: int,
) -> tuple[IntArray, IntArray]:
    """Split the arcs that no ellipse fits: the longest part that one fits first, then the rest.

    Of parts with as many sides that with the most points goes first, whichever way the arc runs.
    Parts begin and end at polygon vertices. Returns indices and offsets as `split_contours`.
    """
    room = 2 * len(order) + 1
    result = np.empty(room, np.int64)
    bounds = np.empty(room // max(1, min_length - 1) + 2, np.int64)
    bounds[0] = 0
    arcs = used = 0
    work = np.empty(25)
    ellipse = np.empty(5)
    breaks = np.empty(len(order) + 1, np.int64)
    for arc in range(len(ends) - 1):
        low, high = ends[arc], ends[arc + 1]
        count = 0
        for k in range(low, high):
            if k == low or k == high - 1 or vertex[order[k]]:
                breaks[count] = k
                count += 1
        sides = np.zeros((count, 25))
        for i in range(count - 1):
            p = order[breaks[i]]
            for k in range(breaks[i], breaks[i + 1]):
                q = order[k]
                add_point(sides[i], points[q, 0] - points[p, 0], points[q, 1] - points[p, 1])
        stack = [(0, count - 1)]
        while len(stack) > 0:
            begin, end = stack.pop()
            i, j = begin, end
            span = end - begin
            least = math.inf
            longest = 0
            while least == math.inf and span > 2:
                for k in range(begin, end - span + 1):
                    rms = part_rms(
                        points, order, breaks, sides, k, k + span, max_rms, work, ellipse
                    )
                    length = breaks[k + span] - breaks[k]
                    if rms < math.inf and (length, -rms) > (longest, -least):
                        longest, least = length, rms
                        i, j = k, k + span
                if least == math.inf:
                    span = min(span - 1, (span * 7) // 8)
            if least == math.inf:
                # two sides at most: the longest neighbours
                most, farthest = -1, 0.0
                i, j = begin, end
                if span < end - begin:
                    for k in range(begin, end - span + 1):
                        p, q = order[breaks[k]], order[breaks[k + span]]
                        length = breaks[k + span] - breaks[k]
                        dx, dy = points[q, 0] - points[p, 0], points[q, 1] - points[p, 1]
                        if (length, dx * dx + dy * dy) > (most, farthest):
                            most, farthest = length, dx * dx + dy * dy
                            i, j = k, k + span
            if breaks[j] - breaks[i] + 1 >= min_length:
                for k in range(breaks[i], breaks[j] + 1):
                    result[used] = order[k]
                    used += 1
                arcs += 1
                bounds[arcs] = used
            if i > begin:
                stack.append((begin, i))
            if j < end:
                stack.append((j, end))
    return result[:used].copy(), bounds[: arcs + 1].copy()
