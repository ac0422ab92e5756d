"""Kernel of the geometric fit as one row of the table: start, steps and outcome."""

from __future__ import annotations

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel
from geoprim_core.fitting._kernels_distance import refine_kernel, signed_distances
from geoprim_core.fitting._kernels_fit import NSAF, OK, algebraic_residual, fit_points_of
from geoprim_core.fitting._kernels_pencil import TAUBIN, pencil_points

_UNSETTLED = 8


@kernel
def geometric_points(
    points: FloatArray, weights: FloatArray, iterations: int, huber: float
) -> tuple[int, FloatArray, float]:
    """Fit an ellipse (5,) to points (n, 2) with weights (n,) or (0,); status, ellipse, residual.

    The steps start at the nearer of the direct and of Taubin's ellipse.
    """
    status, start, residual = fit_points_of(points, weights, NSAF)
    if status != OK:
        return status, start, residual
    full = weights if len(weights) else np.ones(len(points))
    other_status, other, _ = pencil_points(points, weights, TAUBIN)
    if other_status == OK:
        near = (full * signed_distances(points, other) ** 2).sum()
        if near < (full * signed_distances(points, start) ** 2).sum():
            start = other
    ellipse, _, _, settled = refine_kernel(points, full, start, iterations, huber)
    if not settled:
        return _UNSETTLED, np.full(5, np.nan), np.nan
    return OK, ellipse, algebraic_residual(points, weights, ellipse)
