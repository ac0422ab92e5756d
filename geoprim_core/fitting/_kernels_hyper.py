"""Kernel of hyper least squares with all terms of the published constraint."""

from __future__ import annotations

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel
from geoprim_core.fitting._kernels_fit import (
    FEW,
    OK,
    UNDETERMINED,
    algebraic_residual,
    determined,
    few_distinct,
    point_sums,
    reduced,
    whitened,
)
from geoprim_core.fitting._kernels_pencil import (
    from_conic,
    metric_of,
    scatter_of,
    solved,
    unbiased,
)

# The monomial uv counts by the root of two, so that a turn of (u, v) turns the six orthogonally.
_TURNING = np.array([1.0, np.sqrt(2.0), 1.0, 1.0, 1.0, 1.0])


@kernel
def _inverse_of_rank_five(scatter: FloatArray) -> FloatArray:
    """Return the pseudo-inverse of M (6, 6) without its least eigenvalue."""
    turning = scatter.copy()
    for i in range(6):
        for j in range(6):
            turning[i, j] *= _TURNING[i] * _TURNING[j]
    values, vectors = np.linalg.eigh(turning)
    inverse = np.zeros((6, 6))
    for k in range(1, 6):
        size = max(values[k], 1e-12 * values[5])
        for i in range(6):
            for j in range(6):
                both = vectors[i, k] * vectors[j, k] * _TURNING[i] * _TURNING[j]
                inverse[i, j] += both / size
    return inverse


@kernel
def second_terms(
    local: FloatArray, weights: FloatArray, scatter: FloatArray, metric: FloatArray
) -> FloatArray:
    """Return the terms of order 1 / n of Kanatani's N (6, 6), for whitened points (n, 2)."""
    inverse = _inverse_of_rank_five(scatter)
    result, spread = np.zeros((6, 6)), np.empty((6, 6))
    total = weights.sum() if len(weights) else float(len(local))
    xi, du, dv = np.ones(6), np.zeros(6), np.zeros(6)
    image, side = np.empty(6), np.empty(6)
    for n in range(len(local)):
        u, v = local[n, 0], local[n, 1]
        xi[0], xi[1], xi[2], xi[3], xi[4] = u * u, u * v, v * v, u, v
        du[0], du[1], du[3] = 2.0 * u, v, 1.0
        dv[1], dv[2], dv[4] = u, 2.0 * v, 1.0
        trace, length = 0.0, 0.0
        for i in range(6):
            image[i] = 0.0
            for j in range(6):
                mixed = du[i] * dv[j] + dv[i] * du[j]
                spread[i, j] = metric[0] * du[i] * du[j] + metric[2] * dv[i] * dv[j]
                spread[i, j] += metric[1] * mixed
                trace += inverse[i, j] * spread[i, j]
                image[i] += inverse[i, j] * xi[j]
            length += xi[i] * image[i]
        share = (weights[n] if len(weights) else 1.0) / total
        for i in range(6):
            side[i] = 0.0
            for j in range(6):
                side[i] += spread[i, j] * image[j]
        for i in range(6):
            for j in range(6):
                term = trace * xi[i] * xi[j] + length * spread[i, j]
                result[i, j] += share * share * (term + side[i] * xi[j] + xi[i] * side[j])
    return result


@kernel
def hyper_points(
    points: FloatArray, weights: FloatArray, all_terms: bool
) -> tuple[int, FloatArray, float]:
    """Fit an ellipse (5,) to points (n, 2) with weights (n,) or (0,); status, ellipse, residual."""
    nothing = np.full(5, np.nan)
    if few_distinct(points, weights):
        return FEW, nothing, np.nan
    moments, x0, y0, scale = point_sums(points, weights)
    status, m, frame = whitened(moments)
    if status != OK:
        return status, nothing, np.nan
    if not determined(reduced(m)):
        return UNDETERMINED, nothing, np.nan
    scatter, metric = scatter_of(m), metric_of(frame)
    constraint = unbiased(m, metric)
    if all_terms and len(points) > 5:  # five points leave no scatter: the terms cancel out
        local = np.empty((len(points), 2))
        for i in range(len(points)):
            dx = (points[i, 0] - x0) / scale - frame[0]
            dy = (points[i, 1] - y0) / scale - frame[1]
            local[i, 0], local[i, 1] = frame[2] * dx, frame[3] * dx + frame[4] * dy
        constraint -= second_terms(local, weights, scatter, metric)
    conic = solved(scatter, constraint, True)
    status, ellipse, residual = from_conic(conic, m, frame, x0, y0, scale)
    if status == OK:
        residual = algebraic_residual(points, weights, ellipse)
    return status, ellipse, residual
