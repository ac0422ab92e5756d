"""Kernels of the two direct fits for speed: straight through the formulas, no array an arc.

The mathematics is that of `_kernels_fit`, the points stand in one flat array. One pass takes the
sums up to order 4 about a point of the arc's middle; moving them to the mean and whitening them
are written out.
"""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel, summing_kernel
from geoprim_core.fitting._kernels_fit import (
    COLLINEAR,
    FEW,
    FLAT,
    NSAF,
    OK,
    UNDETERMINED,
    algebraic_residual,
    classified,
    few_distinct,
    fit_points_of,
    placed,
)

_KNOWN = 1e-8  # mean square above which its rounding in the moments does not show
_BLOCK = 128  # points whose powers are summed at a time
ROOM = 15 + 2 * _BLOCK  # numbers that a fit needs to work in


@kernel
def _middle_of(points: FloatArray) -> tuple[float, float]:
    """Return an origin amid the points, from three of them: far from it powers lose digits."""
    first, middle, last = points[0], points[len(points) // 2], points[-1]
    return (first[0] + middle[0] + last[0]) / 3.0, (first[1] + middle[1] + last[1]) / 3.0


@summing_kernel
def _mean_powers(points: FloatArray, x0: float, y0: float, mean: FloatArray) -> None:
    """Write the means of u^p v^q to (15,), in the order of `_kernels_moments`.

    The points are taken apart into columns, a block at a time, behind the means in `mean`
    (ROOM,): side by side in memory, coordinates fill the lanes of a processor.
    """
    s1, s2, s3, s4, s5, s6, s7 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    s8, s9, s10, s11, s12, s13, s14 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    x, y = mean[15 : 15 + _BLOCK], mean[15 + _BLOCK :]
    for start in range(0, len(points), _BLOCK):
        count = min(_BLOCK, len(points) - start)
        for i in range(count):
            x[i], y[i] = points[start + i, 0] - x0, points[start + i, 1] - y0
        for i in range(count):
            u, v = x[i], y[i]
            uu, uv, vv = u * u, u * v, v * v
            s1 += u
            s2 += v
            s3 += uu
            s4 += uv
            s5 += vv
            s6 += uu * u
            s7 += uu * v
            s8 += u * vv
            s9 += vv * v
            s10 += uu * uu
            s11 += uu * uv
            s12 += uu * vv
            s13 += uv * vv
            s14 += vv * vv
    share = 1.0 / len(points)
    mean[0], mean[1], mean[2], mean[3], mean[4] = (
        1.0,
        s1 * share,
        s2 * share,
        s3 * share,
        s4 * share,
    )
    mean[5], mean[6], mean[7], mean[8], mean[9] = (
        s5 * share, s6 * share, s7 * share, s8 * share, s9 * share,
    )  # fmt: skip
    mean[10], mean[11], mean[12] = s10 * share, s11 * share, s12 * share
    mean[13], mean[14] = s13 * share, s14 * share


@kernel
def _centre(m: FloatArray) -> None:
    """Move mean powers (15,) to their mean; orders 0 and 1 are left as they are."""
    a, b = m[1], m[2]
    xx, xy, yy = m[3], m[4], m[5]
    xxx, xxy, xyy, yyy = m[6], m[7], m[8], m[9]
    aa, ab, bb = a * a, a * b, b * b
    m[3], m[4], m[5] = xx - aa, xy - ab, yy - bb
    m[6] = xxx - 3.0 * a * xx + 2.0 * a * aa
    m[7] = xxy - 2.0 * a * xy - b * xx + 2.0 * aa * b
    m[8] = xyy - 2.0 * b * xy - a * yy + 2.0 * a * bb
    m[9] = yyy - 3.0 * b * yy + 2.0 * b * bb
    m[10] += 6.0 * aa * xx - 4.0 * a * xxx - 3.0 * aa * aa
    m[11] += 3.0 * (aa * xy + ab * xx - aa * ab - a * xxy) - b * xxx
    m[12] += aa * yy + 4.0 * ab * xy + bb * xx - 2.0 * (a * xyy + b * xxy) - 3.0 * aa * bb
    m[13] += 3.0 * (bb * xy + ab * yy - ab * bb - b * xyy) - a * yyy
    m[14] += 6.0 * bb * yy - 4.0 * b * yyy - 3.0 * bb * bb


@kernel
def _whiten(m: FloatArray, alpha: float, beta: float, gamma: float) -> None:
    """Map central moments of order 3 and 4 by u' = alpha u, v' = beta u + gamma v."""
    x, y, z, w = m[6], m[7], m[8], m[9]
    bb, bg, gg = beta * beta, beta * gamma, gamma * gamma
    aa = alpha * alpha
    m[6], m[7] = aa * alpha * x, aa * (beta * x + gamma * y)
    m[8] = alpha * (bb * x + 2.0 * bg * y + gg * z)
    m[9] = beta * (bb * x + 3.0 * bg * y + 3.0 * gg * z) + gg * gamma * w
    p, q, r, s, t = m[10], m[11], m[12], m[13], m[14]
    m[10], m[11] = aa * aa * p, aa * alpha * (beta * p + gamma * q)
    m[12] = aa * (bb * p + 2.0 * bg * q + gg * r)
    m[13] = alpha * (beta * (bb * p + 3.0 * bg * q + 3.0 * gg * r) + gg * gamma * s)
    m[14] = bb * (bb * p + 4.0 * bg * q + 6.0 * gg * r) + gg * (4.0 * bg * s + gg * t)


@kernel
def _largest_root(m00: float, m01: float, m02: float, m11: float, m12: float, m22: float) -> float:
    """Return the largest t of M q = t Z q, see `_kernels_fit._direct`.

    Where an ellipse fits well it is near 0, where the cubic falls: Laguerre's steps start there,
    else above it, at the value of a circle. All roots are real: the steps do not pass it.
    """
    c0 = 0.25 * (
        m00 * (m11 * m22 - m12 * m12)
        - m01 * (m01 * m22 - m12 * m02)
        + m02 * (m01 * m12 - m11 * m02)
    )
    c1 = m02 * m11 - m01 * m12 + 0.25 * (m00 * m22 - m02 * m02)
    c2 = m02 - m11
    t = 0.0 if c1 < 0.0 else 0.25 * (m00 + m22 + 2.0 * m02)
    for _ in range(40):
        value = c0 + t * (c1 + t * (c2 - t))
        first = c1 + t * (2.0 * c2 - 3.0 * t)
        second = 2.0 * c2 - 6.0 * t
        below = first - math.sqrt(max(0.0, 4.0 * first * first - 6.0 * value * second))
        if below == 0.0:
            break
        step = 3.0 * value / below
        t -= step
        if abs(step) <= 1e-6 * (m00 + m22):  # the next one would be its cube
            break
    return t


@kernel
def _direct(
    m00: float, m01: float, m02: float, m11: float, m12: float, m22: float
) -> tuple[float, float, float]:
    """Return A, B, C of the least q M q under 4 A C - B^2 = 1: the null vector of M - t Z."""
    t = _largest_root(m00, m01, m02, m11, m12, m22)
    m02 -= 2.0 * t
    m11 += t
    # The largest of the cross products of two rows.
    a1, b1, c1 = m01 * m12 - m02 * m11, m02 * m01 - m00 * m12, m00 * m11 - m01 * m01
    a2, b2, c2 = m11 * m22 - m12 * m12, m12 * m02 - m01 * m22, m01 * m12 - m11 * m02
    a3, b3, c3 = m12 * m02 - m22 * m01, m22 * m00 - m02 * m02, m02 * m01 - m12 * m00
    s1, s2 = a1 * a1 + b1 * b1 + c1 * c1, a2 * a2 + b2 * b2 + c2 * c2
    s3 = a3 * a3 + b3 * b3 + c3 * c3
    if s2 > s1 and s2 >= s3:
        return a2, b2, c2
    if s3 > s1:
        return a3, b3, c3
    return a1, b1, c1


@kernel
def _fixed(
    m00: float, m01: float, m02: float, m11: float, m12: float
) -> tuple[float, float, float]:
    """Return A, B, C of the least q M q under C = 1 (ElliFit)."""
    det = m00 * m11 - m01 * m01
    if not det > 1e-15 * m00 * m11:
        return 0.0, 0.0, 0.0
    return (m01 * m12 - m11 * m02) / det, (m01 * m02 - m00 * m12) / det, 1.0


@kernel
def _five_differ(points: FloatArray) -> bool:
    """Tell whether the first five points are distinct, as they mostly are."""
    if len(points) < 5:
        return False
    for i in range(5):
        for j in range(i):
            if points[i, 0] == points[j, 0] and points[i, 1] == points[j, 1]:
                return False
    return True


@kernel
def fit_arc(
    points: FloatArray, method: int, m: FloatArray, ellipse: FloatArray
) -> tuple[int, float]:
    """Fit an ellipse to points (n, 2); return status and residual, write the ellipse (5,).

    `m` (ROOM,) is room to work in. Without a fit the ellipse's five numbers are without meaning.
    """
    if not _five_differ(points) and few_distinct(points, np.zeros(0)):
        return FEW, np.nan
    x0, y0 = _middle_of(points)
    _mean_powers(points, x0, y0, m)
    _centre(m)
    xx, xy, yy = m[3], m[4], m[5]
    rest = yy - xy * xy / xx if xx > 0.0 else 0.0
    if not xx * rest > 1e-13 * (xx + yy) ** 2:
        return COLLINEAR, np.nan
    alpha, gamma = 1.0 / math.sqrt(xx), 1.0 / math.sqrt(rest)
    beta = -gamma * xy / xx
    _whiten(m, alpha, beta, gamma)
    m00 = m[10] - m[6] * m[6] - m[7] * m[7] - 1.0
    m01 = m[11] - m[6] * m[7] - m[7] * m[8]
    m02 = m[12] - m[6] * m[8] - m[7] * m[9] - 1.0
    m11 = m[12] - m[7] * m[7] - m[8] * m[8]
    m12 = m[13] - m[7] * m[8] - m[8] * m[9]
    m22 = m[14] - m[8] * m[8] - m[9] * m[9] - 1.0
    trace = m00 + m11 + m22
    minors = m00 * m11 - m01 * m01 + m00 * m22 - m02 * m02 + m11 * m22 - m12 * m12
    if not minors > 1e-13 * trace * trace:
        return UNDETERMINED, np.nan
    if method == NSAF:
        a, b, c = _direct(m00, m01, m02, m11, m12, m22)
    else:
        a, b, c = _fixed(m00, m01, m02, m11, m12)
    kind = classified(a, b, c, FLAT)
    if kind != OK:
        return kind, np.nan
    d, f = -(a * m[6] + b * m[7] + c * m[8]), -(a * m[7] + b * m[8] + c * m[9])
    status, level = placed(
        a, b, c, d, f, -(a + c), x0 + m[1], y0 + m[2], alpha, beta, gamma, ellipse,
    )  # fmt: skip
    if status != OK:
        return status, np.nan
    square = a * a * m00 + b * b * m11 + c * c * m22
    square += 2.0 * (a * b * m01 + a * c * m02 + b * c * m12)
    square /= level * level
    if square > _KNOWN:
        return OK, math.sqrt(square)
    return OK, algebraic_residual(points, np.zeros(0), ellipse)


@kernel
def fit_arcs(
    points: FloatArray,
    offsets: IntArray,
    method: int,
    status: IntArray,
    ellipses: FloatArray,
    residual: FloatArray,
) -> None:
    """Fit an ellipse to every arc: status (k,), ellipse (k, 5), residual (k,)."""
    m = np.empty(ROOM)
    for k in range(len(offsets) - 1):
        arc = points[offsets[k] : offsets[k + 1]]
        status[k], residual[k] = fit_arc(arc, method, m, ellipses[k])


@kernel
def fit_curve(
    points: FloatArray, weights: FloatArray, method: int
) -> tuple[int, FloatArray, float]:
    """Fit an ellipse (5,) to points (n, 2) with weights (n,) or (0,); status, ellipse, residual."""
    if len(weights):
        return fit_points_of(points, weights, method)
    ellipse = np.empty(5)
    status, residual = fit_arc(points, method, np.empty(ROOM), ellipse)
    return status, ellipse, residual
