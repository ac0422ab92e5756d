"""Kernels of step 4 of the `refined` scheme: the two edges of one drawn line."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc._kernels_refined_outline import Int32Array

FARTHEST = 1.5  # pixels that a point in the pixel of a step may be nearer than the step
ALIKE = 1.0  # pixels between the width of a line here and its typical width
DOUBTED = 5.0  # points without a mate that each contour is given: short ones have mates by chance
FOLLOWED = 5.0  # points with a mate that it is given in an image of lines
FOLLOWING = 0.1  # share of mates from which a contour is a line in an image of lines


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
                if step - FARTHEST >= best:
                    break
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


@inner_kernel
def count_alike(gaps: FloatArray, width: float) -> int:
    """Count the mates that lie about as far as a line of the given signed width is wide."""
    count = 0
    for gap in gaps:
        count += gap != 0.0 and abs(gap - width) < ALIKE
    return count


@kernel
def own_width(gaps: FloatArray, share: float, reach: float) -> float:
    """Return the signed width of the line that a contour is an edge of by its own mates, else 0.

    More than `share` of its points have a mate on one side within `reach`, at one distance.
    """
    dark = bright = 0
    for gap in gaps:
        dark += -reach < gap < 0.0
        bright += 0.0 < gap < reach
    least = share * (len(gaps) + DOUBTED)
    if max(dark, bright) <= least:
        return 0.0
    side = -1.0 if dark > bright else 1.0
    width = np.median(gaps[(side * gaps > 0.0) & (side * gaps < reach)])
    return width if count_alike(gaps, width) > least else 0.0


@kernel
def stroke_widths(
    gaps: FloatArray, offsets: IntArray, share: float, reach: float, common: float
) -> FloatArray:
    """Return for every point the signed width of the line that its contour is an edge of, else 0.

    Each contour is judged by its own mates within `reach` (`own_width`). In an image of lines,
    most of them `common` wide (0: no such image), a contour follows the others unless it is long
    enough to tell that it is none: crossings hide mates.
    """
    widths = np.zeros(len(gaps))
    for c in range(len(offsets) - 1):
        own = gaps[offsets[c] : offsets[c + 1]]
        follows = common != 0.0 and count_alike(own, common) + FOLLOWED > FOLLOWING * len(own)
        widths[offsets[c] : offsets[c + 1]] = common if follows else own_width(own, share, reach)
    return widths
