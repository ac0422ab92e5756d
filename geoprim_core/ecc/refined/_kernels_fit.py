"""Fitting kernels of the `refined` scheme: additive moments, direct fit, distance.

The moments of a point set are the 25 numbers sum(x^p y^q) at [5 p + q], of which those with
p + q <= 4 are used.
"""

from __future__ import annotations

import math

from geoprim_core._check import FloatArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_conic import direct_conic, ellipse_of_conic


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
