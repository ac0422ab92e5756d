"""Kernels for orthogonal distances to an ellipse and the fit that minimises them."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel


@kernel
def foot_of(px: float, py: float, major: float, minor: float) -> tuple[float, float]:
    """Return the outline point nearest to (px, py), both in the frame of the axes, px, py >= 0.

    With tau = 1 + t / minor^2 the foot is (major^2 px / (t + major^2), py / tau), and tau is
    the root of a falling convex function, which Newton's method reaches from the left. A step
    from 1, where points on the outline have their root, ends left of it too.
    """
    if py > 0.0:
        ratio = (major / minor) ** 2
        gap = (major - minor) * (major + minor) / (minor * minor)
        z0, z1 = px / major, py / minor
        tau = 1.0 + 0.5 * (z0 * z0 + z1 * z1 - 1.0) / (z0 * z0 / ratio + z1 * z1)
        tau = max(tau, z1, ratio * z0 - gap)
        for _ in range(100):
            first, second = ratio * z0 / (tau + gap), z1 / tau
            value = first * first + second * second - 1.0
            slope = -2.0 * (first * first / (tau + gap) + second * second / tau)
            step = -value / slope
            tau += step
            if abs(step) <= 1e-16 * tau or value <= 0.0:
                break
        return ratio * px / (tau + gap), py / tau
    gap = (major - minor) * (major + minor)
    if px * major < gap:
        u = px * major / gap
        return major * u, minor * math.sqrt((1.0 - u) * (1.0 + u))
    return major, 0.0


@kernel
def signed_distances(points: FloatArray, ellipse: FloatArray) -> FloatArray:
    """Return the orthogonal distance (n,) of each point, negative inside the ellipse (5,)."""
    distance = np.empty(len(points))
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    major, minor = ellipse[2], ellipse[3]
    for i in range(len(points)):
        dx, dy = points[i, 0] - ellipse[0], points[i, 1] - ellipse[1]
        u, v = abs(cos * dx + sin * dy), abs(cos * dy - sin * dx)
        fu, fv = foot_of(u, v, major, minor)
        far = math.hypot(u - fu, v - fv)
        distance[i] = -far if (u / major) ** 2 + (v / minor) ** 2 < 1.0 else far
    return distance


@kernel
def _system(
    points: FloatArray, weights: FloatArray, ellipse: FloatArray, huber: float
) -> tuple[FloatArray, FloatArray, float, float]:
    """Return J'WJ, J'Wr, the cost and the sum of squares W r r of the orthogonal residuals."""
    matrix, vector, row = np.zeros((5, 5)), np.zeros(5), np.empty(5)
    cost, squares = 0.0, 0.0
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    major, minor = ellipse[2], ellipse[3]
    for i in range(len(points)):
        dx, dy = points[i, 0] - ellipse[0], points[i, 1] - ellipse[1]
        u, v = cos * dx + sin * dy, cos * dy - sin * dx
        fu, fv = foot_of(abs(u), abs(v), major, minor)
        fu, fv = math.copysign(fu, u), math.copysign(fv, v)
        nu, nv = fu / (major * major), fv / (minor * minor)
        size = 1.0 / math.sqrt(nu * nu + nv * nv)
        nu, nv = nu * size, nv * size
        residual = nu * (u - fu) + nv * (v - fv)
        weight = weights[i]
        if abs(residual) > huber:
            cost += weight * huber * (2.0 * abs(residual) - huber)
            weight *= huber / abs(residual)
        else:
            cost += weight * residual * residual
        squares += weight * residual * residual
        row[0], row[1] = cos * nu - sin * nv, sin * nu + cos * nv
        row[2], row[3] = nu * fu / major, nv * fv / minor
        row[4] = nv * fu - nu * fv
        for j in range(5):
            vector[j] += weight * row[j] * residual
            for k in range(j + 1):
                matrix[j, k] += weight * row[j] * row[k]
    for j in range(5):
        matrix[:j, j] = matrix[j, :j]
    return matrix, vector, cost, squares


@kernel
def canonical(ellipse: FloatArray) -> FloatArray:
    """Return an ellipse, semi-major axis first, its angle in [0, pi) and 0 for a circle."""
    result = ellipse.copy()
    if result[3] > result[2]:
        result[2], result[3] = ellipse[3], ellipse[2]
        result[4] += 0.5 * math.pi
    result[4] -= math.pi * math.floor(result[4] / math.pi)
    if result[4] >= math.pi or result[2] - result[3] <= 1e-12 * result[2]:
        result[4] = 0.0
    return result


@kernel
def _covariance(matrix: FloatArray, variance: float) -> FloatArray:
    """Return the covariance of the five parameters; an angle is known to lie on a half-turn.

    The variance pi^2 / 12 of an even spread over [0, pi) enters as prior knowledge of the
    angle, which bounds it for a circle and does not show for an ellipse.
    """
    if not math.isfinite(variance):
        return np.full((5, 5), np.nan)
    information = matrix.copy()
    information[4, 4] += max(variance, 1e-30) * 12.0 / math.pi**2
    size = np.sqrt(np.diag(information)) + 1e-300
    scaled = information / np.outer(size, size) + 1e-14 * np.eye(5)
    return variance * np.linalg.inv(scaled) / np.outer(size, size)


@kernel
def refine_kernel(
    points: FloatArray, weights: FloatArray, start: FloatArray, steps: int, huber: float
) -> tuple[FloatArray, FloatArray, float, bool]:
    """Minimise weighted squared orthogonal distances by damped Gauss-Newton steps.

    Beyond `huber` pixels the cost grows linearly only. Returns the ellipse (5,), its covariance
    (5, 5), the root mean square distance in pixels and whether the steps have settled.
    """
    ellipse = start.copy()
    matrix, vector, cost, squares = _system(points, weights, ellipse, huber)
    damping = 1e-6
    settled = False
    for _ in range(steps):
        moved = False
        for _ in range(12):
            damped = matrix.copy()
            for j in range(5):
                damped[j, j] += damping * matrix[j, j] + 1e-12 * (1.0 + matrix[0, 0])
            trial = ellipse + np.linalg.solve(damped, vector)
            if trial[2] > 0.0 and trial[3] > 0.0 and np.isfinite(trial).all():
                trial = canonical(trial)
                if trial[3] > 1e-9 * trial[2]:
                    following = _system(points, weights, trial, huber)
                    if following[2] <= cost:
                        moved = True
                        break
            damping = max(10.0 * damping, 1e-6)
        if not moved:
            settled = True
            break
        gain = cost - following[2]
        ellipse = trial
        matrix, vector, cost, squares = following
        damping *= 0.1
        if gain <= 1e-12 * cost or cost <= 1e-24 * weights.sum():
            settled = True
            break
    total = weights.sum()
    used = 0
    for i in range(len(weights)):
        if weights[i] > 0.0:
            used += 1
    freedom = max(total * (1.0 - 5.0 / used), 1e-300) if used > 5 else np.nan
    covariance = _covariance(matrix, squares / freedom)
    return canonical(ellipse), covariance, math.sqrt(squares / total), settled
