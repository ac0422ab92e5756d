"""Fitting kernels of the `refined` scheme: additive moments, direct fit, orthogonal refit.

The moments of a point set are the 25 numbers sum(x^p y^q) at [5 p + q], of which those with
p + q <= 4 are used.
"""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc._kernels_refined_conic import direct_conic, ellipse_of_conic

TUKEY = 4.685  # 95 % efficiency on normal errors
MAD = 1.4826


@inner_kernel
def add_point(moments: FloatArray, x: float, y: float) -> None:
    """Add one point to a set of moments in place."""
    px = 1.0
    for p in range(5):
        value = px
        for q in range(5 - p):
            moments[5 * p + q] += value
            value *= y
        px *= x


@kernel
def shifted_sums(
    m0: float, m1: float, m2: float, m3: float, m4: float, d: float
) -> tuple[float, float, float, float, float]:
    """Return sums of (x + d)^p, p = 0 .. 4, from those of x^p.

    Scalars, here and in `fit_moments`: they run for each pair of arcs, an array costs as much as
    the sums.
    """
    d2 = d * d
    d3 = d2 * d
    d4 = d3 * d
    s1 = d * m0 + m1
    s2 = d2 * m0 + 2.0 * d * m1 + m2
    s3 = d3 * m0 + 3.0 * d2 * m1 + 3.0 * d * m2 + m3
    s4 = d4 * m0 + 4.0 * d3 * m1 + 6.0 * d2 * m2 + 4.0 * d * m3 + m4
    return m0, s1, s2, s3, s4


@inner_kernel
def add_shifted(total: FloatArray, moments: FloatArray, dx: float, dy: float, scale: float) -> None:
    """Add to `total` the moments of the same points moved by (dx, dy), then scaled."""
    m = moments
    h00, h10, h20, h30, h40 = shifted_sums(m[0], m[5], m[10], m[15], m[20], dx)
    h01, h11, h21, h31, _ = shifted_sums(m[1], m[6], m[11], m[16], 0.0, dx)
    h02, h12, h22, _, _ = shifted_sums(m[2], m[7], m[12], 0.0, 0.0, dx)
    h03, h13, _, _, _ = shifted_sums(m[3], m[8], 0.0, 0.0, 0.0, dx)
    _, t01, t02, t03, t04 = shifted_sums(h00, h01, h02, h03, m[4], dy)
    _, t11, t12, t13, _ = shifted_sums(h10, h11, h12, h13, 0.0, dy)
    _, t21, t22, _, _ = shifted_sums(h20, h21, h22, 0.0, 0.0, dy)
    _, t31, _, _, _ = shifted_sums(h30, h31, 0.0, 0.0, 0.0, dy)
    square = scale * scale
    cube = square * scale
    fourth = cube * scale
    total[0] += h00
    total[1] += t01 * scale
    total[2] += t02 * square
    total[3] += t03 * cube
    total[4] += t04 * fourth
    total[5] += h10 * scale
    total[6] += t11 * square
    total[7] += t12 * cube
    total[8] += t13 * fourth
    total[10] += h20 * square
    total[11] += t21 * cube
    total[12] += t22 * fourth
    total[15] += h30 * cube
    total[16] += t31 * fourth
    total[20] += h40 * fourth


@inner_kernel
def fit_moments(m: FloatArray, x0: float, y0: float, scale: float, out: FloatArray) -> bool:
    """Fit an ellipse to moments taken of ((x, y) - (x0, y0)) * scale; False if there is none."""
    a, b, c, d, e, f = direct_conic(
        m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], m[10], m[11], m[12], m[15], m[16],
        m[20],
    )  # fmt: skip
    if not ellipse_of_conic(a, b, c, d, e, f, out):
        return False
    out[0] = out[0] / scale + x0
    out[1] = out[1] / scale + y0
    out[2] /= scale
    out[3] /= scale
    return True


@kernel
def offset_at(
    dx: float, dy: float, cos: float, sin: float, flat: float, steep: float
) -> tuple[float, float, float]:
    """Return what `offset_of` does, (dx, dy) from the centre; 1 / a^2 and 1 / b^2 are given."""
    u = dx * cos + dy * sin
    v = dy * cos - dx * sin
    gu = u * flat
    gv = v * steep
    inverse = 1.0 / (math.sqrt(gu * gu + gv * gv) + 1e-300)
    distance = 0.5 * (u * gu + v * gv - 1.0) * inverse
    gu *= inverse
    gv *= inverse
    return distance, gu * cos - gv * sin, gu * sin + gv * cos


