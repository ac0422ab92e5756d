"""What the faces of all fits share: weights in, and from a kernel's status to an `EllipseFit`."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray
from geoprim_core.errors import InputError
from geoprim_core.fitting._kernels_conic import conic_of
from geoprim_core.fitting._kernels_fit import OK
from geoprim_core.fitting.fit_params import FitParams
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
    "the steps have not settled",
    "the semi-major axis is above its limit",
    "the ratio of the axes is below its limit",
    "the points do not tell an ellipse from a parabola",
)
UNSETTLED, TOO_LARGE, TOO_THIN = 8, 9, 10
UNWEIGHTED = np.zeros(0)


def checked_weights(weights: npt.ArrayLike | None, count: int) -> FloatArray:
    """Return weights (count,), or none at all (0,) for one each.

    Raises
    ------
    InputError
        They are not `count` finite numbers of at least 0, one of them positive.
    """
    if weights is None:
        return UNWEIGHTED
    checked = _check.finite(weights, "weights", (count,))
    if (checked < 0).any() or (count and not (checked > 0).any()):
        raise InputError("weights", "numbers of at least 0, not all 0", "others")
    return checked


def limited(status: int, row: FloatArray, limits: FitParams) -> int:
    """Return the status of an ellipse (5,) after the limits on its axes."""
    if status == OK and 0 < limits.max_semi_major < row[2]:
        return TOO_LARGE
    if status == OK and row[3] < limits.min_axis_ratio * row[2]:
        return TOO_THIN
    return status


def outcome(
    status: int, row: FloatArray, residual: float, limits: FitParams | None = None
) -> EllipseFit:
    """Return the fit that a kernel's status, ellipse (5,) and residual stand for."""
    if limits is not None:
        status = limited(status, row, limits)
    if status != OK:
        return EllipseFit(None, REASONS[status])
    return EllipseFit(Ellipse(*row.tolist()), "", conic_of(row), float(residual))


def fit_by(
    kernel: Callable[..., tuple[int, FloatArray, float]],
    points: npt.ArrayLike,
    weights: npt.ArrayLike | None,
    limits: FitParams,
    *options: float,
) -> EllipseFit:
    """Check points and weights, call a method's kernel and return its fit within the limits."""
    cloud = _check.points(points)
    return outcome(*kernel(cloud, checked_weights(weights, len(cloud)), *options), limits)
