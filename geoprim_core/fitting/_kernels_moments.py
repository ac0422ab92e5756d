"""Kernels on moment vectors up to order 4.

A moment vector (15,) holds the sums of u^p v^q over points, u = (x - x0) / s, v = (y - y0) / s,
in the order 1, u, v, uu, uv, vv, uuu, uuv, uvv, vvv, uuuu, uuuv, uuvv, uvvv, vvvv. Vectors about
the same origin (x0, y0) and scale s add.
"""

from __future__ import annotations

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel

_FIRST = np.array([0, 1, 3, 6, 10])  # index of the moment of order n with q = 0
_BINOMIAL = np.array(
    [[1, 0, 0, 0, 0], [1, 1, 0, 0, 0], [1, 2, 1, 0, 0], [1, 3, 3, 1, 0], [1, 4, 6, 4, 1]], float
)


@kernel
def add_moments(
    points: FloatArray, x0: float, y0: float, scale: float, moments: FloatArray
) -> None:
    """Add the moments of points (n, 2) about an origin and a scale to a vector (15,)."""
    for i in range(len(points)):
        u, v = (points[i, 0] - x0) / scale, (points[i, 1] - y0) / scale
        uu, uv, vv = u * u, u * v, v * v
        moments[0] += 1.0
        moments[1] += u
        moments[2] += v
        moments[3] += uu
        moments[4] += uv
        moments[5] += vv
        moments[6] += uu * u
        moments[7] += uu * v
        moments[8] += u * vv
        moments[9] += vv * v
        moments[10] += uu * uu
        moments[11] += uu * uv
        moments[12] += uu * vv
        moments[13] += uv * vv
        moments[14] += vv * vv


@kernel
def add_weighted_moments(
    points: FloatArray,
    weights: FloatArray,
    x0: float,
    y0: float,
    scale: float,
    moments: FloatArray,
) -> None:
    """Add the moments of points (n, 2) with weights (n,); as `add_moments`."""
    one = np.zeros(15)
    for i in range(len(points)):
        one[:] = 0.0
        add_moments(points[i : i + 1], x0, y0, scale, one)
        for j in range(15):
            moments[j] += weights[i] * one[j]


@kernel
def shifted(moments: FloatArray, dx: float, dy: float) -> FloatArray:
    """Return the moments about an origin moved by (dx, dy), in the same unit."""
    result = np.zeros(15)
    for order in range(5):
        for q in range(order + 1):
            p = order - q
            total = 0.0
            y_power = 1.0
            for j in range(q, -1, -1):
                x_power = 1.0
                for i in range(p, -1, -1):
                    weight = _BINOMIAL[p, i] * _BINOMIAL[q, j] * x_power * y_power
                    total += weight * moments[_FIRST[i + j] + j]
                    x_power *= -dx
                y_power *= -dy
            result[_FIRST[order] + q] = total
    return result


@kernel
def mapped(moments: FloatArray, alpha: float, beta: float, gamma: float) -> FloatArray:
    """Return the moments of u' = alpha u, v' = beta u + gamma v."""
    result = np.zeros(15)
    for order in range(5):
        for q in range(order + 1):
            p = order - q
            total = 0.0
            for j in range(q + 1):
                weight = _BINOMIAL[q, j] * beta ** (q - j) * gamma**j
                total += weight * moments[_FIRST[order] + j]
            result[_FIRST[order] + q] = alpha**p * total
    return result
