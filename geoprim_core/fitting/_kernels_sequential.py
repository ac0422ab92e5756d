"""Kernel of Liu's refinement: gradient descent on one point after another."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel
from geoprim_core.fitting._kernels_distance import canonical
from geoprim_core.fitting._kernels_fit import (
    INFINITE,
    NSAF,
    OK,
    algebraic_residual,
    fit_points_of,
)


@kernel
def descend(ellipse: FloatArray, x: float, y: float, rate: float, unit: float) -> None:
    """Move an ellipse (5,) by `rate` down the gradient of half its squared distance to a point.

    The distance is the first-order one, the conic's value over its gradient, cut off at the
    semi-minor axis: towards the centre it has no bound. A turn counts in pixels at `unit`.
    """
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    dx, dy = x - ellipse[0], y - ellipse[1]
    major, minor = ellipse[2], ellipse[3]
    u, v = cos * dx + sin * dy, cos * dy - sin * dx
    gu, gv = 2.0 * u / major**2, 2.0 * v / minor**2
    size = math.hypot(gu, gv)
    if size == 0.0:
        return
    value = (u / major - 1.0) * (u / major + 1.0) + (v / minor) ** 2
    step = rate * min(max(value / size, -minor), minor) / size
    ellipse[0] += step * (cos * gu - sin * gv)
    ellipse[1] += step * (sin * gu + cos * gv)
    ellipse[2] += step * 2.0 * u * u / major**3
    ellipse[3] += step * 2.0 * v * v / minor**3
    ellipse[4] -= step * (gu * v - gv * u) / (unit * unit)


@kernel
def liu_points(
    points: FloatArray, weights: FloatArray, rate: float, sweeps: int
) -> tuple[int, FloatArray, float]:
    """Fit an ellipse (5,) to points (n, 2) with weights (n,) or (0,); status, ellipse, residual."""
    status, ellipse, residual = fit_points_of(points, weights, NSAF)
    if status != OK:
        return status, ellipse, residual
    unit = math.sqrt(ellipse[2] * ellipse[3])
    total = weights.sum() if len(weights) else float(len(points))
    for _ in range(sweeps):
        for i in range(len(points)):
            share = (weights[i] if len(weights) else 1.0) / total
            descend(ellipse, points[i, 0], points[i, 1], rate * share, unit)
            if not (np.isfinite(ellipse).all() and min(ellipse[2], ellipse[3]) > 0.0):
                return INFINITE, np.full(5, np.nan), np.nan
    ellipse = canonical(ellipse)
    return OK, ellipse, algebraic_residual(points, weights, ellipse)
