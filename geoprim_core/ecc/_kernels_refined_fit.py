"""Fitting kernels of the `refined` scheme: additive moments, direct fit, orthogonal refit.

The moments of a point set are the 25 numbers sum(x^p y^q) at [5 p + q], of which those with
p + q <= 4 are used.
"""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel

BINOMIAL = np.array(
    [[1, 0, 0, 0, 0], [1, 1, 0, 0, 0], [1, 2, 1, 0, 0], [1, 3, 3, 1, 0], [1, 4, 6, 4, 1]], float
)

ROUNDS = 3  # of the last refit
TUKEY = 4.685  # 95 % efficiency on normal errors
MAD = 1.4826
LEAST_WIDTH = 0.5  # pixels


@kernel
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
def add_shifted(total: FloatArray, moments: FloatArray, dx: float, dy: float, scale: float) -> None:
    """Add to `total` the moments of the same points moved by (dx, dy), then scaled."""
    half = np.empty(25)
    power = np.empty(5)
    power[0] = 1.0
    for k in range(1, 5):
        power[k] = power[k - 1] * dx
    for p in range(5):
        for q in range(5 - p):
            value = 0.0
            for k in range(p + 1):
                value += BINOMIAL[p, k] * power[p - k] * moments[5 * k + q]
            half[5 * p + q] = value
    for k in range(1, 5):
        power[k] = power[k - 1] * dy
    factor = np.empty(5)
    factor[0] = 1.0
    for k in range(1, 5):
        factor[k] = factor[k - 1] * scale
    for p in range(5):
        for q in range(5 - p):
            value = 0.0
            for k in range(q + 1):
                value += BINOMIAL[q, k] * power[q - k] * half[5 * p + k]
            total[5 * p + q] += value * factor[p + q]


@kernel
def largest_root(b: float, c: float, d: float) -> float:
    """Return the largest real root of x^3 + b x^2 + c x + d, all roots real."""
    third = b / 3.0
    q = third * third - c / 3.0
    r = (third * third - c / 2.0) * third + d / 2.0
    if q <= 0.0:
        return -third
    root = math.sqrt(q)
    ratio = r / (q * root)
    ratio = min(1.0, max(-1.0, ratio))
    x = -2.0 * root * math.cos((math.acos(ratio) + 2.0 * math.pi) / 3.0) - third
    for _ in range(2):
        slope = (3.0 * x + 2.0 * b) * x + c
        if slope != 0.0:
            x -= (((x + b) * x + c) * x + d) / slope
    return x


@kernel
def ellipse_of_conic(
    a: float, b: float, c: float, d: float, e: float, f: float, out: FloatArray
) -> bool:
    """Write the ellipse a x^2 + b xy + c y^2 + d x + e y + f = 0 as a row; False if it is none."""
    det = 4.0 * a * c - b * b
    if not det > 0.0:
        return False
    x = (b * e - 2.0 * c * d) / det
    y = (b * d - 2.0 * a * e) / det
    k = -(f + 0.5 * (d * x + e * y))
    mean = 0.5 * (a + c)
    spread = 0.5 * math.hypot(a - c, b)
    if mean < 0.0:
        a, b, c, k, mean = -a, -b, -c, -k, -mean
    if not (k > 0.0 and mean > spread):
        return False
    out[0] = x
    out[1] = y
    out[2] = math.sqrt(k / (mean - spread))
    out[3] = math.sqrt(k / (mean + spread))
    angle = 0.5 * math.atan2(-b, c - a)
    if angle < 0.0:
        angle += math.pi
    out[4] = angle if angle < math.pi else 0.0
    return bool(math.isfinite(out[2]))


