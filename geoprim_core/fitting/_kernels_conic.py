"""Kernels between ellipses (5,) and conics (6,): a, b, c, d, f, g of thesis (4-1)."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel
from geoprim_core.fitting._kernels_fit import IMAGINARY, INFINITE, OK, classified


@kernel
def conic_of(ellipse: FloatArray) -> FloatArray:
    """Return the conic of an ellipse, scaled so that its value at the centre is -1."""
    x, y = ellipse[0], ellipse[1]
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    major, minor = ellipse[2] ** -2, ellipse[3] ** -2
    gap = (ellipse[2] - ellipse[3]) * (ellipse[2] + ellipse[3]) * major * minor
    a = major + gap * sin * sin
    b = 0.0 - 2.0 * gap * cos * sin
    c = major + gap * cos * cos
    d = -2.0 * a * x - b * y
    f = -b * x - 2.0 * c * y
    u, v = cos * x + sin * y, cos * y - sin * x
    g = u * u * major + v * v * minor - 1.0
    return np.array([a, b, c, d, f, g])


@kernel
def ellipse_of(conic: FloatArray) -> tuple[int, FloatArray]:
    """Return the status and the ellipse (5,) of a conic (6,); existence as in errata E3."""
    ellipse = np.full(5, np.nan)
    a, b, c, d, f, g = conic
    kind = classified(a, b, c, 1e-15)
    if kind != OK:
        return kind, ellipse
    if a + c < 0.0:
        a, b, c, d, f, g = -a, -b, -c, -d, -f, -g
    det = 4.0 * a * c - b * b
    x, y = (b * f - 2.0 * c * d) / det, (b * d - 2.0 * a * f) / det
    level = -(g + 0.5 * (d * x + f * y))
    if not level > 0.0:
        return IMAGINARY, ellipse
    gap = math.hypot(a - c, b)
    ellipse[0], ellipse[1] = x, y
    ellipse[2] = math.sqrt(2.0 * level * (a + c + gap) / det)
    ellipse[3] = min(math.sqrt(2.0 * level / (a + c + gap)), ellipse[2])
    if gap == 0.0:
        ellipse[3] = ellipse[2]
    ellipse[4] = 0.0
    if gap > 1e-12 * (a + c):
        angle = 0.5 * math.atan2(0.0 - b, c - a)
        ellipse[4] = angle + math.pi if angle < 0.0 else angle
    if ellipse[4] >= math.pi:
        ellipse[4] = 0.0
    if not (np.isfinite(ellipse).all() and ellipse[3] > 0.0):
        return INFINITE, np.full(5, np.nan)
    return OK, ellipse
