"""Kernels of the `refined` scheme: edges that cross an outline, and whose they are."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.ecc.refined._kernels_fit import offset_of
from geoprim_core.ecc.refined._kernels_outline import ACROSS
from geoprim_core.ecc.refined._kernels_places import outline_of, pixel_at
from geoprim_core.ecc.refined._kernels_points import EdgeIndex
from geoprim_core.ecc.refined._kernels_support import (
    ACROSS_EACH,
    COVERAGE,
    EVIDENCE,
    TURN_COVERAGE,
    Supported,
    doubt_of_clutter,
)

UNEXPLAINED_WEIGHT = 60.0  # evidence lost for one unexplained crossing point a supporting one


@kernel
def count_crossings(
    edges: EdgeIndex,
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
    head, following, points, normals = edges
    height, width = head.shape
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    count = 0.0
    places = outline_of(ellipse[2], ellipse[3], 2.0)
    for k in range(len(places)):
        px, py = pixel_at(ellipse, cos, sin, places[k, 0], places[k, 1])
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
    edges: EdgeIndex,
    found: Supported,
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
    stamp = np.zeros(len(edges.points), np.int64)
    result = found.figures.copy()
    for k in range(len(result)):
        row = result[k]
        covered = min(row[COVERAGE], row[TURN_COVERAGE])
        evidence = row[EVIDENCE] + doubt_of_clutter(covered, row[ACROSS_EACH])
        if evidence < least:
            continue
        if row[ACROSS_EACH] > 0.0:
            own = found.support[found.offsets[k] : found.offsets[k + 1]]
            full = share * np.median(heights[own])
            ellipse = found.ellipses[k]
            left = count_crossings(edges, ellipse, claimed, stamp, k + 1, heights, full)
            row[ACROSS_EACH] = left / len(own)
        row[EVIDENCE] = evidence - UNEXPLAINED_WEIGHT * (1.0 - covered) * row[ACROSS_EACH]
    return result
