"""Kernels of the `refined` scheme: the conic that fits best to moments, and its ellipse.

They have no branches and, but for that which writes a row, no arrays: a loop over many of them
compiles to vector instructions.
"""

from __future__ import annotations

import math

from geoprim_core._check import FloatArray
from geoprim_core._jit import inlined_kernel, inner_kernel, kernel

# Coefficients of `cosine_of_third`, lowest power first.
THIRD = (
    0.5000000037331834,
    0.5773496613984136,
    -0.11109449276739966,
    0.0532793508491747,
    -0.031925412141888945,
    0.01960032093247175,
    -0.01023750832214544,
    0.003654119563753207,
    -0.0006260453222116469,
)


@kernel
def cosine_of_third(s: float) -> float:
    """Return cos(2/3 arccos(s)) for s in [0, 1], by Chebyshev interpolation within 4e-9."""
    low = THIRD[0] + s * (THIRD[1] + s * (THIRD[2] + s * THIRD[3]))
    high = THIRD[5] + s * (THIRD[6] + s * (THIRD[7] + s * THIRD[8]))
    square = s * s
    return low + square * square * (THIRD[4] + s * high)


@inlined_kernel
def largest_root(b: float, c: float, d: float) -> float:
    """Return the largest real root of x^3 + b x^2 + c x + d, all roots real.

    A third of an angle is taken by a polynomial, so that there is no call and no branch.
    """
    third = b / 3.0
    q = third * third - c / 3.0
    r = (third * third - c / 2.0) * third + d / 2.0
    root = math.sqrt(max(q, 0.0))
    ratio = r / (q * root)
    s = math.sqrt(0.5 - 0.5 * min(1.0, max(-1.0, ratio)))
    x = 2.0 * root * cosine_of_third(s) - third
    for _ in range(2):
        slope = (3.0 * x + 2.0 * b) * x + c
        x -= (((x + b) * x + c) * x + d) / slope if slope != 0.0 else 0.0
    return x if q > 0.0 else -third


@inlined_kernel
def axes_of_conic(
    a: float, b: float, c: float, d: float, e: float, f: float
) -> tuple[float, float, float, float]:
    """Return centre and semi-axes of the ellipse a x^2 + b xy + ... + f = 0, NaN if it is none."""
    det = 4.0 * a * c - b * b
    x = (b * e - 2.0 * c * d) / det
    y = (b * d - 2.0 * a * e) / det
    sign = 1.0 if a + c > 0.0 else -1.0
    k = -sign * (f + 0.5 * (d * x + e * y))
    mean = 0.5 * sign * (a + c)
    spread = 0.5 * math.sqrt((a - c) * (a - c) + b * b)
    real = (det > 0.0) & (k > 0.0) & (mean > spread)
    major = math.sqrt(k / (mean - spread)) if real else math.nan
    minor = math.sqrt(k / (mean + spread)) if real else math.nan
    return x, y, major, minor


@inner_kernel
def ellipse_of_conic(
    a: float, b: float, c: float, d: float, e: float, f: float, out: FloatArray
) -> bool:
    """Write the ellipse a x^2 + b xy + c y^2 + d x + e y + f = 0 as a row; False if it is none."""
    x, y, major, minor = axes_of_conic(a, b, c, d, e, f)
    if not math.isfinite(major):
        return False
    out[0], out[1], out[2], out[3] = x, y, major, minor
    angle = 0.5 * (math.atan2(-b, c - a) if a + c > 0.0 else math.atan2(b, a - c))
    if angle < 0.0:
        angle += math.pi
    out[4] = angle if angle < math.pi else 0.0
    return True


@kernel
def lines_of(
    i00: float,
    i01: float,
    i02: float,
    i11: float,
    i12: float,
    i22: float,
    u: float,
    v: float,
    w: float,
    det: float,
) -> tuple[float, float, float]:
    """Return minus an inverse symmetric matrix (adjugate i over det) times (u, v, w)."""
    return (
        -(i00 * u + i01 * v + i02 * w) / det,
        -(i01 * u + i11 * v + i12 * w) / det,
        -(i02 * u + i12 * v + i22 * w) / det,
    )