@kernel
def fit_moments(m: FloatArray, x0: float, y0: float, scale: float, out: FloatArray) -> bool:
    """Fit an ellipse to moments taken of ((x, y) - (x0, y0)) * scale; False if there is none.

    Direct least squares in the partitioned form of Halir and Flusser; the 3x3 eigenproblem is
    solved by its characteristic cubic.
    """
    a, b, c = m[10], m[6], m[5]
    d, e, f = m[2], m[1], m[0]
    i00 = d * f - e * e
    i01 = c * e - b * f
    i02 = b * e - c * d
    det = a * i00 + b * i01 + c * i02
    if not det > 1e-14 * a * d * f:
        return False
    i11 = a * f - c * c
    i12 = b * c - a * e
    i22 = a * d - b * b
    s2 = ((m[15], m[11], m[10]), (m[11], m[7], m[6]), (m[7], m[3], m[2]))
    t = np.empty((3, 3))
    for k in range(3):
        u, v, w = s2[k]
        t[0, k] = -(i00 * u + i01 * v + i02 * w) / det
        t[1, k] = -(i01 * u + i11 * v + i12 * w) / det
        t[2, k] = -(i02 * u + i12 * v + i22 * w) / det
    s1 = ((m[20], m[16], m[12]), (m[16], m[12], m[8]), (m[12], m[8], m[4]))
    r = np.empty((3, 3))
    for i in range(3):
        u, v, w = s2[i]
        for k in range(3):
            r[i, k] = s1[i][k] + u * t[0, k] + v * t[1, k] + w * t[2, k]
    g = np.empty((3, 3))
    for k in range(3):
        g[0, k] = 0.5 * r[2, k]
        g[1, k] = -r[1, k]
        g[2, k] = 0.5 * r[0, k]
    trace = g[0, 0] + g[1, 1] + g[2, 2]
    minors = g[0, 0] * g[1, 1] - g[0, 1] * g[1, 0] + g[0, 0] * g[2, 2] - g[0, 2] * g[2, 0]
    minors += g[1, 1] * g[2, 2] - g[1, 2] * g[2, 1]
    det3 = g[0, 0] * (g[1, 1] * g[2, 2] - g[1, 2] * g[2, 1])
    det3 -= g[0, 1] * (g[1, 0] * g[2, 2] - g[1, 2] * g[2, 0])
    det3 += g[0, 2] * (g[1, 0] * g[2, 1] - g[1, 1] * g[2, 0])
    root = largest_root(-trace, minors, -det3)
    for k in range(3):
        g[k, k] -= root
    best = 0.0
    v0 = v1 = v2 = 0.0
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        w0 = g[i, 1] * g[j, 2] - g[i, 2] * g[j, 1]
        w1 = g[i, 2] * g[j, 0] - g[i, 0] * g[j, 2]
        w2 = g[i, 0] * g[j, 1] - g[i, 1] * g[j, 0]
        norm = w0 * w0 + w1 * w1 + w2 * w2
        if norm > best:
            best, v0, v1, v2 = norm, w0, w1, w2
    u = t[0, 0] * v0 + t[0, 1] * v1 + t[0, 2] * v2
    v = t[1, 0] * v0 + t[1, 1] * v1 + t[1, 2] * v2
    w = t[2, 0] * v0 + t[2, 1] * v1 + t[2, 2] * v2
    if not ellipse_of_conic(v0, v1, v2, u, v, w, out):
        return False
    out[0] = out[0] / scale + x0
    out[1] = out[1] / scale + y0
    out[2] /= scale
    out[3] /= scale
    return True


@kernel
def offset_of(
    ellipse: FloatArray, cos: float, sin: float, x: float, y: float
) -> tuple[float, float, float]:
    """Return the signed distance of a point (Sampson) and the outward unit normal there."""
    dx = x - ellipse[0]
    dy = y - ellipse[1]
    u = (dx * cos + dy * sin) / ellipse[2]
    v = (dy * cos - dx * sin) / ellipse[3]
    gu = u / ellipse[2]
    gv = v / ellipse[3]
    slope = math.sqrt(gu * gu + gv * gv) + 1e-300
    distance = 0.5 * (u * u + v * v - 1.0) / slope
    gu /= slope
    gv /= slope
    return distance, gu * cos - gv * sin, gu * sin + gv * cos


@kernel
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
        a, b = current[2], current[3]
        normal[:] = 0.0
        right[:] = 0.0
        for k in range(count):
            dx = points[chosen[k], 0] - current[0]
            dy = points[chosen[k], 1] - current[1]
            u = (dx * cos + dy * sin) / a
            v = (dy * cos - dx * sin) / b
            slope = 4.0 * (u * u / (a * a) + v * v / (b * b)) + 1e-300
            f = u * u + v * v - 1.0
            ratio = f * f / (slope * width * width)
            if ratio >= 1.0:
                continue
            weight = (1.0 - ratio) * (1.0 - ratio) / (slope * a * b)
            row[0], row[1], row[2], row[3], row[4] = u * u, u * v, v * v, u, v
            for i in range(5):
                wi = weight * row[i]
                right[i] -= wi * f
                for j in range(i + 1):
                    normal[i, j] += wi * row[j]
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


@kernel
def refit_robustly(
    points: FloatArray, chosen: IntArray, ellipse: FloatArray, max_size: float, min_size: float
) -> float:
    """Refit an ellipse in place with weights from the median distance; return their width.

    A round that leaves the limits of the semi-axes is undone and the last.
    """
    distances = np.empty(len(chosen))
    row = ellipse.copy()
    width = 0.0
    for _ in range(ROUNDS):
        cos, sin = math.cos(row[4]), math.sin(row[4])
        for k in range(len(chosen)):
            d, _, _ = offset_of(row, cos, sin, points[chosen[k], 0], points[chosen[k], 1])
            distances[k] = abs(d)
        width = max(LEAST_WIDTH, TUKEY * MAD * np.median(distances))
        if not refit(points, chosen, len(chosen), row, 2, width):
            break
        if row[2] > max_size or row[3] < min_size:
            break
        ellipse[:] = row
    return width
