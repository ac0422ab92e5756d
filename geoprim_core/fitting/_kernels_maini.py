"""Kernel of Maini's enhanced direct fit: a box of side 2, and noise where the data have none."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel
from geoprim_core.fitting._kernels_fit import (
    FEW,
    FLAT,
    OK,
    UNDETERMINED,
    algebraic_residual,
    classified,
    determined,
    few_distinct,
    from_whitened,
    point_sums,
    reduced,
    whitened,
)
from geoprim_core.fitting._kernels_moments import add_moments, add_weighted_moments
from geoprim_core.fitting._kernels_pencil import ellipses_only, scatter_of, solved

_ZERO = 1e-12  # least to largest eigenvalue of the scatter below which data count as exact
_GOLDEN, _SILVER = 0.6180339887498949, 0.41421356237309515


@kernel
def _box_of(points: FloatArray) -> FloatArray:
    """Return the map (5,) of `whitened` that takes the bounding box to [-1, 1]^2."""
    left, right = points[:, 0].min(), points[:, 0].max()
    top, bottom = points[:, 1].min(), points[:, 1].max()
    box = np.zeros(5)
    box[0], box[1] = 0.5 * (left + right), 0.5 * (top + bottom)
    box[2], box[4] = 2.0 / (right - left), 2.0 / (bottom - top)
    return box


@kernel
def _scatter(local: FloatArray, weights: FloatArray) -> FloatArray:
    moments = np.zeros(15)
    if len(weights):
        add_weighted_moments(local, weights, 0.0, 0.0, 1.0, moments)
    else:
        add_moments(local, 0.0, 0.0, 1.0, moments)
    return scatter_of(moments / moments[0])


@kernel
def _perturbed(local: FloatArray, noise: float, copy: int) -> FloatArray:
    """Return points with Gaussian noise, always the same for the same copy (errata C6)."""
    result = local.copy()
    for i in range(len(local)):
        k = float(copy * len(local) + i + 1)
        radius = noise * math.sqrt(-2.0 * math.log(1.0 - (k * _GOLDEN) % 1.0))
        turn = 2.0 * math.pi * ((k * _SILVER) % 1.0)
        result[i, 0] += radius * math.cos(turn)
        result[i, 1] += radius * math.sin(turn)
    return result


@kernel
def maini_points(
    points: FloatArray, weights: FloatArray, noise: float, copies: int
) -> tuple[int, FloatArray, float]:
    """Fit an ellipse (5,) to points (n, 2) with weights (n,) or (0,); status, ellipse, residual."""
    nothing = np.full(5, np.nan)
    if few_distinct(points, weights):
        return FEW, nothing, np.nan
    status, m, _ = whitened(point_sums(points, weights)[0])
    if status != OK:
        return status, nothing, np.nan
    if not determined(reduced(m)):
        return UNDETERMINED, nothing, np.nan
    box = _box_of(points)
    local = np.empty((len(points), 2))
    for i in range(len(points)):
        local[i, 0] = box[2] * (points[i, 0] - box[0])
        local[i, 1] = box[4] * (points[i, 1] - box[1])
    scatter = _scatter(local, weights)
    values = np.linalg.eigvalsh(scatter)
    if values[0] > _ZERO * values[5]:
        conic = solved(scatter, ellipses_only(), False)
    else:
        conic = np.zeros(6)
        for copy in range(copies):
            one = solved(_scatter(_perturbed(local, noise, copy), weights), ellipses_only(), False)
            size = one[0] + one[2]  # of one sign for ellipses, whose mean is an ellipse then
            conic += one / (size * copies)
    kind = classified(conic[0], conic[1], conic[2], FLAT)
    if kind != OK:
        return kind, nothing, np.nan
    status, ellipse, _ = from_whitened(conic, box)
    residual = algebraic_residual(points, weights, ellipse) if status == OK else np.nan
    return status, ellipse, residual
