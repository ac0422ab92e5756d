"""Kernels of the `refined` scheme: how the supported stretches of an outline end."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.ecc._kernels_refined_support import ACROSS, Int32Array, outline_of

RESUMED = 8  # points of a contour after which it has left the outline for good
GOES_ON = 6  # points of a contour beyond its last support that make it go on
CLOSING = 2.0  # pixels between the ends of a contour that meet
LEAST_CLOSED = 8  # points of a contour whose ends can meet
LEAST_GAP = 3  # steps of the outline
NEARBY = 3  # pixels around the end of a gap in which an edge may cross


@kernel
def neighbours_of(points: FloatArray, contour: IntArray) -> IntArray:
    """Return the points (N, 2) before and after each on its contour, -1 beyond its ends.

    Where both ends meet the contour goes on: its first point is anywhere.
    """
    total = len(points)
    links = np.empty((total, 2), np.int64)
    first = 0
    for k in range(total):
        links[k, 0], links[k, 1] = k - 1, k + 1
        if k == 0 or contour[k] != contour[k - 1]:
            first = k
            links[k, 0] = -1
        if k + 1 == total or contour[k] != contour[k + 1]:
            links[k, 1] = -1
            dx, dy = points[k, 0] - points[first, 0], points[k, 1] - points[first, 1]
            if k >= first + LEAST_CLOSED and dx * dx + dy * dy <= CLOSING * CLOSING:
                links[k, 1], links[first, 0] = first, k
    return links


@kernel
def continuing_share(
    links: IntArray, stamp: IntArray, mark: int, chosen: IntArray, count: int
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


@kernel
def is_supported(
    head: Int32Array, following: Int32Array, stamp: IntArray, mark: int, px: int, py: int
) -> bool:
    """Tell whether one of the nine pixels around a place holds a supporting point."""
    for y in range(py - 1, py + 2):
        for x in range(px - 1, px + 2):
            p = head[y, x]
            while p >= 0:
                if stamp[p] == mark:
                    return True
                p = following[p]
    return False


@kernel
def is_crossed(
    head: Int32Array,
    following: Int32Array,
    normals: FloatArray,
    px: int,
    py: int,
    nx: float,
    ny: float,
) -> bool:
    """Tell whether an edge runs across the normal (nx, ny) near a pixel."""
    height, width = head.shape
    for y in range(max(0, py - NEARBY), min(height, py + NEARBY + 1)):
        for x in range(max(0, px - NEARBY), min(width, px + NEARBY + 1)):
            p = head[y, x]
            while p >= 0:
                if abs(nx * normals[p, 0] + ny * normals[p, 1]) < ACROSS:
                    return True
                p = following[p]
    return False


@kernel
def unexplained_share(
    head: Int32Array,
    following: Int32Array,
    normals: FloatArray,
    ellipse: FloatArray,
    stamp: IntArray,
    mark: int,
) -> float:
    """Return the share of the ends of gaps at which no edge crosses the outline.

    Where something lies over an ellipse, the outline of that thing crosses it: a T-junction.
    """
    height, width = head.shape
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    a, b = ellipse[2], ellipse[3]
    walk = outline_of(a, b, 2.0)
    steps = len(walk)
    pixels = np.empty((steps, 2), np.int64)
    state = np.empty(steps, np.int64)  # in the gaps 0, supported 1, outside the image 2
    start = -1
    for k in range(steps):
        u, v = a * walk[k, 0], b * walk[k, 1]
        px = int(math.floor(ellipse[0] + u * cos - v * sin + 0.5))
        py = int(math.floor(ellipse[1] + u * sin + v * cos + 0.5))
        pixels[k, 0], pixels[k, 1] = px, py
        state[k] = 2
        if px >= 1 and py >= 1 and px <= width - 2 and py <= height - 2:
            state[k] = 1 if is_supported(head, following, stamp, mark, px, py) else 0
        if state[k] == 1:
            start = k
    gap = ends = unexplained = 0
    for m in range(1, steps + 1 if start >= 0 else 0):  # from a supported step around to it
        k = (start + m) % steps
        if state[k] == 0:
            gap += 1
            continue
        if gap >= LEAST_GAP:
            for back in (gap, 1):
                at = (k - back) % steps
                gu, gv = b * walk[at, 0], a * walk[at, 1]
                norm = math.sqrt(gu * gu + gv * gv)
                nx, ny = (gu * cos - gv * sin) / norm, (gu * sin + gv * cos) / norm
                x, y = pixels[at, 0], pixels[at, 1]
                ends += 1
                unexplained += 0 if is_crossed(head, following, normals, x, y, nx, ny) else 1
        gap = 0
    return unexplained / ends if ends > 0 else 0.0
