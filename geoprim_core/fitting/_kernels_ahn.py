"""Kernel of Ahn's orthogonal distance fit: Gauss-Newton steps on the coordinates of the feet."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel
from geoprim_core.fitting._kernels_distance import canonical, foot_of
from geoprim_core.fitting._kernels_fit import (
    NSAF,
    OK,
    algebraic_residual,
    fit_points_of,
    point_sums,
)

_UNSETTLED = 8
_ROUNDING = 2.3e-16  # of a number in double precision


@kernel
def foot_motion(
    xi: float, yi: float, x: float, y: float, a: float, b: float, motion: FloatArray
) -> None:
    """Write how the foot (x, y) of (xi, yi) moves with xc, yc, a, b, angle: (2, 5).

    All in the frame of the axes. The foot solves f1 = (a^2 y^2 + b^2 x^2 - a^2 b^2) / 2 = 0 and
    f2 = b^2 x (yi - y) - a^2 y (xi - x) = 0; the theorem of implicit functions gives the rest.
    It has no finite answer where the point lies on the evolute.
    """
    aa, bb = a * a, b * b
    q11, q12 = bb * x, aa * y
    q21, q22 = bb * (yi - y) + aa * y, -bb * x - aa * (xi - x)
    share = 1.0 / (q11 * q22 - q12 * q21)
    right_a, right_b = -a * (y * y - bb), -b * (x * x - aa)
    turn_a, turn_b = 2.0 * a * y * (xi - x), -2.0 * b * x * (yi - y)
    turn = aa * y * yi + bb * x * xi
    motion[0, 0], motion[1, 0] = 1.0 + q12 * aa * y * share, -q11 * aa * y * share
    motion[0, 1], motion[1, 1] = -q12 * bb * x * share, 1.0 + q11 * bb * x * share
    motion[0, 2] = (q22 * right_a - q12 * turn_a) * share
    motion[1, 2] = (q11 * turn_a - q21 * right_a) * share
    motion[0, 3] = (q22 * right_b - q12 * turn_b) * share
    motion[1, 3] = (q11 * turn_b - q21 * right_b) * share
    motion[0, 4], motion[1, 4] = -q12 * turn * share - y, q11 * turn * share + x


@kernel
def _system(
    points: FloatArray, weights: FloatArray, ellipse: FloatArray
) -> tuple[FloatArray, FloatArray, float]:
    """Return J'WJ, J'Wr and the cost r'Wr; the centre's two steps are along the axes."""
    matrix, vector, cost = np.zeros((5, 5)), np.zeros(5), 0.0
    motion = np.empty((2, 5))
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    a, b = ellipse[2], ellipse[3]
    for i in range(len(points)):
        weight = weights[i] if len(weights) else 1.0
        dx, dy = points[i, 0] - ellipse[0], points[i, 1] - ellipse[1]
        xi, yi = cos * dx + sin * dy, cos * dy - sin * dx
        x, y = foot_of(abs(xi), abs(yi), a, b)
        x, y = math.copysign(x, xi), math.copysign(y, yi)
        cost += weight * ((xi - x) ** 2 + (yi - y) ** 2)
        foot_motion(xi, yi, x, y, a, b, motion)
        if not math.isfinite(motion.sum()):
            continue
        for j in range(5):
            vector[j] += weight * (motion[0, j] * (xi - x) + motion[1, j] * (yi - y))
            for k in range(j + 1):
                product = motion[0, j] * motion[0, k] + motion[1, j] * motion[1, k]
                matrix[j, k] += weight * product
    for j in range(5):
        matrix[:j, j] = matrix[j, :j]
    return matrix, vector, cost


@kernel
def circle_through(points: FloatArray, weights: FloatArray) -> FloatArray:
    """Return the circle (5,) of least algebraic distance, where Ahn's steps may start."""
    moments, x0, y0, scale = point_sums(points, weights)
    m = moments / moments[0]
    right_u, right_v = m[6] + m[8], m[7] + m[9]
    det = m[3] * m[5] - m[4] * m[4]
    u = 0.5 * (m[5] * right_u - m[4] * right_v) / det
    v = 0.5 * (m[3] * right_v - m[4] * right_u) / det
    radius = scale * math.sqrt(m[3] + m[5] + u * u + v * v)
    return np.array([x0 + scale * u, y0 + scale * v, radius, radius, 0.0])


@kernel
def _stepped(ellipse: FloatArray, step: FloatArray, length: float) -> FloatArray:
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    result = ellipse + length * step
    result[0] = ellipse[0] + length * (cos * step[0] - sin * step[1])
    result[1] = ellipse[1] + length * (sin * step[0] + cos * step[1])
    return result


@kernel
def ahn_points(
    points: FloatArray, weights: FloatArray, iterations: int, from_circle: bool
) -> tuple[int, FloatArray, float]:
    """Fit an ellipse (5,) to points (n, 2) with weights (n,) or (0,); status, ellipse, residual."""
    status, ellipse, residual = fit_points_of(points, weights, NSAF)
    if status != OK:
        return status, ellipse, residual
    if from_circle:
        ellipse = circle_through(points, weights)
    matrix, vector, cost = _system(points, weights, ellipse)
    settled = False
    unseen = _ROUNDING * len(points)  # share of the cost that a sum over the points cannot show
    for _ in range(iterations):
        for j in range(5):  # a circle has no angle: its row is zero
            matrix[j, j] += 1e-14 * matrix[j, j] + 1e-14 * matrix[0, 0]
        step = np.linalg.solve(matrix, vector).astype(np.float64)
        size = math.sqrt(step[0] ** 2 + step[1] ** 2 + step[2] ** 2 + step[3] ** 2)
        size += abs(step[4]) * (ellipse[2] - ellipse[3])
        if size <= 1e-10 * ellipse[2]:
            settled = True
            break
        # Near the minimum rounding hides what a step gains; the steps shrink without a judge.
        judged = step @ vector > unseen * cost
        length = 1.0
        for _ in range(20):
            trial = _stepped(ellipse, step, length)
            if np.isfinite(trial).all() and min(trial[2], trial[3]) > 1e-9 * trial[2]:
                trial = canonical(trial)
                following = _system(points, weights, trial)
                if following[2] < cost or not judged:
                    break
            length *= 0.5
        else:
            # No shorter step improves: a minimum to rounding, or the end of the road.
            settled = size <= 1e-6 * ellipse[2]
            break
        ellipse = trial
        matrix, vector, cost = following
    if not settled:
        return _UNSETTLED, np.full(5, np.nan), np.nan
    ellipse = canonical(ellipse)
    return OK, ellipse, algebraic_residual(points, weights, ellipse)
