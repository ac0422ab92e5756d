"""Edges of images that were drawn without grey levels in between: their stairs are smoothed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geoprim_core._check import AnyArray
from geoprim_core.edges import _kernels_softness, _kernels_stairs
from geoprim_core.edges.canny import (
    Edges,
    channels_of,
    find_edges,
    gradient,
    image_rows,
    measure_noise,
    steady_gradient,
)
from geoprim_core.edges.params import EdgeParams

_SAMPLE = 500  # edge pixels that tell how soft most are
_STAIRS = (0.5, 0.7)  # shares of hard steps from which an image has stairs, a little and fully


def smooth_edges(image: AnyArray, params: EdgeParams) -> Edges:
    """Return the edges of an image, blurred more where they are stairs.

    What is drawn without grey levels in between has outlines of steps: a small circle is a polygon
    with corners, at which contours end. Where the steps of oblique edges are hard, from one level
    to the other between two pixels, the blur grows up to `stair_sigma`. The edges of a camera are
    softer, those of sharpened and reduced photographs in up to half of their pixels; what a
    renderer or a print has smoothed keeps its blur.
    """
    channels = channels_of(image, params)  # once: other types than 8 bits are stretched
    edges = find_edges(steady_gradient(channels, params), params)
    if params.stair_sigma > edges.gradient.blur:
        first, full = _STAIRS
        growth = min(1.0, max(0.0, (hard_share(channels, edges) - first) / (full - first)))
        sigma = params.sigma + growth * (params.stair_sigma - params.sigma)
        if sigma > edges.gradient.blur:
            edges = find_edges(measure_noise(gradient(channels, sigma), params), params)
    return replace(edges, softness=_softness(edges))


def hard_share(channels: AnyArray, edges: Edges) -> float:
    """Return the share of oblique edge pixels, weighted by their height, that are one hard step.

    Of edges whose gradient is at least the typical one. About one half in pure noise, which has no
    grey levels in between either.
    """
    octets, grays, count = image_rows(channels)
    found = edges.gradient
    least = np.float32(found.typical)
    share = _kernels_stairs.hard_share(
        edges.flat, found.magnitude, found.dx, found.dy, least, octets, grays, count // 2
    )
    return round(float(share) * 2.0**12) / 2.0**12  # a turned image has its sums in another order


def _softness(edges: Edges) -> float:
    """Return the standard deviation in pixels of the smoothing that most edges show."""
    found = edges.gradient
    least = np.float32(found.typical)
    return float(
        _kernels_softness.softness(edges.flat, found.magnitude, found.dx, found.dy, least, _SAMPLE)
    )
