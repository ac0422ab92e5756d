"""Kernels of the algebraic fits, which see the points only through moments up to order 4.

A fit moves the moments to the mean of the points and whitens them by a triangular map (mean 0,
variances 1, covariance 0). There the linear and constant part of the best conic
A u^2 + B u v + C v^2 + D u + F v + G follow from A, B, C, and what is left is a 3 x 3 matrix M
whose quadratic form is the mean square residual. Both methods minimise it, under different
constraints. The map leaves y^2 the only source of v^2, so ElliFit's constraint stays C = const.
"""

from __future__ import annotations

import math
from typing import cast

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel
from geoprim_core.fitting._kernels_moments import (
    add_moments,
    add_weighted_moments,
    mapped,
    shifted,
)

OK, FEW, COLLINEAR, UNDETERMINED, HYPERBOLA, PARABOLA, IMAGINARY, INFINITE = range(8)
# Typed: numba may compile a kernel anew for a literal number.
NSAF, ELLIFIT = cast(int, np.int64(0)), cast(int, np.int64(1))

# Whitened conics flatter than this are parabolae: an arc of a circle is from 0.03 degrees on.
FLAT = 1e-6


@kernel
def reduced(m: FloatArray) -> FloatArray:
    """Return the matrix M (3, 3) of whitened, mean moments: covariance of uu, uv, vv given u, v."""
    matrix = np.empty((3, 3))
    mean = (1.0, 0.0, 1.0)
    for i in range(3):
        for j in range(3):
            along_u = m[6 + i] * m[6 + j]
            along_v = m[7 + i] * m[7 + j]
            matrix[i, j] = m[10 + i + j] - along_u - along_v - mean[i] * mean[j]
    return matrix


