"""Kernel that measures how softly the edges of an image rise."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from geoprim_core._jit import kernel

LEAST_EDGES = 20  # that tell how soft most are


@kernel
def softness(flat: Any, values: Any, dx: Any, dy: Any, least: Any, most: Any) -> Any:
    """Return the standard deviation in pixels of the smoothing that most strong edges show.

    Of about `most` edge pixels with a gradient of `least` or more; NaN where there are too few.
    The magnitude across a smoothed step is a Gaussian, of whose logarithm the second difference
    is minus one over the variance, wherever the crest lies between the pixels.
    """
    height, width = dx.shape
    magnitudes, along, across = values.ravel(), dx.ravel(), dy.ravel()
    step = max(1, len(flat) // most)
    variances = np.empty(len(flat) // step + 1)
    size = 0
    for k in range(0, len(flat), step):
        place = np.int64(flat[k])
        here = np.float64(magnitudes[place])
        gx, gy = abs(np.float64(along[place])), abs(np.float64(across[place]))
        hop = 1 if gx >= gy else width
        if here < least or place < width or place >= (height - 1) * width:
            continue
        before, after = np.float64(magnitudes[place - hop]), np.float64(magnitudes[place + hop])
        fall = 2.0 * math.log(here) - math.log(before + 1e-9) - math.log(after + 1e-9)
        if fall > 0.0:
            variances[size] = max(gx, gy) ** 2 / (here * here * fall)
            size += 1
    return math.sqrt(np.median(variances[:size])) if size >= LEAST_EDGES else math.nan
