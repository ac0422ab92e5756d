"""From image to contours: the steps of thesis section 5.3 in their order."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from geoprim_core import _check
from geoprim_core._check import AnyArray, BoolArray
from geoprim_core.edges.canny import Edges, Float32Array, to_gray
from geoprim_core.edges.linking import (
    STRONG,
    EdgePixels,
    link_by_direction,
    link_without_junctions,
    locate_pixels,
)
from geoprim_core.edges.params import EdgeParams
from geoprim_core.edges.stairs import smooth_edges
from geoprim_core.methods import Method, Table
from geoprim_core.params import as_params
from geoprim_core.types import Contours

TABLE = Table(
    "linking",
    Method("direction", link_by_direction, EdgeParams, "linking by signed gradient direction"),
    Method(
        "junctions",
        link_without_junctions,
        EdgeParams,
        "thesis 5.3, after Kovesi: junction pixels removed",
    ),
)


@dataclass(frozen=True, slots=True, eq=False)
class EdgeTrace:
    """Every intermediate result of `extract_contours`.

    Attributes
    ----------
    gray : (H, W) uint8 or float32
        Grey image in 0..255.
    dx, dy : (H, W) float32
        Gradient of the blurred image in levels per pixel, of a colour image by `colour`.
    low, high : float
        Hysteresis thresholds on the gradient magnitude, in grey levels per pixel.
    edges : (H, W) bool
        Canny edge map.
    contours : Contours
    """

    gray: AnyArray
    dx: Float32Array
    dy: Float32Array
    low: float
    high: float
    edges: BoolArray
    contours: Contours


def trace_edges(image: AnyArray, params: EdgeParams | None = None) -> EdgeTrace:
    """Extract contours and keep every intermediate result.

    Parameters
    ----------
    image : (H, W), (H, W, 3) or (H, W, 4) uint8, uint16, float32 or float64
        Colours in the order blue, green, red (alpha). Types other than uint8 are stretched
        so that the least value becomes 0 and the largest 255.
    params : EdgeParams, optional

    Raises
    ------
    ImageError
        The image is empty, of a wrong shape or type, or not finite.
    ParameterError
        `params` is not an `EdgeParams`.

    Examples
    --------
    >>> import numpy as np
    >>> ramp = np.repeat([0, 0, 0, 0, 200, 200, 200, 200], 8).reshape(8, 8).astype(np.uint8)
    >>> trace = trace_edges(ramp)
    >>> int(trace.edges.sum()), float(trace.contours.subpixel[0, 1])
    (6, 3.5)
    """
    params = as_params(params, EdgeParams)
    image = _check.image(image)
    gray = to_gray(image, equalise=params.equalise)
    found = smooth_edges(image, params)
    dx, dy = found.gradient.dx, found.gradient.dy
    edges = np.zeros(dx.shape, np.bool_)
    edges.ravel()[found.flat] = True
    contours = TABLE[params.linking].function(_locate(found, params), params=params)
    return EdgeTrace(gray, dx, dy, found.low, found.high, edges, contours)


def extract_contours(image: AnyArray, params: EdgeParams | None = None) -> Contours:
    """Extract the ordered, 8-connected edge contours of an image.

    Canny edges of the image, linked into contours of at least `min_length` pixels.

    Parameters
    ----------
    image : (H, W), (H, W, 3) or (H, W, 4) uint8, uint16, float32 or float64
        Colours in the order blue, green, red (alpha). Types other than uint8 are stretched
        so that the least value becomes 0 and the largest 255.
    params : EdgeParams, optional

    Returns
    -------
    Contours
        With sub-pixel positions in multiples of 1/256 px (unless `subpixel` is off) and
        gradient angles; both survive a trip through float32 unchanged.

    Raises
    ------
    ImageError
        The image is empty, of a wrong shape or type, or not finite.
    ParameterError
        `params` is not an `EdgeParams`.

    References
    ----------
    Canny, A computational approach to edge detection, PAMI 8 (1986); thesis section 5.3;
    errata C7.

    Examples
    --------
    >>> import numpy as np
    >>> y, x = np.mgrid[:60, :80]
    >>> disc = np.clip(20.5 - np.hypot(x - 40, y - 30), 0, 1)
    >>> contours = extract_contours((255 * disc).astype(np.uint8))
    >>> len(contours), bool(contours.closed[0]), contours.image_size
    (1, True, (80, 60))
    """
    params = as_params(params, EdgeParams)
    contours: Contours = TABLE[params.linking].function(_find_pixels(image, params), params=params)
    return contours


def _find_pixels(image: AnyArray, params: EdgeParams) -> EdgePixels:
    """Return the edge pixels; the full-size intermediates are freed before the linking."""
    return _locate(smooth_edges(_check.image(image), params), params)


def _locate(found: Edges, params: EdgeParams) -> EdgePixels:
    gradient = found.gradient
    sure = STRONG * found.high if gradient.blur > params.sigma else math.inf
    pixels = locate_pixels(found.flat, gradient.dx, gradient.dy, gradient.blur, sure)
    return replace(pixels, softness=found.softness)
