"""Edges of images that were drawn without grey levels in between: their stairs are smoothed."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from geoprim_core._check import AnyArray
from geoprim_core.edges import _kernels_stairs
from geoprim_core.edges.canny import (
    Float32Array,
    UInt32Array,
    find_edges,
    gradient_levels,
    image_gradient,
    one_channel,
    steady_gradient,
)
from geoprim_core.edges.params import EdgeParams

_NO_OCTETS = np.zeros((0, 0), np.uint8)
_NO_LEVELS = np.zeros((0, 0), np.float32)
_STAIRS = (0.4, 0.6)  # shares of hard steps from which an image has stairs, a little and fully


class Edges(NamedTuple):
    """Gradient (H, W), flat indices of the edge pixels, thresholds, deviation of the blur."""

    dx: Float32Array
    dy: Float32Array
    flat: UInt32Array
    low: float
    high: float
    blur: float


def smooth_edges(image: AnyArray, params: EdgeParams) -> Edges:
    """Return the edges of an image, blurred more where they are stairs.

    What is drawn without grey levels in between has outlines of steps: a small circle is a polygon
    with corners, at which contours end. Where the steps of oblique edges are hard, from one level
    to the other between two pixels, the blur grows up to `stair_sigma`. No camera gives such
    edges; what a renderer or a print has smoothed keeps its blur.
    """
    dx, dy, values, levels, blur = steady_gradient(image, params)
    flat, low, high = find_edges(dx, dy, values, params, levels)
    sigma = _sigma_for_stairs(image, flat, dx, dy, params)
    if sigma > blur:
        blur = sigma
        dx, dy, values = image_gradient(image, replace(params, sigma=sigma))
        flat, low, high = find_edges(dx, dy, values, params, gradient_levels(values, params))
    return Edges(dx, dy, flat, low, high, blur)


def _sigma_for_stairs(
    image: AnyArray, flat: UInt32Array, dx: Float32Array, dy: Float32Array, params: EdgeParams
) -> float:
    """Return the deviation of the blur that the stairs of an image call for."""
    if params.stair_sigma <= params.sigma:
        return params.sigma
    first, full = _STAIRS
    share = min(1.0, max(0.0, (hard_share(image, flat, dx, dy, params) - first) / (full - first)))
    return params.sigma + share * (params.stair_sigma - params.sigma)


def hard_share(
    image: AnyArray, flat: UInt32Array, dx: Float32Array, dy: Float32Array, params: EdgeParams
) -> float:
    """Return the share of oblique edge pixels, weighted by their height, that are one hard step.

    About one half in pure noise, which has no grey levels in between either.
    """
    stride, offset = 1, 0
    if image.dtype == np.uint8 and image.ndim == 3 and image.flags.c_contiguous:
        rows, stride, offset = image.reshape(len(image), -1), image.shape[2], 1
    else:
        rows = one_channel(image, params)
    if rows.dtype == np.uint8:
        octets, levels = np.ascontiguousarray(rows), _NO_LEVELS
    else:
        octets, levels = _NO_OCTETS, np.ascontiguousarray(rows, np.float32)
    share = float(_kernels_stairs.hard_share(flat, dx, dy, octets, levels, stride, offset))
    return round(share * 2.0**12) / 2.0**12  # a turned image has its sums in another order