@inner_kernel
def offset_of(
    ellipse: FloatArray, cos: float, sin: float, x: float, y: float
) -> tuple[float, float, float]:
    """Return the signed distance of a point (Sampson) and the outward unit normal there."""
    flat, steep = 1.0 / (ellipse[2] * ellipse[2]), 1.0 / (ellipse[3] * ellipse[3])
    return offset_at(x - ellipse[0], y - ellipse[1], cos, sin, flat, steep)


@inner_kernel
def solve5(matrix: FloatArray, vector: FloatArray) -> bool:
    """Solve a symmetric positive definite 5x5 system in place by Cholesky; False if singular."""
    for i in range(5):
        for j in range(i + 1):
            value = matrix[i, j]
            for k in range(j):
                value -= matrix[i, k] * matrix[j, k]
            if i == j:
                if not value > 1e-12:
                    return False
                matrix[i, i] = math.sqrt(value)
            else:
                matrix[i, j] = value / matrix[j, j]
    for i in range(5):
        for k in range(i):
            vector[i] -= matrix[i, k] * vector[k]
        vector[i] /= matrix[i, i]
    for i in range(4, -1, -1):
        for k in range(i + 1, 5):
            vector[i] -= matrix[k, i] * vector[k]
        vector[i] /= matrix[i, i]
    return True


@kernel
def refit(
    points: FloatArray, chosen: IntArray, count: int, ellipse: FloatArray, steps: int, width: float
) -> bool:
    """Improve an ellipse in place: reweighted least squares on the Sampson distance.

    In the frame where the ellipse is the unit circle the conic has five free coefficients; the
    weights are Tukey's with the given width in pixels over the squared gradient. Returns False,
    the ellipse unchanged, when a step fails.
    """
    current = ellipse.copy()
    normal = np.empty((5, 5))
    right = np.empty(5)
    row = np.empty(5)
    for _ in range(steps):
        cos, sin = math.cos(current[4]), math.sin(current[4])
        x0, y0, a, b = current[0], current[1], current[2], current[3]
        ia, ib = 1.0 / a, 1.0 / b
        narrow, common = 1.0 / (width * width), 1.0 / (a * b)
        m40 = m31 = m22 = m13 = m04 = m30 = m21 = m12 = m03 = m20 = m11 = m02 = 0.0
        r0 = r1 = r2 = r3 = r4 = 0.0
        for k in range(count):  # scalars: an array is read and written for each point
            dx, dy = points[chosen[k], 0] - x0, points[chosen[k], 1] - y0
            u, v = (dx * cos + dy * sin) * ia, (dy * cos - dx * sin) * ib
            uu, uv, vv = u * u, u * v, v * v
            inverse = 1.0 / (4.0 * (uu * ia * ia + vv * ib * ib) + 1e-300)
            f = uu + vv - 1.0
            ratio = f * f * inverse * narrow
            if ratio >= 1.0:
                continue
            weight = (1.0 - ratio) * (1.0 - ratio) * inverse * common
            wuu, wuv, wvv, wf = weight * uu, weight * uv, weight * vv, weight * f
            m40, m31, m22 = m40 + wuu * uu, m31 + wuu * uv, m22 + wuu * vv
            m13, m04 = m13 + wuv * vv, m04 + wvv * vv
            m30, m21, m12, m03 = m30 + wuu * u, m21 + wuu * v, m12 + wvv * u, m03 + wvv * v
            m20, m11, m02 = m20 + wuu, m11 + wuv, m02 + wvv
            r0, r1, r2, r3, r4 = r0 - wf * uu, r1 - wf * uv, r2 - wf * vv, r3 - wf * u, r4 - wf * v
        normal[0, 0], normal[1, 0], normal[1, 1] = m40, m31, m22
        normal[2, 0], normal[2, 1], normal[2, 2] = m22, m13, m04
        normal[3, 0], normal[3, 1], normal[3, 2], normal[3, 3] = m30, m21, m12, m20
        normal[4, 0], normal[4, 1], normal[4, 2] = m21, m12, m03
        normal[4, 3], normal[4, 4] = m11, m02
        right[0], right[1], right[2], right[3], right[4] = r0, r1, r2, r3, r4
        size = normal[0, 0] + normal[2, 2]
        for i in range(5):
            right[i] /= size
            for j in range(i + 1):
                normal[i, j] /= size
        if not solve5(normal, right):
            return False
        if not ellipse_of_conic(
            (1.0 + right[0]) / (a * a), right[1] / (a * b), (1.0 + right[2]) / (b * b),
            right[3] / a, right[4] / b, -1.0, row,
        ):  # fmt: skip
            return False
        x = current[0] + row[0] * cos - row[1] * sin
        y = current[1] + row[0] * sin + row[1] * cos
        current[0], current[1], current[2], current[3] = x, y, row[2], row[3]
        current[4] = (current[4] + row[4]) % math.pi
    ellipse[:] = current
    return True
