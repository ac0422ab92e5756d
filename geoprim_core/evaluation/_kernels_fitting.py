"""Kernel for Rosin's approximations of the distance of points to an ellipse."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel


@kernel
def rosin_distances(points: FloatArray, ellipse: FloatArray) -> FloatArray:
    """Return the distances (n, 2) along the focal bisector and to the confocal hyperbola's point.

    In the frame of the axes, foci at (-c, 0) and (c, 0), r and s the distances from them.
    """
    distances = np.empty((len(points), 2))
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    major, minor = ellipse[2], ellipse[3]
    focus = math.sqrt(max((major - minor) * (major + minor), 0.0))
    for i in range(len(points)):
        dx, dy = points[i, 0] - ellipse[0], points[i, 1] - ellipse[1]
        u, v = abs(cos * dx + sin * dy), abs(cos * dy - sin * dx)
        far, near = math.hypot(u + focus, v), math.hypot(u - focus, v)
        # The bisector of the directions to the foci; on the segment between them it is upright.
        nu, nv = 0.0, 1.0
        if far > 0.0 and near > 0.0:
            nu = (u + focus) / far + (u - focus) / near
            nv = v / far + v / near
            size = math.hypot(nu, nv)
            nu, nv = (nu / size, nv / size) if size > 1e-12 else (0.0, 1.0)
        elif far > 0.0:  # at a focus the other one gives the direction
            nu, nv = 1.0, 0.0
        p = (nu / major) ** 2 + (nv / minor) ** 2
        q = u * nu / major**2 + v * nv / minor**2
        r = (u / major - 1.0) * (u / major + 1.0) + (v / minor) ** 2
        root = math.sqrt(max(q * q - p * r, 0.0))
        # The nearer of the two crossings, without cancellation.
        distances[i, 0] = abs(r) / (abs(q) + root) if abs(q) + root > 0.0 else 0.0
        cosine = min(2.0 * u / (far + near), 1.0) if far + near > 0.0 else 0.0
        sine = math.sqrt((1.0 - cosine) * (1.0 + cosine))
        distances[i, 1] = math.hypot(u - major * cosine, v - minor * sine)
    return distances
