"""Edges of images that were drawn without grey levels in between: their stairs are smoothed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from geoprim_core._check import AnyArray
from geoprim_core.edges import _kernels_softness, _kernels_stairs
from geoprim_core.edges.canny import (
    Float32Array,
    UInt32Array,
    channels_of,
    find_edges,
    gradient,
    gradient_levels,
    image_rows,
    steady_gradient,
)
from geoprim_core.edges.params import EdgeParams

_SAMPLE = 500  # edge pixels that tell how soft most are
_STAIRS = (0.5, 0.7)  # shares of hard steps from which an image has stairs, a little and fully


class Edges(NamedTuple):
    """Gradient (H, W), flat indices of the edge pixels, thresholds, blur, softness of the edges."""

    dx: Float32Array
    dy: Float32Array
    flat: UInt32Array
    low: float
    high: float
    blur: float
    softness: float


def smooth_edges(image: AnyArray, params: EdgeParams) -> Edges:
    """Return the edges of an image, blurred more where they are stairs.

    What is drawn without grey levels in between has outlines of steps: a small circle is a polygon
    with corners, at which contours end. Where the steps of oblique edges are hard, from one level
    to the other between two pixels, the blur grows up to `stair_sigma`. The edges of a camera are
    softer, those of sharpened and reduced photographs in up to half of their pixels; what a
    renderer or a print has smoothed keeps its blur.
    """
    channels = channels_of(image, params)  # once: other types than 8 bits are stretched
    dx, dy, values, levels, blur = steady_gradient(channels, params)
    flat, low, high = find_edges(dx, dy, values, params, levels)
    if params.stair_sigma > blur:
        share = hard_share(channels, flat, values, dx, dy, levels.typical)
        first, full = _STAIRS
        growth = min(1.0, max(0.0, (share - first) / (full - first)))
        sigma = params.sigma + growth * (params.stair_sigma - params.sigma)
        if sigma > blur:
            blur = sigma
            dx, dy, values, extent = gradient(channels, sigma)
            levels = gradient_levels(values, extent, params)
            flat, low, high = find_edges(dx, dy, values, params, levels)
    least = np.float32(levels.typical)
    soft = float(_kernels_softness.softness(flat, values, dx, dy, least, _SAMPLE))
    return Edges(dx, dy, flat, low, high, blur, soft)


def hard_share(
    channels: AnyArray,
    flat: UInt32Array,
    values: Float32Array,
    dx: Float32Array,
    dy: Float32Array,
    least: float,
) -> float:
    """Return the share of oblique edge pixels, weighted by their height, that are one hard step.

    Of edges whose gradient is at least `least`. About one half in pure noise, which has no grey
    levels in between either.
    """
    octets, grays, count = image_rows(channels)
    share = float(
        _kernels_stairs.hard_share(
            flat, values, dx, dy, np.float32(least), octets, grays, count // 2
        )
    )
    return round(share * 2.0**12) / 2.0**12  # a turned image has its sums in another order
