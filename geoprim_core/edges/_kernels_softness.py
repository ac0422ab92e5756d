"""Kernels that measure how softly the edges of an image rise."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from geoprim_core._jit import inner_kernel, kernel

LEAST_EDGES = 20  # that tell how soft most are


@inner_kernel
def variances_of(
    flat: Any, magnitudes: Any, along: Any, across: Any, width: Any, least: Any, step: Any,
    variances: Any,
) -> Any:  # fmt: skip
    """Write the variances of the smoothing that strong edges show; return how many they are.

    Of every `step`-th edge pixel, if its gradient is `least` or more. The magnitude across a
    smoothed edge is a Gaussian, of whose logarithm the second difference is minus one over the
    variance, wherever the crest lies between the pixels.
    """
    size = 0
    for k in range(0, len(flat), step):
        place = np.int64(flat[k])
        here = np.float64(magnitudes[place])
        if here < least or place < width or place >= len(magnitudes) - width:
            continue
        gx, gy = abs(np.float64(along[place])), abs(np.float64(across[place]))
        hop = 1 if gx >= gy else width
        before, after = np.float64(magnitudes[place - hop]), np.float64(magnitudes[place + hop])
        ratio = here * here / (before * after + 1e-9)
        if ratio > 1.0:
            foot = max(gx, gy) / here
            variances[size] = foot * foot / math.log(ratio)
            size += 1
    return size


@kernel
def softness(flat: Any, values: Any, dx: Any, dy: Any, least: Any, most: Any) -> Any:
    """Return the standard deviation in pixels of the smoothing that most strong edges show.

    Of about `most` edge pixels those with a gradient of `least` or more; where few have, of all;
    NaN where these are too few.
    """
    rows, width = (values.ravel(), dx.ravel(), dy.ravel()), values.shape[1]
    variances = np.empty(len(flat))
    step = max(1, len(flat) // most)
    size = variances_of(flat, *rows, width, least, step, variances)
    if size < LEAST_EDGES and step > 1:
        size = variances_of(flat, *rows, width, least, 1, variances)
    return math.sqrt(np.median(variances[:size])) if size >= LEAST_EDGES else math.nan
