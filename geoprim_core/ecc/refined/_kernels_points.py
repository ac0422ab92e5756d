"""Kernels of the `refined` scheme: the edge points of an image, and which lie in each pixel."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from geoprim_core._check import FloatArray, Int32Array, IntArray
from geoprim_core._jit import kernel

TINY = 1e-9  # pixels


class EdgeIndex(NamedTuple):
    """All edge points of an image, and which of them lie in each pixel.

    Attributes
    ----------
    head : (H, W) int32
        The first edge point of every pixel, -1 for none.
    following : (N,) int32
        The next point in the same pixel, -1 for none.
    points : (N, 2) float64
        Positions in pixels.
    normals : (N, 2) float64
        Unit vectors along the gradient, from dark to bright.
    """

    head: Int32Array
    following: Int32Array
    points: FloatArray
    normals: FloatArray


@kernel
def index_points(points: FloatArray, normals: FloatArray, width: int, height: int) -> EdgeIndex:
    """Return the edge points with an index by pixel.

    Of two pixels as near that on the brighter side has the point, whichever way the image is
    turned: where the edge lies half a pixel from its pixel, many points are in between.
    """
    head = np.full((height, width), -1, np.int32)
    following = np.full(len(points), -1, np.int32)
    for k in range(len(points) - 1, -1, -1):
        x = int(math.floor(points[k, 0] + TINY * normals[k, 0] + 0.5))
        y = int(math.floor(points[k, 1] + TINY * normals[k, 1] + 0.5))
        if 0 <= x < width and 0 <= y < height:
            following[k] = head[y, x]
            head[y, x] = k
    return EdgeIndex(head, following, points, normals)


@kernel
def arcs_of_points(order: IntArray, ends: IntArray, total: int) -> IntArray:
    """Return for each of `total` points the arc that it is on, -1 for none."""
    arc_of = np.full(total, -1, np.int64)
    for i in range(len(ends) - 1):
        for k in range(ends[i], ends[i + 1]):
            arc_of[order[k]] = i
    return arc_of
