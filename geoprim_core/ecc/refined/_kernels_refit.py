"""Kernels of the `refined` scheme: an ellipse refitted to points by their orthogonal distances.

The points are gathered first, x and y apart: what is summed over them then compiles to vector
instructions, and they are gone through several times.
"""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel, summing_kernel
from geoprim_core.ecc.refined._kernels_conic import ellipse_of_conic
from geoprim_core.ecc.refined._kernels_fit import offset_at

TUKEY = 4.685  # 95 % efficiency on normal errors
MAD = 1.4826
REFIT_STEPS = 2  # of one refit
WEIGHTED = 17  # sums of `weighted_sums`
X, Y, FAR = range(3)  # rows of what is gathered: position, distance


@inner_kernel
def gather_points(points: FloatArray, chosen: IntArray, count: int, near: FloatArray) -> None:
    """Write x and y of the chosen points to the first two rows of `near`."""
    for k in range(count):
        at = np.uint64(chosen[k])
        near[X, k], near[Y, k] = points[at, 0], points[at, 1]


@inner_kernel
def measure_points(near: FloatArray, count: int, ellipse: FloatArray) -> None:
    """Write the distance of each of the points to an ellipse to the last row of `near`."""
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    x0, y0 = ellipse[0], ellipse[1]
    flat, steep = 1.0 / (ellipse[2] * ellipse[2]), 1.0 / (ellipse[3] * ellipse[3])
    xs, ys, far = near[X], near[Y], near[FAR]
    for k in range(count):
        d, _, _ = offset_at(xs[k] - x0, ys[k] - y0, cos, sin, flat, steep)
        far[k] = abs(d)


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


@summing_kernel
def weighted_sums(
    near: FloatArray, count: int, ellipse: FloatArray, cos: float, sin: float, width: float,
    sums: FloatArray,
) -> None:  # fmt: skip
    """Write the sums of the normal equations of `refit`: left side by powers, then right side."""
    x0, y0, a, b = ellipse[0], ellipse[1], ellipse[2], ellipse[3]
    ia, ib = 1.0 / a, 1.0 / b
    narrow, common = 1.0 / (width * width), 1.0 / (a * b)
    m40 = m31 = m22 = m13 = m04 = m30 = m21 = m12 = m03 = m20 = m11 = m02 = 0.0
    r0 = r1 = r2 = r3 = r4 = 0.0
    xs, ys = near[X], near[Y]
    for k in range(count):  # scalars: an array is read and written for each point
        dx, dy = xs[k] - x0, ys[k] - y0
        u, v = (dx * cos + dy * sin) * ia, (dy * cos - dx * sin) * ib
        uu, uv, vv = u * u, u * v, v * v
        inverse = 1.0 / (4.0 * (uu * ia * ia + vv * ib * ib) + 1e-300)
        f = uu + vv - 1.0
        rest = max(0.0, 1.0 - f * f * inverse * narrow)
        weight = rest * rest * inverse * common
        wuu, wuv, wvv, wf = weight * uu, weight * uv, weight * vv, weight * f
        m40, m31, m22 = m40 + wuu * uu, m31 + wuu * uv, m22 + wuu * vv
        m13, m04 = m13 + wuv * vv, m04 + wvv * vv
        m30, m21, m12, m03 = m30 + wuu * u, m21 + wuu * v, m12 + wvv * u, m03 + wvv * v
        m20, m11, m02 = m20 + wuu, m11 + wuv, m02 + wvv
        r0, r1, r2, r3, r4 = r0 - wf * uu, r1 - wf * uv, r2 - wf * vv, r3 - wf * u, r4 - wf * v
    sums[0], sums[1], sums[2], sums[3], sums[4] = m40, m31, m22, m13, m04
    sums[5], sums[6], sums[7], sums[8] = m30, m21, m12, m03
    sums[9], sums[10], sums[11] = m20, m11, m02
    sums[12], sums[13], sums[14], sums[15], sums[16] = r0, r1, r2, r3, r4


@kernel
def refit(near: FloatArray, count: int, ellipse: FloatArray, steps: int, width: float) -> bool:
    """Improve an ellipse in place: reweighted least squares on the Sampson distance.

    In the frame where the ellipse is the unit circle the conic has five free coefficients; the
    weights are Tukey's with the given width in pixels over the squared gradient. Returns False,
    the ellipse unchanged, when a step fails.
    """
    room = np.empty((8, 5))
    normal, right, row, current = room[:5], room[5], room[6], room[7]
    m = np.empty(WEIGHTED)
    current[:] = ellipse
    for _ in range(steps):
        cos, sin = math.cos(current[4]), math.sin(current[4])
        a, b = current[2], current[3]
        weighted_sums(near, count, current, cos, sin, width, m)
        normal[0, 0], normal[1, 0], normal[1, 1] = m[0], m[1], m[2]
        normal[2, 0], normal[2, 1], normal[2, 2] = m[2], m[3], m[4]
        normal[3, 0], normal[3, 1], normal[3, 2], normal[3, 3] = m[5], m[6], m[7], m[9]
        normal[4, 0], normal[4, 1], normal[4, 2] = m[6], m[7], m[8]
        normal[4, 3], normal[4, 4] = m[10], m[11]
        size = normal[0, 0] + normal[2, 2]
        for i in range(5):
            right[i] = m[12 + i] / size
            for j in range(i + 1):
                normal[i, j] /= size
        if not solve5(normal, right):
            return False
        if not ellipse_of_conic(
            (1.0 + right[0]) / (a * a), right[1] / (a * b), (1.0 + right[2]) / (b * b),
            right[3] / a, right[4] / b, -1.0, row,
        ):  # fmt: skip
            return False
        current[0] += row[0] * cos - row[1] * sin
        current[1] += row[0] * sin + row[1] * cos
        current[2], current[3] = row[2], row[3]
        current[4] = (current[4] + row[4]) % math.pi
    ellipse[:] = current
    return True


@kernel
def refit_within(
    near: FloatArray, count: int, ellipse: FloatArray, width: float, max_major: float,
    min_minor: float,
) -> float:  # fmt: skip
    """Refit an ellipse in place; return by how many pixels that moves it at most.

    It is left as it is, and 0 returned, where a step fails or a semi-axis leaves its limits.
    """
    row = ellipse.copy()
    if not refit(near, count, row, REFIT_STEPS, width) or row[2] > max_major or row[3] < min_minor:
        return 0.0
    moved = 0.0
    for k in range(4):
        moved = max(moved, abs(row[k] - ellipse[k]))
    ellipse[:] = row
    return moved
