"""Kernels of the `refined` scheme, strokes: mates of edges that a normal passes by."""

from __future__ import annotations

from typing import NamedTuple

from geoprim_core._check import FloatArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_points import EdgeIndex

OPPOSITE = -0.9  # cosine of the angle between the normals of mates, at most
LIKE_NEIGHBOUR = 0.75  # pixels between the distances to the mates of two neighbours


class MateSearch(NamedTuple):
    """Among which edges mates are looked for.

    Attributes
    ----------
    edges : EdgeIndex
    heights : (N,) float64
        Magnitudes of the gradient at the edge points.
    evenness : float
        Least ratio of the heights of two mates.
    reach : float
        Largest distance of two mates in pixels.
    """

    edges: EdgeIndex
    heights: FloatArray
    evenness: float
    reach: float


@inner_kernel
def mate_near(
    search: MateSearch,
    k: int,
    gap: float,
) -> float:
    """Return the signed distance from a point to an opposite edge about `gap` away, else 0."""
    head, following, points, normals = search.edges
    heights, evenness = search.heights, search.evenness
    height, width = head.shape
    nx, ny = normals[k, 0], normals[k, 1]
    x, y = points[k, 0], points[k, 1]
    column, row = round(x + gap * nx), round(y + gap * ny)
    found, nearest = 0.0, LIKE_NEIGHBOUR
    for j in range(max(0, row - 1), min(height, row + 2)):
        for i in range(max(0, column - 1), min(width, column + 2)):
            p = head[j, i]
            while p >= 0:
                along = (points[p, 0] - x) * nx + (points[p, 1] - y) * ny
                dot = normals[p, 0] * nx + normals[p, 1] * ny
                low, high = min(heights[p], heights[k]), max(heights[p], heights[k])
                mate = low >= evenness * high and dot < OPPOSITE and abs(along) < search.reach
                if mate and abs(along - gap) < nearest:
                    found, nearest = along, abs(along - gap)
                p = following[p]
    return found


@inner_kernel
def follow_mates(
    search: MateSearch,
    first: int,
    step: int,
    sign: float,
    gaps: FloatArray,
) -> None:
    """Find, in place, mates next to those of the neighbours, going one way from point `first`."""
    for m in range(1, len(gaps)):
        k = m if step > 0 else len(gaps) - 1 - m
        if gaps[k] == 0.0 and gaps[k - step] != 0.0:
            gap = sign * gaps[k - step]
            gaps[k] = abs(mate_near(search, first + k, gap))


@kernel
def complete_mates(
    search: MateSearch,
    first: int,
    last: int,
    sign: float,
    gaps: FloatArray,
) -> None:
    """Find, in place, the mates of points first .. last - 1 next to points that have one.

    Those on one side (`sign` -1: dark, 1: bright). A normal may pass between two pixels of an edge
    that runs diagonally, and does so for some points on end. Where the mate of the neighbour is
    tells where to look. Both ways along the contour count alike.
    """
    own = gaps[first:last]
    there, back = own.copy(), own.copy()
    follow_mates(search, first, 1, sign, there)
    follow_mates(search, first, -1, sign, back)
    for k in range(len(own)):
        both = there[k] > 0.0 and back[k] > 0.0
        own[k] = min(there[k], back[k]) if both else max(there[k], back[k])
