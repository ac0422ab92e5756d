"""Kernels of the `refined` scheme: how the supported stretches of an outline end."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, Int32Array, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_outline import ACROSS, COVERED_PLACE, GAP, STEPS, Walk
from geoprim_core.ecc.refined._kernels_places import pixel_at
from geoprim_core.ecc.refined._kernels_points import EdgeIndex

RESUMED = 8  # points of a contour after which it has left the outline for good
GOES_ON = 6  # points of a contour beyond its last support that make it go on
CLOSING = 2.0  # pixels between the ends of a contour that meet
LEAST_CLOSED = 8  # points of a contour whose ends can meet
LEAST_GAP = 3  # steps of the outline
NEARBY = 3  # pixels around the end of a gap in which an edge may cross


@kernel
def neighbours_of(points: FloatArray, offsets: IntArray) -> Int32Array:
    """Return the points (N, 2) before and after each on its contour, -1 beyond its ends.

    Where both ends meet the contour goes on: its first point is anywhere.
    """
    links = np.empty((len(points), 2), np.int32)
    for c in range(len(offsets) - 1):
        first, last = offsets[c], offsets[c + 1] - 1
        for k in range(first, last + 1):
            links[k, 0], links[k, 1] = k - 1, k + 1
        if first <= last:
            dx, dy = points[last, 0] - points[first, 0], points[last, 1] - points[first, 1]
            meet = last >= first + LEAST_CLOSED and dx * dx + dy * dy <= CLOSING * CLOSING
            links[last, 1], links[first, 0] = (first, last) if meet else (-1, -1)
    return links


@inner_kernel
def continuing_share(
    links: Int32Array, stamp: Int32Array, mark: int, chosen: IntArray, count: int
) -> float:
    """Return the share of the ends of supporting runs at which the contour goes on elsewhere.

    A contour is the outline of one thing: where it supports an ellipse and then leaves it, that
    thing has another shape. Where an ellipse is occluded its contour ends.
    """
    ends = leaving = 0
    for k in range(count):
        for side in range(2):
            q = links[chosen[k], side]
            if q < 0:
                ends += 1
                continue
            beyond = 0
            while q >= 0 and beyond < RESUMED and stamp[q] != mark:
                beyond += 1
                q = links[q, side]
            if q < 0 or beyond == RESUMED:
                ends += 1
                leaving += 1 if beyond >= GOES_ON else 0
    return leaving / ends if ends > 0 else 0.0


@inner_kernel
def is_crossed(
    edges: EdgeIndex,
    px: int,
    py: int,
    nx: float,
    ny: float,
) -> bool:
    """Tell whether an edge runs across the normal (nx, ny) near a pixel."""
    height, width = edges.head.shape
    for y in range(max(0, py - NEARBY), min(height, py + NEARBY + 1)):
        for x in range(max(0, px - NEARBY), min(width, px + NEARBY + 1)):
            p = edges.head[y, x]
            while p >= 0:
                if abs(nx * edges.normals[p, 0] + ny * edges.normals[p, 1]) < ACROSS:
                    return True
                p = edges.following[p]
    return False


@kernel
def place_on_outline(m: int, size: int) -> int:
    """Return where `Walk.state` holds place m of an outline of four times `size` places."""
    if m < size:  # comparisons: a division costs as much as all the rest
        return 4 * m
    if m < 2 * size:
        return 4 * (2 * size - 1 - m) + 1
    return 4 * (m - 2 * size) + 3 if m < 3 * size else 4 * (4 * size - 1 - m) + 2


@inner_kernel
def is_end_crossed(
    edges: EdgeIndex,
    ellipse: FloatArray,
    cos: float,
    sin: float,
    walk: Walk,
    place: int,
) -> bool:
    """Tell whether an edge runs across an outline near one of its places."""
    ct, st = walk.places[0, place // 4], walk.places[1, place // 4]
    ct = ct if place % 2 == 0 else -ct
    st = st if place % 4 < 2 else -st
    a, b = ellipse[2], ellipse[3]
    x, y = pixel_at(ellipse, cos, sin, ct, st)
    gu, gv = b * ct, a * st
    norm = math.sqrt(gu * gu + gv * gv)
    nx, ny = (gu * cos - gv * sin) / norm, (gu * sin + gv * cos) / norm
    return bool(is_crossed(edges, x, y, nx, ny))


@inner_kernel
def unexplained_share(
    edges: EdgeIndex,
    ellipse: FloatArray,
    walk: Walk,
) -> float:
    """Return the share of the ends of gaps at which no edge crosses the outline.

    Where something lies over an ellipse, the outline of that thing crosses it: a T-junction. The
    last walk along the whole outline tells the gaps.
    """
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    size = int(walk.sums[STEPS]) // 4  # places a quarter
    steps = 4 * size
    start = 0
    while start < steps and walk.state[place_on_outline(start, size)] != COVERED_PLACE:
        start += 1
    gap = ends = unexplained = 0
    for m in range(1, steps + 1 if start < steps else 0):  # from a supported step around to it
        k = start + m if start + m < steps else start + m - steps
        if walk.state[place_on_outline(k, size)] == GAP:
            gap += 1
            continue
        if gap >= LEAST_GAP:
            for back in (gap, 1):
                before = k - back if k >= back else k - back + steps
                place = place_on_outline(before, size)
                ends += 1
                if not is_end_crossed(edges, ellipse, cos, sin, walk, place):
                    unexplained += 1
        gap = 0
    return unexplained / ends if ends > 0 else 0.0
