"""Kernels of the selective fit: how certain the points are of an ellipse, and the fit itself."""

from __future__ import annotations

import math
from typing import cast

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel
from geoprim_core.fitting._kernels_distance import foot_of
from geoprim_core.fitting._kernels_fit import (
    FEW,
    FLAT,
    NSAF,
    OK,
    UNDETERMINED,
    classified,
    determined,
    few_distinct,
    fit_points_of,
    point_sums,
    reduced,
    whitened,
)
from geoprim_core.fitting._kernels_geometric import geometric_points
from geoprim_core.fitting._kernels_pencil import gradients_of, scatter_of, solved

_UNCERTAIN = 11
_ROUND = np.array([0.5, 0.0, 0.5])  # the metric of the whitened coordinates themselves
# Monomials scaled by these turn into each other by a rotation when u and v do.
_EVEN = np.array([1.0, math.sqrt(2.0), 1.0, 1.0, 1.0, 1.0])
STEPS = cast(int, np.int64(100))  # typed: numba may compile a kernel anew for a literal number


@kernel
def _evidence(
    points: FloatArray, weights: FloatArray, conic: FloatArray, image: FloatArray, frame: FloatArray
) -> tuple[FloatArray, float]:
    """Return V (6, 6) and the noise s of a conic (6,) in whitened coordinates.

    V is the mean of g g times the outer square of the monomials, g the length of the gradient;
    s s is the sum of squared values over the sum of g g. `image` is origin and scale (3,) of the
    sums that were whitened.
    """
    spread, row = np.zeros((6, 6)), np.empty(6)
    values, slopes, total = 0.0, 0.0, 0.0
    for i in range(len(points)):
        weight = weights[i] if len(weights) else 1.0
        x = (points[i, 0] - image[0]) / image[2] - frame[0]
        y = (points[i, 1] - image[1]) / image[2] - frame[1]
        u, v = frame[2] * x, frame[3] * x + frame[4] * y
        row[0], row[1], row[2], row[3], row[4], row[5] = u * u, u * v, v * v, u, v, 1.0
        along = 2.0 * conic[0] * u + conic[1] * v + conic[3]
        across = conic[1] * u + 2.0 * conic[2] * v + conic[4]
        slope = along * along + across * across
        value = 0.0
        for j in range(6):
            value += conic[j] * row[j]
            for k in range(6):
                spread[j, k] += weight * slope * row[j] * row[k]
        values += weight * value * value
        slopes += weight * slope
        total += weight
    return spread / total, math.sqrt(values / slopes)


@kernel
def certainty_of(points: FloatArray, weights: FloatArray) -> tuple[int, float, float, float]:
    """Return status, D = (4 A C - B^2) / (A + C)^2, its standard error and the noise.

    The conic is Taubin's in whitened coordinates, where D is 1 for the circle that all ellipses
    with points all round are mapped to; it does not change with the scale of the coefficients.
    The error is that of first order: the covariance of the conic is s^2 M+ V M+ / n.
    """
    if few_distinct(points, weights):
        return FEW, np.nan, np.nan, np.nan
    moments, x0, y0, scale = point_sums(points, weights)
    status, m, frame = whitened(moments)
    if status != OK:
        return status, np.nan, np.nan, np.nan
    if not determined(reduced(m)):
        return UNDETERMINED, np.nan, np.nan, np.nan
    scatter = scatter_of(m)
    conic = solved(scatter, gradients_of(m, _ROUND), False)
    kind = classified(conic[0], conic[1], conic[2], FLAT)
    if kind != OK:
        return kind, np.nan, np.nan, np.nan
    conic /= conic[0] + conic[2]
    spread, noise = _evidence(points, weights, conic, np.array([x0, y0, scale]), frame)
    noise *= math.sqrt(moments[0] / max(moments[0] - 5.0, 1.0))
    value = 4.0 * conic[0] * conic[2] - conic[1] ** 2
    slope = np.zeros(6)
    slope[0], slope[1] = 4.0 * conic[2] - 2.0 * value, -2.0 * conic[1]
    slope[2] = 4.0 * conic[0] - 2.0 * value
    values, vectors = np.linalg.eigh(scatter * np.outer(_EVEN, _EVEN))
    slope *= _EVEN
    through = np.zeros(6)
    for j in range(1, 6):  # without the direction of the conic, along which D does not change
        through += vectors[:, j] * (slope @ vectors[:, j]) / values[j]
    through *= _EVEN
    error = noise * math.sqrt(max(float(through @ spread @ through), 0.0) / moments[0])
    return OK, value, error, noise


@kernel
def largest_gap(points: FloatArray, ellipse: FloatArray) -> float:
    """Return the largest gap of the points' eccentric angles at an ellipse (5,), in radians."""
    angles = np.empty(len(points) + 1)
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    for i in range(len(points)):
        dx, dy = points[i, 0] - ellipse[0], points[i, 1] - ellipse[1]
        u, v = cos * dx + sin * dy, cos * dy - sin * dx
        fu, fv = foot_of(abs(u), abs(v), ellipse[2], ellipse[3])
        angles[i] = math.atan2(math.copysign(fv, v) / ellipse[3], math.copysign(fu, u) / ellipse[2])
    angles[len(points)] = np.inf
    angles.sort()
    angles[len(points)] = angles[0] + 2.0 * math.pi
    return float(np.diff(angles).max())


@kernel
def selective_points(
    points: FloatArray, weights: FloatArray, certainty: float, noise: float, gap: float
) -> tuple[int, FloatArray, float]:
    """Fit an ellipse (5,) to points (n, 2) with weights (n,) or (0,); status, ellipse, residual."""
    nothing = np.full(5, np.nan)
    status, value, error, scatter = certainty_of(points, weights)
    if status != OK:
        return status, nothing, np.nan
    if not value >= certainty * error:
        return _UNCERTAIN, nothing, np.nan
    if scatter > noise:
        status, ellipse, residual = fit_points_of(points, weights, NSAF)
        if status == OK and largest_gap(points, ellipse) < gap:
            return status, ellipse, residual
    return geometric_points(points, weights, STEPS, np.inf)
