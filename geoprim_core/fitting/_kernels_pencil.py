"""Kernels of the fits that are generalised eigenvalue problems M q = t N q of six unknowns.

q holds the conic's A, B, C, D, F, G for the monomials uu, uv, vv, u, v, 1. M is their mean
scatter, N the constraint. Both are built in the whitened coordinates of the points, where exact
and thin data keep their digits; what a constraint says about distances in the image enters
through the metric P = J J' of the map J from image to whitened coordinates.
"""

from __future__ import annotations

import math
from typing import cast

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel
from geoprim_core.fitting._kernels_conic import conic_of, ellipse_of
from geoprim_core.fitting._kernels_fit import (
    FEW,
    FLAT,
    INFINITE,
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
from geoprim_core.fitting._kernels_moments import shifted

# Typed: numba may compile a kernel anew for a literal number.
FITZGIBBON, TAUBIN, HYPER, HARKER, CHAUDHURI, RAW, LINEAR = (
    cast(int, np.int64(number)) for number in range(7)
)

_U = np.array([2, 1, 0, 1, 0, 0])  # powers of u and v in the six monomials
_V = np.array([0, 1, 2, 0, 1, 0])
_FIRST = np.array([0, 1, 3, 6, 10])


@kernel
def _moment(m: FloatArray, p: int, q: int) -> float:
    return float(m[_FIRST[p + q] + q]) if p >= 0 and q >= 0 else 0.0


@kernel
def scatter_of(m: FloatArray) -> FloatArray:
    """Return the mean scatter M (6, 6) of the monomials, from mean moments (15,)."""
    matrix = np.empty((6, 6))
    for i in range(6):
        for j in range(6):
            matrix[i, j] = _moment(m, _U[i] + _U[j], _V[i] + _V[j])
    return matrix


@kernel
def metric_of(frame: FloatArray) -> FloatArray:
    """Return P11, P12, P22 of a whitening map, of trace 1."""
    alpha, beta, gamma = frame[2], frame[3], frame[4]
    metric = np.array([alpha * alpha, alpha * beta, beta * beta + gamma * gamma])
    unit: FloatArray = metric / (metric[0] + metric[2])
    return unit


@kernel
def gradients_of(m: FloatArray, metric: FloatArray) -> FloatArray:
    """Return Taubin's N (6, 6): q N q is the mean square of the conic's gradient in the image."""
    matrix = np.empty((6, 6))
    for i in range(6):
        for j in range(6):
            p, q = _U[i] + _U[j], _V[i] + _V[j]
            mixed = _U[i] * _V[j] + _V[i] * _U[j]
            matrix[i, j] = (
                metric[0] * _U[i] * _U[j] * _moment(m, p - 2, q)
                + metric[1] * mixed * _moment(m, p - 1, q - 1)
                + metric[2] * _V[i] * _V[j] * _moment(m, p, q - 2)
            )
    return matrix


@kernel
def ellipses_only() -> FloatArray:
    """Return Fitzgibbon's N (6, 6) of 4 A C - B^2, (4-7)."""
    matrix = np.zeros((6, 6))
    matrix[0, 2], matrix[1, 1], matrix[2, 0] = 2.0, -1.0, 2.0
    return matrix


@kernel
def unbiased(m: FloatArray, metric: FloatArray) -> FloatArray:
    """Return the leading terms of Kanatani's N (6, 6): Taubin's and the bias of the squares."""
    matrix = gradients_of(m, metric)
    for i in range(6):
        mean = _moment(m, _U[i], _V[i])
        for j in range(3):
            matrix[i, j] += mean * metric[j]
            matrix[j, i] += mean * metric[j]
    return matrix


@kernel
def solved(scatter: FloatArray, constraint: FloatArray, absolute: bool) -> FloatArray:
    """Return q (6,) of M q = t N q with the least positive t, or with the least |t|.

    The eigenvectors of M are scaled to q M q = 1, so that N's largest eigenvalue there is 1 / t.
    On exact data M is singular and its null vector outweighs all others, which is the solution.
    """
    values, vectors = np.linalg.eigh(scatter)
    floor = max(1e-18 * values[-1], 1e-60)  # two conics through all points leave no scatter
    for j in range(len(values)):
        vectors[:, j] /= math.sqrt(max(values[j], floor))
    inner = vectors.T.copy() @ constraint @ vectors
    inverse, directions = np.linalg.eigh(0.5 * (inner + inner.T))
    chosen = len(values) - 1
    if absolute and -inverse[0] > inverse[chosen]:
        chosen = 0
    solution: FloatArray = vectors @ directions[:, chosen].copy()
    return solution


@kernel
def _mixed_types(m: FloatArray, metric: FloatArray) -> FloatArray:
    """Return Harker's conic: of the pencil of the best ellipse and the best hyperbola.

    Both solve M q = t C q in the reduced space of A, B, C. In the pencil that they span the
    least Taubin distance is a problem of two unknowns. Where it is no ellipse's, the best
    ellipse is returned as it is.
    """
    matrix = reduced(m)
    values, vectors = np.linalg.eigh(matrix)
    for j in range(3):
        vectors[:, j] /= math.sqrt(max(values[j], 1e-18 * values[2]))
    inner = vectors.T.copy() @ ellipses_only()[:3, :3].copy() @ vectors
    _, directions = np.linalg.eigh(0.5 * (inner + inner.T))
    both = vectors @ directions
    span = np.zeros((6, 2))
    for k in range(2):
        q = both[:, 2 - 2 * k] / np.sqrt((both[:, 2 - 2 * k] ** 2).sum())
        span[:3, k] = q
        span[3, k] = -(q[0] * m[6] + q[1] * m[7] + q[2] * m[8])
        span[4, k] = -(q[0] * m[7] + q[1] * m[8] + q[2] * m[9])
        span[5, k] = -(q[0] + q[2])
    turned = span.T.copy()
    weights = solved(turned @ scatter_of(m) @ span, turned @ gradients_of(m, metric) @ span, False)
    conic = span @ weights
    if classified(conic[0], conic[1], conic[2], FLAT) == OK:
        return conic
    return span[:, 0].copy()


@kernel
def _level(scatter: FloatArray, mean: FloatArray) -> tuple[FloatArray, float]:
    """Return q, -1 of the least mean (q . monomials - 1)^2; or q, 0 where q is 0 at all points."""
    values, vectors = np.linalg.eigh(scatter)
    if values[0] <= 1e-15 * values[-1]:
        return vectors[:, 0].copy(), 0.0
    solution = np.zeros(len(mean))
    for k in range(len(mean)):
        share = 0.0
        for j in range(len(mean)):
            share += vectors[j, k] * mean[j]
        for j in range(len(mean)):
            solution[j] += vectors[j, k] * share / values[k]
    return solution, -1.0


@kernel
def _linear(m: FloatArray) -> FloatArray:
    """Return the conic that is nearest to 1 at all points, about the centre of a first such conic.

    The first is about the mean of the points. One without a centre is returned as it is.
    """
    conic, scatter = np.zeros(6), scatter_of(m)
    conic[:5], conic[5] = _level(scatter[:5, :5].copy(), scatter[5, :5].copy())
    a, b, c, d, f = conic[0], conic[1], conic[2], conic[3], conic[4]
    det = 4.0 * a * c - b * b
    if conic[5] == 0.0 or abs(det) <= FLAT * (a * a + b * b + c * c):
        return conic
    x, y = (b * f - 2.0 * c * d) / det, (b * d - 2.0 * a * f) / det
    about = scatter_of(shifted(m, x, y))
    conic[:3], conic[5] = _level(about[:3, :3].copy(), about[5, :3].copy())
    a, b, c = conic[0], conic[1], conic[2]
    conic[3], conic[4] = -(2.0 * a * x + b * y), -(b * x + 2.0 * c * y)
    conic[5] += a * x * x + b * x * y + c * y * y
    return conic


@kernel
def conic_of_moments(m: FloatArray, metric: FloatArray, method: int) -> FloatArray:
    """Return the conic (6,) that a method chooses for whitened moments (15,)."""
    if method == TAUBIN:
        return solved(scatter_of(m), gradients_of(m, metric), False)
    if method == HYPER:
        return solved(scatter_of(m), unbiased(m, metric), True)
    if method == HARKER:
        return _mixed_types(m, metric)
    if method == LINEAR:
        return _linear(m)
    return solved(scatter_of(m), ellipses_only(), False)


@kernel
def _along_axes(m: FloatArray) -> tuple[int, FloatArray]:
    """Return status and Chaudhuri's ellipse (5,) of centred moments.

    With X, Y along the principal axes, X^2 / a^2 + Y^2 / b^2 = 1 is linear in 1 / a^2, 1 / b^2.
    """
    xx, xy, yy = m[3], m[4], m[5]
    gap = math.hypot(xx - yy, 2.0 * xy)
    angle = 0.5 * math.atan2(2.0 * xy, xx - yy) if gap > 1e-12 * (xx + yy) else 0.0
    c, s = math.cos(angle), math.sin(angle)
    squares = np.array([[c * c, 2.0 * c * s, s * s], [s * s, -2.0 * c * s, c * c]])
    fourth, second = np.zeros((2, 2)), np.zeros(2)
    for i in range(2):
        for k in range(3):
            second[i] += squares[i, k] * m[3 + k]
            for j in range(2):
                for n in range(3):
                    fourth[i, j] += squares[i, k] * squares[j, n] * m[10 + k + n]
    det = fourth[0, 0] * fourth[1, 1] - fourth[0, 1] * fourth[1, 0]
    if not det > 1e-15 * fourth[0, 0] * fourth[1, 1]:
        return UNDETERMINED, np.full(5, np.nan)
    p = (fourth[1, 1] * second[0] - fourth[0, 1] * second[1]) / det
    q = (fourth[0, 0] * second[1] - fourth[0, 1] * second[0]) / det
    conic = np.zeros(6)
    for k in range(3):
        conic[k] = p * squares[0, k] + q * squares[1, k]
    conic[5] = -1.0
    return ellipse_of(conic)


@kernel
def _raw(m: FloatArray, x0: float, y0: float, scale: float) -> tuple[int, FloatArray]:
    """Return status and ellipse (5,) of Fitzgibbon's problem in plain image coordinates."""
    plain = shifted(m, -x0 / scale, -y0 / scale)
    for order in range(1, 5):
        for q in range(order + 1):
            plain[_FIRST[order] + q] *= scale**order
    return ellipse_of(solved(scatter_of(plain), ellipses_only(), False))


@kernel
def moved(ellipse: FloatArray, x0: float, y0: float, scale: float) -> FloatArray:
    """Return an ellipse (5,) of another unit and origin in image coordinates."""
    result = ellipse * scale
    result[0] += x0
    result[1] += y0
    result[4] = ellipse[4]
    return result


@kernel
def pencil_moments(
    moments: FloatArray, x0: float, y0: float, scale: float, method: int
) -> tuple[int, FloatArray, float]:
    """Fit an ellipse (5,) in image coordinates to moments about (x0, y0) in units of scale.

    Returns the status, the ellipse and the root mean square of its conic's value at the points.
    """
    nothing = np.full(5, np.nan)
    status, m, frame = whitened(moments)
    if status != OK:
        return status, nothing, np.nan
    if not determined(reduced(m)):
        return UNDETERMINED, nothing, np.nan
    if method == CHAUDHURI:
        mean = moments / moments[0]
        about = shifted(mean, mean[1], mean[2])
        status, ellipse = _along_axes(about)
        if status != OK:
            return status, nothing, np.nan
        conic = conic_of(ellipse)
        mean_square = float(conic @ scatter_of(about) @ conic)
        ellipse[0] += mean[1]
        ellipse[1] += mean[2]
        return OK, moved(ellipse, x0, y0, scale), math.sqrt(max(mean_square, 0.0))
    if method == RAW:
        status, ellipse = _raw(moments / moments[0], x0, y0, scale)
        if status != OK:
            return status, nothing, np.nan
        return OK, ellipse, np.nan
    conic = conic_of_moments(m, metric_of(frame), method)
    return from_conic(conic, m, frame, x0, y0, scale)


@kernel
def from_conic(
    conic: FloatArray, m: FloatArray, frame: FloatArray, x0: float, y0: float, scale: float
) -> tuple[int, FloatArray, float]:
    """Return status, ellipse (5,) in the image and residual of a conic in whitened coordinates."""
    kind = classified(conic[0], conic[1], conic[2], FLAT)
    if kind != OK:
        return kind, np.full(5, np.nan), np.nan
    status, ellipse, level = from_whitened(conic, frame)
    if status != OK:
        return status, ellipse, np.nan
    mean_square = float(conic @ scatter_of(m) @ conic) / (level * level)
    return OK, moved(ellipse, x0, y0, scale), math.sqrt(max(mean_square, 0.0))


@kernel
def pencil_points(
    points: FloatArray, weights: FloatArray, method: int
) -> tuple[int, FloatArray, float]:
    """Fit an ellipse (5,) to points (n, 2) with weights (n,) or (0,); status, ellipse, residual."""
    if few_distinct(points, weights):
        return FEW, np.full(5, np.nan), np.nan
    moments, x0, y0, scale = point_sums(points, weights)
    status, ellipse, residual = pencil_moments(moments, x0, y0, scale, method)
    if status == OK:
        if not np.isfinite(ellipse).all():
            return INFINITE, np.full(5, np.nan), np.nan
        residual = algebraic_residual(points, weights, ellipse)
    return status, ellipse, residual
