"""Linking edge pixels into ordered 8-connected contours, thesis section 5.3."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from geoprim_core._check import BoolArray, Int32Array, UInt32Array
from geoprim_core.edges import (
    _kernels_junctions,
    _kernels_linking,
    _kernels_pixels,
    _kernels_walk,
)
from geoprim_core.edges.canny import Float32Array
from geoprim_core.edges.params import EdgeParams
from geoprim_core.types import Contours

STRONG = 2.0  # high thresholds: in noise, five of its standard deviations
_GROWN = 0.3  # pixels that the blur has grown by where noise or stairs turn gradients fully


@dataclass(frozen=True, slots=True, eq=False)
class EdgePixels:
    """The pixels of an edge map in raster order.

    Attributes
    ----------
    x, y : (N,) int32
    index : (H + 2, W + 2) uint32
        Place of a pixel in the list, the largest number where there is no edge; the last two
        rows and columns are a margin without edges.
    table : (N, 4) float32
        From the pixel to the edge (x, y), in multiples of 1/256 px, within half a pixel; unit
        vector (x, y) of the grey-level gradient, from dark to bright.
    magnitude : (N,) float32
        Length of the gradient in grey levels per pixel.
    strong : (N,) bool
        Pixels whose gradient noise does not reach; (0,): not known.
    blur : float
        Standard deviation of the Gaussian blur before the gradient in pixels; NaN: not known.
    softness : float
        Standard deviation of the smoothing that most edges show in pixels; NaN: not known.
    """

    x: Int32Array
    y: Int32Array
    index: UInt32Array
    table: Float32Array
    magnitude: Float32Array
    strong: BoolArray
    blur: float = float("nan")
    softness: float = float("nan")

    @property
    def image_size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        height, width = self.index.shape
        return width - _kernels_pixels.MARGIN, height - _kernels_pixels.MARGIN


def locate_pixels(
    flat: UInt32Array,
    dx: Float32Array,
    dy: Float32Array,
    blur: float = float("nan"),
    sure: float = float("inf"),
) -> EdgePixels:
    """Return the edge pixels at rising flat indices with the position and direction of the edge.

    A gradient of `sure` or more makes a pixel strong.

    References
    ----------
    Devernay, A non-maxima suppression method for edge detection with sub-pixel accuracy,
    INRIA RR-2724 (1995), with the parabola along the row or column instead of the gradient.
    """
    height, width = dx.shape
    margin = _kernels_pixels.MARGIN
    index = np.empty((height + margin, width + margin), np.uint32)
    x, y, table, magnitude = _kernels_pixels.locate(flat, dx, dy, index)
    strong = np.zeros(0, np.bool_) if math.isinf(sure) else magnitude >= sure
    return EdgePixels(x, y, index, table, magnitude, strong, blur)


@lru_cache(maxsize=8)
def _turn_limits(max_turn: float) -> npt.NDArray[np.float64]:
    """Return the least cosines of a turn: as a rule, and where the contour bends around it."""
    return np.cos(np.radians([max_turn, 2.0 * max_turn]))


def link_by_direction(pixels: EdgePixels, *, params: EdgeParams) -> Contours:
    """Join neighbouring edge pixels whose signed gradients agree.

    A step leads along the edge to a pixel within `reach` whose gradient, sign included, differs
    by at most `max_turn`, or twice that where the contour bends as much on both sides (small
    circles; noise and stairs turn the gradient there by jerks, see `max_jerk`); the shortest and
    straightest steps are taken first. Contours so pass
    through junctions, and the two edges of a stroke stay apart. A step over a missing pixel puts
    that pixel in, the only pixels that contours may share.
    """
    x, y, index, table = pixels.x, pixels.y, pixels.index, pixels.table
    slant = math.tan(math.radians(params.max_slant))
    limits = _turn_limits(params.max_turn)
    source, target, cost, cosine, double = _kernels_linking.find_steps(
        x, y, index, table, limits[1], params.reach, slant
    )
    before, after = _kernels_linking.chain(source, target, cost, cosine, double, limits)
    angle = _kernels_pixels.directions(table)
    _kernels_linking.cut_corners(
        angle, before, after, math.radians(params.max_turn), pixels.strong, _jerk(pixels, params)
    )
    return _contours(pixels, angle, before, after, params)


def _jerk(pixels: EdgePixels, params: EdgeParams) -> float:
    """Return the share of the bend of a contour that the turn of a step may differ from it."""
    if len(pixels.strong) != len(pixels.x):
        return 0.0
    return params.max_jerk * min(1.0, max(0.0, (pixels.blur - params.sigma) / _GROWN))


def link_without_junctions(pixels: EdgePixels, *, params: EdgeParams) -> Contours:
    """Thin the edge map, take out the junction pixels and follow what is left."""
    x, y = pixels.x, pixels.y
    width, height = pixels.image_size
    farthest_first = np.argsort(-(pixels.table[:, :2] ** 2).sum(axis=1), kind="stable")
    edges = pixels.index[:height, :width] != _kernels_pixels.NONE
    lean = _kernels_junctions.thin(edges, x, y, farthest_first)
    before, after = _kernels_junctions.follow(
        _kernels_junctions.cut_junctions(lean, x, y), pixels.index, len(x)
    )
    angle = _kernels_pixels.directions(pixels.table)
    return _contours(pixels, angle, before, after, params)


def _contours(
    pixels: EdgePixels,
    angle: Float32Array,
    before: UInt32Array,
    after: UInt32Array,
    params: EdgeParams,
) -> Contours:
    points, fine, tilt, offsets, closed = _kernels_walk.walk(
        pixels.x, pixels.y, pixels.table, angle, before, after, params.min_length
    )
    return Contours.made(
        True,
        points=points,
        offsets=offsets,
        closed=closed,
        image_size=pixels.image_size,
        subpixel=fine if params.subpixel else None,
        gradient_angle=tilt,
        blur=pixels.blur,
        softness=pixels.softness,
        gradient_magnitude=_kernels_pixels.magnitudes_at(points, pixels.index, pixels.magnitude),
    )
