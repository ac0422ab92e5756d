"""Kernels of the `refined` scheme: edges that cross an outline, and whose they are."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.ecc._kernels_refined_fit import offset_of
from geoprim_core.ecc._kernels_refined_outline import ACROSS, Int32Array
from geoprim_core.ecc._kernels_refined_places import outline_of
from geoprim_core.ecc._kernels_refined_support import doubt_of_clutter

UNEXPLAINED = 60.0  # evidence lost for one unexplained crossing point a supporting one


@kernel
def count_crossings(
    head: Int32Array,
    following: Int32Array,
    points: FloatArray,
    normals: FloatArray,
    ellipse: FloatArray,
    claimed: BoolArray,
    stamp: IntArray,
    mark: int,
    heights: FloatArray,
    full: float,
) -> float:
    """Count the edge points along an outline that run across it and that nothing has claimed.

    Those whose height is below `full` count for less, in proportion.
    """
    height, width = head.shape
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    a, b = ellipse[2], ellipse[3]
    count = 0.0
    places = outline_of(a, b, 2.0)
    for k in range(len(places)):
        u, v = a * places[k, 0], b * places[k, 1]
        px = int(math.floor(ellipse[0] + u * cos - v * sin + 0.5))
        py = int(math.floor(ellipse[1] + u * sin + v * cos + 0.5))
        if px < 1 or py < 1 or px > width - 2 or py > height - 2:
            continue
        for y in range(py - 1, py + 2):
            for x in range(px - 1, px + 2):
                p = head[y, x]
                while p >= 0:
                    if stamp[p] != mark and not claimed[p]:
                        stamp[p] = mark
                        _, nx, ny = offset_of(ellipse, cos, sin, points[p, 0], points[p, 1])
                        if abs(nx * normals[p, 0] + ny * normals[p, 1]) < ACROSS:
                            count += 1.0 if heights[p] >= full else heights[p] / full
                    p = following[p]
    return count


@kernel
def explain_crossings(
    head: Int32Array,
    following: Int32Array,
    points: FloatArray,
    normals: FloatArray,
    ellipses: FloatArray,
    figures: FloatArray,
    offsets: IntArray,
    support: IntArray,
    claimed: BoolArray,
    heights: FloatArray,
    share: float,
    least: float,
) -> FloatArray:
    """Return the figures with the crossing points that no accepted ellipse has claimed.

    Their evidence changes: what accepted ellipses explain is no clutter, what is left is, in
    proportion to the unsupported rest of the outline. Edges count fully when they are as high as
    a `share` of the median of the support. An ellipse whose evidence is below `least` without any
    clutter is left as it is.
    """
    stamp = np.zeros(len(points), np.int64)
    result = figures.copy()
    for k in range(len(ellipses)):
        row = result[k]
        covered = min(row[1], row[2])
        evidence = row[0] + doubt_of_clutter(covered, row[4])
        if evidence < least:
            continue
        if row[4] > 0.0:
            own = support[offsets[k] : offsets[k + 1]]
            full = share * np.median(heights[own])
            left = count_crossings(
                head, following, points, normals, ellipses[k], claimed, stamp, k + 1, heights, full
            )
            row[4] = left / len(own)
        row[0] = evidence - UNEXPLAINED * (1.0 - covered) * row[4]
    return result