@kernel
def crossed(
    x0: float, x1: float, x2: float, y0: float, y1: float, y2: float
) -> tuple[float, float, float, float]:
    """Return the cross product of two vectors and the square of its length."""
    w0 = x1 * y2 - x2 * y1
    w1 = x2 * y0 - x0 * y2
    w2 = x0 * y1 - x1 * y0
    return w0, w1, w2, w0 * w0 + w1 * w1 + w2 * w2


@inlined_kernel
def direct_conic(
    m00: float, m01: float, m02: float, m03: float, m04: float, m10: float, m11: float, m12: float,
    m13: float, m20: float, m21: float, m22: float, m30: float, m31: float, m40: float,
) -> tuple[float, float, float, float, float, float]:  # fmt: skip
    """Return a, b, c, d, e, f of the conic that fits best to moments; NaN where there is none.

    Direct least squares in the partitioned form of Halir and Flusser; the 3x3 eigenproblem is
    solved by its characteristic cubic. There are no branches, as in `largest_root`.
    """
    i00 = m02 * m00 - m01 * m01
    i01 = m10 * m01 - m11 * m00
    i02 = m11 * m01 - m10 * m02
    det = m20 * i00 + m11 * i01 + m10 * i02
    det = det if det > 1e-14 * m20 * m02 * m00 else math.nan
    i11 = m20 * m00 - m10 * m10
    i12 = m11 * m10 - m20 * m01
    i22 = m20 * m02 - m11 * m11
    t00, t10, t20 = lines_of(i00, i01, i02, i11, i12, i22, m30, m21, m20, det)
    t01, t11, t21 = lines_of(i00, i01, i02, i11, i12, i22, m21, m12, m11, det)
    t02, t12, t22 = lines_of(i00, i01, i02, i11, i12, i22, m12, m03, m02, det)
    g20 = 0.5 * (m40 + m30 * t00 + m21 * t10 + m20 * t20)
    g21 = 0.5 * (m31 + m30 * t01 + m21 * t11 + m20 * t21)
    g22 = 0.5 * (m22 + m30 * t02 + m21 * t12 + m20 * t22)
    g10 = -(m31 + m21 * t00 + m12 * t10 + m11 * t20)
    g11 = -(m22 + m21 * t01 + m12 * t11 + m11 * t21)
    g12 = -(m13 + m21 * t02 + m12 * t12 + m11 * t22)
    g00 = 0.5 * (m22 + m12 * t00 + m03 * t10 + m02 * t20)
    g01 = 0.5 * (m13 + m12 * t01 + m03 * t11 + m02 * t21)
    g02 = 0.5 * (m04 + m12 * t02 + m03 * t12 + m02 * t22)
    minors = g00 * g11 - g01 * g10 + g00 * g22 - g02 * g20
    minors += g11 * g22 - g12 * g21
    det3 = g00 * (g11 * g22 - g12 * g21)
    det3 -= g01 * (g10 * g22 - g12 * g20)
    det3 += g02 * (g10 * g21 - g11 * g20)
    root = largest_root(-(g00 + g11 + g22), minors, -det3)
    g00, g11, g22 = g00 - root, g11 - root, g22 - root
    v0, v1, v2, best = crossed(g10, g11, g12, g20, g21, g22)
    w0, w1, w2, norm = crossed(g20, g21, g22, g00, g01, g02)
    longer = norm > best
    v0, v1, v2 = w0 if longer else v0, w1 if longer else v1, w2 if longer else v2
    best = max(best, norm)
    w0, w1, w2, norm = crossed(g00, g01, g02, g10, g11, g12)
    longer = norm > best
    v0, v1, v2 = w0 if longer else v0, w1 if longer else v1, w2 if longer else v2
    return (
        v0, v1, v2, t00 * v0 + t01 * v1 + t02 * v2, t10 * v0 + t11 * v1 + t12 * v2,
        t20 * v0 + t21 * v1 + t22 * v2,
    )  # fmt: skip
