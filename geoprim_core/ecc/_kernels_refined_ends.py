"""Kernels of the `refined` scheme: how the supported stretches of an outline end."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.ecc._kernels_refined_support import ACROSS, Int32Array

RESUMED = 8  # points of a contour after which it has left the outline for good
GOES_ON = 6  # points of a contour beyond its last support that make it go on
LEAST_GAP = 3  # steps of the outline
NEARBY = 3  # pixels around the end of a gap in which an edge may cross


@kernel
def continuing_share(
    contour: IntArray, stamp: IntArray, mark: int, chosen: IntArray, count: int
) -> float:
    """Return the share of the ends of supporting runs at which the contour goes on elsewhere.

    A contour is the outline of one thing: where it supports an ellipse and then leaves it, that
    thing has another shape. Where an ellipse is occluded its contour ends.
    """
    total = len(contour)
    ends = leaving = 0
    for k in range(count):
        p = chosen[k]
        for side in (-1, 1):
            q = p + side
            if q < 0 or q >= total or contour[q] != contour[p]:
                ends += 1
                continue
            if stamp[q] == mark:
                continue
            beyond = 0
            resumed = False
            for _ in range(RESUMED):
                if q < 0 or q >= total or contour[q] != contour[p]:
                    break
                resumed = resumed or stamp[q] == mark
                beyond += 1
                q += side
            if not resumed:
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
    t = 0.0
    stop = 2.0 * math.pi
    started = False
    gap = ends = unexplained = 0
    places = np.empty((2, 2), np.int64)  # the first step of a gap and the latest
    across = np.empty((2, 2))
    while t < stop:
        ct, st = math.cos(t), math.sin(t)
        norm = math.sqrt(a * a * st * st + b * b * ct * ct)
        px = int(math.floor(ellipse[0] + a * ct * cos - b * st * sin + 0.5))
        py = int(math.floor(ellipse[1] + a * ct * sin + b * st * cos + 0.5))
        inside = px >= 1 and py >= 1 and px <= width - 2 and py <= height - 2
        hit = inside and is_supported(head, following, stamp, mark, px, py)
        if not started and hit:
            started = True
            stop = t + 2.0 * math.pi
        if started and inside and not hit:
            end = 0 if gap == 0 else 1
            places[end, 0], places[end, 1] = px, py
            across[end, 0] = (b * ct * cos - a * st * sin) / norm
            across[end, 1] = (b * ct * sin + a * st * cos) / norm
            gap += 1
        t += min(0.5, 2.0 / norm)
        if gap > 0 and (hit or not inside or t >= stop):
            if gap >= LEAST_GAP:
                for end in range(2):
                    x, y, nx, ny = places[end, 0], places[end, 1], across[end, 0], across[end, 1]
                    ends += 1
                    unexplained += 0 if is_crossed(head, following, normals, x, y, nx, ny) else 1
            gap = 0
    return unexplained / ends if ends > 0 else 0.0
