"""Kernel of the turn that digitisation can give a chord."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel


@kernel
def exact_slope_bound_of(dx: float, dy: float) -> float:
    """Return in radians by how much a chord (dx, dy) turns at most, errata P4."""
    length = math.hypot(dx, dy)
    total = (abs(dx) + abs(dy)) / length if length > 0.0 else 0.0
    if length <= total or length == 0.0:
        return 0.5 * math.pi
    gap = abs(abs(dx) - abs(dy)) / length
    return max(math.atan(total / (length - gap)), math.atan(gap / (length - total)))


@kernel
def exact_slope_bounds_of(chords: FloatArray) -> FloatArray:
    """Return the largest turn of every chord (n, 2)."""
    bounds = np.empty(len(chords))
    for i in range(len(chords)):
        bounds[i] = exact_slope_bound_of(chords[i, 0], chords[i, 1])
    return bounds