@kernel
def _rank_two_null(matrix: FloatArray) -> FloatArray:
    """Return the null vector of a symmetric 3 x 3 matrix of rank two (zero for lower rank)."""
    best = np.zeros(3)
    largest = 0.0
    for i in range(3):
        p, q = matrix[i], matrix[(i + 1) % 3]
        cross = np.array(
            [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
        )
        size = cross[0] ** 2 + cross[1] ** 2 + cross[2] ** 2
        if size > largest:
            best, largest = cross / math.sqrt(size), size
    return best


@kernel
def _direct(m: FloatArray) -> FloatArray:
    """Minimise q M q under 4 A C - B^2 = 1 (Fitzgibbon's constraint, partitioned as by Halir).

    M q = t Z q with Z = [[0, 0, 2], [0, -1, 0], [2, 0, 0]] has three real roots, of which the
    largest belongs to the ellipse. Laguerre's iteration finds it from above, starting at the
    value of a circle, for det(M - t Z) / 4 = c0 + c1 t + c2 t^2 - t^3. On exact data it is 0.
    """
    c0 = 0.25 * (
        m[0, 0] * (m[1, 1] * m[2, 2] - m[1, 2] * m[1, 2])
        - m[0, 1] * (m[0, 1] * m[2, 2] - m[1, 2] * m[0, 2])
        + m[0, 2] * (m[0, 1] * m[1, 2] - m[1, 1] * m[0, 2])
    )
    c1 = m[0, 2] * m[1, 1] - m[0, 1] * m[1, 2] + 0.25 * (m[0, 0] * m[2, 2] - m[0, 2] ** 2)
    c2 = m[0, 2] - m[1, 1]
    t = 0.25 * (m[0, 0] + m[2, 2] + 2.0 * m[0, 2])
    for _ in range(40):
        value = c0 + t * (c1 + t * (c2 - t))
        first = c1 + t * (2.0 * c2 - 3.0 * t)
        second = 2.0 * c2 - 6.0 * t
        root = math.sqrt(max(0.0, 4.0 * first * first - 6.0 * value * second))
        below = first - root  # of the falling branch, to the right of the largest root
        if value >= 0.0 or below == 0.0:
            break
        step = 3.0 * value / below
        t -= step
        if step <= 1e-17 * (m[0, 0] + m[2, 2]):
            break
    shifted_matrix = m.copy()
    shifted_matrix[0, 2] -= 2.0 * t
    shifted_matrix[2, 0] -= 2.0 * t
    shifted_matrix[1, 1] += t
    return _rank_two_null(shifted_matrix)


@kernel
def _fixed(m: FloatArray) -> FloatArray:
    """Minimise q M q under C = 1 (ElliFit)."""
    det = m[0, 0] * m[1, 1] - m[0, 1] * m[0, 1]
    if not det > 1e-15 * m[0, 0] * m[1, 1]:
        return np.zeros(3)
    return np.array(
        [
            (m[0, 1] * m[1, 2] - m[1, 1] * m[0, 2]) / det,
            (m[0, 1] * m[0, 2] - m[0, 0] * m[1, 2]) / det,
            1.0,
        ]
    )


@kernel
def determined(m: FloatArray) -> bool:
    """Tell whether M leaves at most one conic free, so that its rank is two or three."""
    trace = m[0, 0] + m[1, 1] + m[2, 2]
    minors = (m[0, 0] * m[1, 1] - m[0, 1] ** 2 + m[0, 0] * m[2, 2] - m[0, 2] ** 2) + (
        m[1, 1] * m[2, 2] - m[1, 2] ** 2
    )
    return bool(minors > 1e-13 * trace * trace)


@kernel
def axes_of(p11: float, p12: float, p21: float, p22: float) -> tuple[float, float, float]:
    """Return semi_major, semi_minor, angle of the unit circle's image under a 2 x 2 matrix."""
    total = p11 * p11 + p12 * p12 + p21 * p21 + p22 * p22
    even = p11 * p11 + p12 * p12 - p21 * p21 - p22 * p22
    odd = 2.0 * (p11 * p21 + p12 * p22)
    gap = math.sqrt(even * even + odd * odd)
    semi_major = math.sqrt(0.5 * (total + gap))
    semi_minor = min(abs(p11 * p22 - p12 * p21) / semi_major, semi_major)
    if gap <= 1e-12 * total:
        return semi_major, semi_minor, 0.0
    angle = 0.5 * math.atan2(odd, even) + 0.0  # no negative zero
    if angle < 0.0:
        angle += math.pi
    return semi_major, semi_minor, angle if angle < math.pi else 0.0


@kernel
def classified(a: float, b: float, c: float, flat: float) -> int:
    """Return the kind of the quadratic part: OK for an ellipse, HYPERBOLA or PARABOLA."""
    det = 4.0 * a * c - b * b
    size = (a + c) ** 2 + (a - c) ** 2 + b * b
    if abs(det) <= flat * size or size == 0.0:
        return PARABOLA
    return OK if det > 0.0 else HYPERBOLA


@kernel
def whitened(moments: FloatArray) -> tuple[int, FloatArray, FloatArray]:
    """Return status, moments (15,) with mean 0 and covariance 1, and the map (5,) to there.

    The map is u = alpha (x - x0), v = beta (x - x0) + gamma (y - y0); the five are x0, y0,
    alpha, beta, gamma.
    """
    frame = np.zeros(5)
    if not moments[0] >= 5.0:
        return FEW, moments, frame
    mean = moments / moments[0]
    x0, y0 = mean[1], mean[2]
    centred = shifted(mean, x0, y0)
    xx, xy, yy = centred[3], centred[4], centred[5]
    rest = yy - xy * xy / xx if xx > 0.0 else 0.0
    if not xx * rest > 1e-13 * (xx + yy) ** 2:
        return COLLINEAR, moments, frame
    alpha, gamma = 1.0 / math.sqrt(xx), 1.0 / math.sqrt(rest)
    beta = -gamma * xy / xx
    frame[0], frame[1], frame[2], frame[3], frame[4] = x0, y0, alpha, beta, gamma
    return OK, mapped(centred, alpha, beta, gamma), frame


@kernel
def fit_moments_of(moments: FloatArray, method: int) -> tuple[int, FloatArray, float]:
    """Fit an ellipse to points known by their moments.

    Returns the status, the ellipse (5,) in the unit and about the origin of the moments, and
    the root mean square of the conic's value, scaled to -1 at its centre (NaN without a fit).
    """
    status, m, frame = whitened(moments)
    if status != OK:
        return status, np.full(5, np.nan), np.nan
    matrix = reduced(m)
    if not determined(matrix):
        return UNDETERMINED, np.full(5, np.nan), np.nan
    q = _direct(matrix) if method == NSAF else _fixed(matrix)
    a, b, c = q[0], q[1], q[2]
    kind = classified(a, b, c, FLAT)
    if kind != OK:
        return kind, np.full(5, np.nan), np.nan
    d = -(a * m[6] + b * m[7] + c * m[8])
    f = -(a * m[7] + b * m[8] + c * m[9])
    status, ellipse, level = from_whitened(np.array([a, b, c, d, f, -(a + c)]), frame)
    if status != OK:
        return status, ellipse, np.nan
    a, b, c = a / level, b / level, c / level
    mean_square = (
        a * a * matrix[0, 0]
        + b * b * matrix[1, 1]
        + c * c * matrix[2, 2]
        + 2.0 * (a * b * matrix[0, 1] + a * c * matrix[0, 2] + b * c * matrix[1, 2])
    )
    return OK, ellipse, math.sqrt(max(mean_square, 0.0))


@kernel
def from_whitened(conic: FloatArray, frame: FloatArray) -> tuple[int, FloatArray, float]:
    """Return status, ellipse (5,) and minus the value at the centre of a conic (6,).

    The conic is an ellipse's in the coordinates of `frame`, as `whitened` gives it.
    """
    ellipse = np.full(5, np.nan)
    a, b, c, d, f, g = conic
    x0, y0, alpha, beta, gamma = frame
    status, level = placed(a, b, c, d, f, g, x0, y0, alpha, beta, gamma, ellipse)
    if status != OK:
        ellipse[:] = np.nan
    return status, ellipse, level


@kernel
def placed(
    a: float, b: float, c: float, d: float, f: float, g: float,
    x0: float, y0: float, alpha: float, beta: float, gamma: float, ellipse: FloatArray,
) -> tuple[int, float]:  # fmt: skip
    """Write the ellipse (5,) of a whitened conic; return status and minus the centre's value."""
    det = 4.0 * a * c - b * b
    u, v = (b * f - 2.0 * c * d) / det, (b * d - 2.0 * a * f) / det
    level = -g - 0.5 * (d * u + f * v)  # minus the value at the centre: K of errata E1
    if not level / (a + c) > 0.0:
        return IMAGINARY, level
    a, b, c = a / level, b / level, c / level
    # Cholesky factor of the quadratic form: its inverse maps the unit circle to the ellipse.
    r11 = math.sqrt(a)
    r12 = 0.5 * b / r11
    r22 = math.sqrt(det) / (2.0 * abs(level) * r11)
    i11, i12, i22 = 1.0 / r11, -r12 / (r11 * r22), 1.0 / r22
    # Inverse of the whitening map: x = u / alpha, y = (v - beta x) / gamma.
    back = -beta / (alpha * gamma)
    ellipse[0], ellipse[1] = x0 + u / alpha, y0 + back * u + v / gamma
    ellipse[2], ellipse[3], ellipse[4] = axes_of(
        i11 / alpha, i12 / alpha, back * i11, back * i12 + i22 / gamma
    )
    size = abs(ellipse[0]) + abs(ellipse[1]) + ellipse[2] + ellipse[4]
    return (OK if ellipse[3] > 0.0 and math.isfinite(size) else INFINITE), level


@kernel
def fit_group(
    moments: FloatArray, x0: float, y0: float, scale: float, method: int
) -> tuple[int, FloatArray, float]:
    """Fit an ellipse (5,) in image coordinates to moments about (x0, y0) in units of scale."""
    status, ellipse, residual = fit_moments_of(moments, method)
    if status == OK:
        ellipse[0] = x0 + scale * ellipse[0]
        ellipse[1] = y0 + scale * ellipse[1]
        ellipse[2] *= scale
        ellipse[3] *= scale
    return status, ellipse, residual


@kernel
def algebraic_residual(points: FloatArray, weights: FloatArray, ellipse: FloatArray) -> float:
    """Return the (weighted) root mean square of the conic's value, scaled to -1 at the centre."""
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    plain = len(weights) == 0
    total, count = 0.0, 0.0
    for i in range(len(points)):
        dx, dy = points[i, 0] - ellipse[0], points[i, 1] - ellipse[1]
        u, v = (cos * dx + sin * dy) / ellipse[2], (cos * dy - sin * dx) / ellipse[3]
        value = (u - 1.0) * (u + 1.0) + v * v
        weight = 1.0 if plain else weights[i]
        total += weight * value * value
        count += weight
    return math.sqrt(total / count)


@kernel
def few_distinct(points: FloatArray, weights: FloatArray) -> bool:
    """Tell whether fewer than five different points have a weight."""
    seen = np.empty(5, np.int64)
    count = 0
    for i in range(len(points)):
        new = len(weights) == 0 or weights[i] > 0.0
        for j in range(count):
            if points[i, 0] == points[seen[j], 0] and points[i, 1] == points[seen[j], 1]:
                new = False
        if new:
            seen[count] = i
            count += 1
            if count == 5:
                return False
    return True


@kernel
def point_sums(points: FloatArray, weights: FloatArray) -> tuple[FloatArray, float, float, float]:
    """Return the moments (15,) of points (n, 2), at least five distinct, and their x0, y0, scale.

    The origin is the mean and the scale the root mean square distance from it. Weights (n,),
    or none for one each, count on the average of the points that have any.
    """
    moments = np.zeros(15)
    total = 0.0
    if len(weights) == 0:
        x0, y0 = 0.0, 0.0
        for i in range(len(points)):
            x0 += points[i, 0]
            y0 += points[i, 1]
        x0, y0 = x0 / len(points), y0 / len(points)
        for i in range(len(points)):
            total += (points[i, 0] - x0) ** 2 + (points[i, 1] - y0) ** 2
        scale = math.sqrt(total / len(points))
        add_moments(points, x0, y0, scale, moments)
        return moments, x0, y0, scale
    used = 0.0
    for i in range(len(weights)):
        used += 1.0 if weights[i] > 0.0 else 0.0
    even = weights * (used / weights.sum())
    x0, y0 = (even * points[:, 0]).sum() / used, (even * points[:, 1]).sum() / used
    for i in range(len(points)):
        total += even[i] * ((points[i, 0] - x0) ** 2 + (points[i, 1] - y0) ** 2)
    scale = math.sqrt(total / used)
    add_weighted_moments(points, even, x0, y0, scale, moments)
    # The sum may fall short of the number by rounding.
    moments[0] = used
    return moments, x0, y0, scale


@kernel
def fit_points_of(
    points: FloatArray, weights: FloatArray, method: int
) -> tuple[int, FloatArray, float]:
    """Fit an ellipse (5,) in image coordinates to points (n, 2); status, ellipse, residual.

    Weights are (n,), or none (0,) for one each.
    """
    if few_distinct(points, weights):
        return FEW, np.full(5, np.nan), np.nan
    moments, x0, y0, scale = point_sums(points, weights)
    status, ellipse, residual = fit_group(moments, x0, y0, scale, method)
    if status == OK:
        residual = algebraic_residual(points, weights, ellipse)
    return status, ellipse, residual
