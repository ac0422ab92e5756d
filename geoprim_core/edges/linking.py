"""Linking edge pixels into ordered 8-connected contours, thesis section 5.3."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core._check import BoolArray
from geoprim_core.edges import _kernels_junctions, _kernels_linking, _kernels_pixels
from geoprim_core.edges.canny import Float32Array
from geoprim_core.edges.params import EdgeParams
from geoprim_core.types import Contours

Int32Array = npt.NDArray[np.int32]


@dataclass(frozen=True, slots=True, eq=False)
class EdgePixels:
    """The pixels of an edge map in raster order.

    Attributes
    ----------
    x, y : (N,) int32
    index : (H, W) int32
        Place of a pixel in the list, -1 where there is no edge.
    offset : (N, 2) float32
        From the pixel to the edge, in multiples of 1/256 px, within half a pixel.
    normal : (N, 2) float32
        Unit vector of the grey-level gradient, from dark to bright.
    """

    x: Int32Array
    y: Int32Array
    index: Int32Array
    offset: Float32Array
    normal: Float32Array


def locate_pixels(edges: BoolArray, dx: Float32Array, dy: Float32Array) -> EdgePixels:
    """Return the pixels of an edge map (H, W) with the position and direction of the edge.

    References
    ----------
    Devernay, A non-maxima suppression method for edge detection with sub-pixel accuracy,
    INRIA RR-2724 (1995), with the parabola along the row or column instead of the gradient.
    """
    x, y, index = _kernels_pixels.edge_pixels(np.flatnonzero(edges), *edges.shape)
    offset, normal = _kernels_pixels.locate(x, y, dx, dy)
    return EdgePixels(x, y, index, offset, normal)


def link_by_direction(pixels: EdgePixels, *, params: EdgeParams) -> Contours:
    """Join neighbouring edge pixels whose signed gradients agree.

    A step leads along the edge to a pixel within `reach` whose gradient, sign included, differs
    by at most `max_turn`, or twice that where the contour bends as much on both sides (small
    circles); the shortest and straightest steps are taken first. Contours so pass
    through junctions, and the two edges of a stroke stay apart. A step over a missing pixel puts
    that pixel in, the only pixels that contours may share.
    """
    x, y, index = pixels.x, pixels.y, pixels.index
    double = _kernels_pixels.find_doubles(x, y, index, pixels.offset, pixels.normal)
    slant = math.tan(math.radians(params.max_slant))
    cosines = [math.cos(math.radians(factor * params.max_turn)) for factor in (1.0, 2.0)]
    source, target, cost, cosine = _kernels_linking.find_steps(
        x, y, index, pixels.offset, pixels.normal, double, cosines[1], params.reach, slant
    )
    before = np.full(len(x), -1, np.int32)
    before[double] = -2  # takes no part
    after = before.copy()
    for least in cosines:
        chosen = cosine >= np.float32(least)
        _kernels_linking.chain(source, target, cost, chosen, before, after)
    _kernels_linking.cut_corners(pixels.normal, before, after, math.radians(params.max_turn))
    return _contours(pixels, before, after, params)


def link_without_junctions(pixels: EdgePixels, *, params: EdgeParams) -> Contours:
    """Thin the edge map, take out the junction pixels and follow what is left."""
    x, y = pixels.x, pixels.y
    farthest_first = np.argsort(-(pixels.offset**2).sum(axis=1), kind="stable")
    lean = _kernels_junctions.thin(pixels.index >= 0, x, y, farthest_first)
    before, after = _kernels_junctions.follow(
        _kernels_junctions.cut_junctions(lean, x, y), pixels.index
    )
    return _contours(pixels, before, after, params)


def _contours(
    pixels: EdgePixels, before: Int32Array, after: Int32Array, params: EdgeParams
) -> Contours:
    points, fine, angle, ends, closed = _kernels_linking.walk(
        pixels.x, pixels.y, pixels.offset, pixels.normal, before, after, params.min_length
    )
    height, width = pixels.index.shape
    return Contours(
        points=points,
        offsets=np.concatenate((np.zeros(1, np.int64), ends)),
        closed=closed,
        image_size=(width, height),
        subpixel=fine if params.subpixel else None,
        gradient_angle=angle,
    )
