"""Kernels on the shape of ellipses, each a row x, y, semi_major, semi_minor, angle."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel


@kernel
def perimeter_of(semi_major: float, semi_minor: float) -> float:
    """Return the length of an ellipse, by the arithmetic-geometric mean (exact to rounding)."""
    mean, geometric = semi_major, semi_minor
    weight = 0.5
    total = 0.5 * (semi_major * semi_major + semi_minor * semi_minor)
    while mean - geometric > 1e-15 * mean:
        half = 0.5 * (mean - geometric)
        mean, geometric = 0.5 * (mean + geometric), math.sqrt(mean * geometric)
        weight *= 2.0
        total -= weight * half * half
        if weight > 1e6:
            break
    return 2.0 * math.pi * total / mean


@kernel
def boxes_of(ellipses: FloatArray) -> FloatArray:
    """Return x_min, y_min, x_max, y_max (n, 4) of each ellipse (n, 5)."""
    boxes = np.empty((len(ellipses), 4))
    for i in range(len(ellipses)):
        cos, sin = math.cos(ellipses[i, 4]), math.sin(ellipses[i, 4])
        major, minor = ellipses[i, 2], ellipses[i, 3]
        width = math.hypot(major * cos, minor * sin)
        height = math.hypot(major * sin, minor * cos)
        boxes[i, 0] = ellipses[i, 0] - width
        boxes[i, 1] = ellipses[i, 1] - height
        boxes[i, 2] = ellipses[i, 0] + width
        boxes[i, 3] = ellipses[i, 1] + height
    return boxes


@kernel
def points_at(ellipse: FloatArray, parameter: FloatArray) -> FloatArray:
    """Return the points (n, 2) of one ellipse (5,) at eccentric angles (n,)."""
    points = np.empty((len(parameter), 2))
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    for i in range(len(parameter)):
        u = ellipse[2] * math.cos(parameter[i])
        v = ellipse[3] * math.sin(parameter[i])
        points[i, 0] = ellipse[0] + cos * u - sin * v
        points[i, 1] = ellipse[1] + sin * u + cos * v
    return points
