"""Kernel for the covariance of an algebraic fit by propagation of the points' scatter.

To first order a conic's value at a point is its distance times the gradient's length g, so that
an algebraic fit is a weighted geometric one, of weights g^2, whatever its constraint. With J the
derivatives of the distances by the five parameters, A = sum g^2 J J' and B = sum g^4 J J', the
covariance is s^2 A^-1 B A^-1.
"""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel
from geoprim_core.fitting._kernels_distance import foot_of

_EVEN = math.pi**2 / 12.0  # variance of a direction of which nothing is known


@kernel
def _row_of(u: float, v: float, ellipse: FloatArray, row: FloatArray) -> tuple[float, float]:
    """Write a distance's derivatives by the parameters (5,); return it and the conic's gradient.

    (u, v) is the point in the frame of the axes.
    """
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    major, minor = ellipse[2], ellipse[3]
    fu, fv = foot_of(abs(u), abs(v), major, minor)
    fu, fv = math.copysign(fu, u), math.copysign(fv, v)
    nu, nv = fu / (major * major), fv / (minor * minor)
    size = math.hypot(nu, nv)
    nu, nv = nu / size, nv / size
    row[0], row[1] = cos * nu - sin * nv, sin * nu + cos * nv
    row[2], row[3], row[4] = nu * fu / major, nv * fv / minor, nv * fu - nu * fv
    return nu * (u - fu) + nv * (v - fv), 2.0 * size


@kernel
def algebraic_covariance(
    points: FloatArray, weights: FloatArray, ellipse: FloatArray
) -> FloatArray:
    """Return the covariance (5, 5) of x, y, semi_major, semi_minor, angle; NaN if unknown.

    The points' variance comes from their orthogonal distances, divided by the freedom that the
    fit leaves them: n - 10 + tr(A^-1 C A^-1 B), C = sum J J'.
    """
    plain, a, b = np.zeros((5, 5)), np.zeros((5, 5)), np.zeros((5, 5))
    row = np.empty(5)
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    unit = ellipse[3] * ellipse[3]  # keeps the gradients' fourth powers near 1
    squares, total, used = 0.0, 0.0, 0
    for i in range(len(points)):
        weight = weights[i] if len(weights) else 1.0
        dx, dy = points[i, 0] - ellipse[0], points[i, 1] - ellipse[1]
        distance, gradient = _row_of(cos * dx + sin * dy, cos * dy - sin * dx, ellipse, row)
        share = gradient * gradient * unit
        squares += weight * distance * distance
        total += weight
        used += 1 if weight > 0.0 else 0
        for j in range(5):
            for k in range(5):
                product = weight * row[j] * row[k]
                plain[j, k] += product
                a[j, k] += share * product
                b[j, k] += share * share * product
    if used <= 5:
        return np.full((5, 5), np.nan)
    size = np.sqrt(np.diag(a)) + 1e-300
    scale = np.outer(size, size)
    inverse = np.linalg.inv(a / scale + 1e-14 * np.eye(5)) / scale
    trace = np.trace(inverse @ plain @ inverse @ b)
    freedom = total * (1.0 - (10.0 - trace) / used)
    covariance = inverse @ b @ inverse * (squares / max(freedom, 1e-3 * total))
    if covariance[4, 4] > _EVEN:
        factor = math.sqrt(_EVEN / covariance[4, 4])
        covariance[4, :] *= factor
        covariance[:, 4] *= factor
    symmetric: FloatArray = 0.5 * (covariance + covariance.T)
    return symmetric
