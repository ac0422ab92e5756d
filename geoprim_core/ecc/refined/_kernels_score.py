"""Kernel of the `refined` scheme, score: from evidence to log odds."""

from __future__ import annotations

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel


@kernel
def line_through(
    values: FloatArray, xs: FloatArray, ys: FloatArray, low: float, high: float
) -> FloatArray:
    """Return the piecewise linear function through (xs, ys), straight beyond, in low .. high."""
    result = np.empty(len(values))
    for k in range(len(values)):
        piece = 0
        while piece < len(xs) - 2 and xs[piece + 1] < values[k]:
            piece += 1
        slope = (ys[piece + 1] - ys[piece]) / (xs[piece + 1] - xs[piece])
        value = ys[piece] + slope * (values[k] - xs[piece])
        value = low if value < low else value
        result[k] = high if value > high else value
    return result
