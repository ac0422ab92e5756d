"""From a kernel's status to an `EllipseFit`: the reasons in words."""

from __future__ import annotations

from geoprim_core._check import FloatArray
from geoprim_core.fitting._kernels_conic import conic_of
from geoprim_core.fitting._kernels_fit import OK
from geoprim_core.types import Ellipse, EllipseFit

# In the order of the status numbers of the kernels.
REASONS = (
    "",
    "fewer than five distinct points",
    "the points lie on a straight line",
    "the points leave more than one conic free",
    "the best conic is a hyperbola",
    "the best conic is a parabola",
    "the best conic has no real points",
    "the axes of the best conic are not finite",
)


def outcome(status: int, row: FloatArray, residual: float) -> EllipseFit:
    """Return the fit that a kernel's status, ellipse (5,) and residual stand for."""
    if status != OK:
        return EllipseFit(None, REASONS[status])
    ellipse = Ellipse(*(float(value) for value in row))
    return EllipseFit(ellipse, "", conic_of(row), float(residual))
