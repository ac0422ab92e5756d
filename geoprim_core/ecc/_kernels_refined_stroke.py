"""Kernels of step 4 of the `refined` scheme: the two edges of one drawn line."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel
from geoprim_core.ecc._kernels_refined_support import Int32Array


@kernel
def find_mates(
    head: Int32Array,
    following: Int32Array,
    points: FloatArray,
    normals: FloatArray,
    reach: float,
) -> FloatArray:
    """Return for every edge point the signed distance to the nearest opposite edge, else 0.

    The mate lies within `reach` pixels along the gradient (positive: on the bright side, negative:
    on the dark side), its gradient points the other way.
    """
    height, width = head.shape
    total = len(points)
    gaps = np.zeros(total)
    for k in range(total):
        best = reach
        for side in (-1.0, 1.0):
            for step in range(1, int(reach) + 1):
                x = int(math.floor(points[k, 0] + side * step * normals[k, 0] + 0.5))
                y = int(math.floor(points[k, 1] + side * step * normals[k, 1] + 0.5))
                if x < 0 or y < 0 or x >= width or y >= height:
                    break
                p = head[y, x]
                while p >= 0:
                    dx, dy = points[p, 0] - points[k, 0], points[p, 1] - points[k, 1]
                    along = dx * normals[k, 0] + dy * normals[k, 1]
                    dot = normals[p, 0] * normals[k, 0] + normals[p, 1] * normals[k, 1]
                    if dot < -0.9 and along * side > 0.5 and abs(along) < best:
                        best = abs(along)
                        gaps[k] = along
                    p = following[p]
    return gaps
