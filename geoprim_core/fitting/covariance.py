"""How well the points determine a fitted ellipse."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray
from geoprim_core.errors import InputError, ParameterError
from geoprim_core.fitting._kernels_covariance import algebraic_covariance
from geoprim_core.fitting._kernels_distance import refine_kernel
from geoprim_core.fitting._outcome import checked_weights
from geoprim_core.fitting.shape import ellipse_row
from geoprim_core.types import Ellipse

_GEOMETRIC = ("geometric", "ahn")
_ALGEBRAIC = (
    "halir_flusser", "taubin", "nsaf", "fitzgibbon", "maini", "harker", "hyper", "ellifit",
)  # fmt: skip


def fit_covariance(
    points: npt.ArrayLike,
    ellipse: Ellipse,
    method: str = "geometric",
    weights: npt.ArrayLike | None = None,
) -> FloatArray:
    """Return the covariance of an ellipse that a method has fitted to points.

    The points' errors are taken for independent, alike in all directions and of one size, which
    is estimated from their orthogonal distances. To first order in that size all algebraic fits
    have one covariance, whatever their constraint; their bias, of second order, is not in it.
    Pixels of a digital curve are not independent: there the truth is wider.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least five.
    ellipse : Ellipse
        The one that the method has found.
    method : str
        A method of `TABLE` that minimises something: all but chaudhuri and liu.
    weights : (n,) array, optional
        The weights of the fit; a weight counts as so many points.

    Returns
    -------
    (5, 5) float64
        Of x, y, semi_major, semi_minor (pixels) and angle (radians); NaN with five points. The
        variance of an angle is at most pi^2 / 12, that of an unknown direction.

    Raises
    ------
    InputError
        An argument is of a wrong kind or shape.
    ParameterError
        The method has no covariance.

    References
    ----------
    K. Kanatani, Y. Sugaya and Y. Kanazawa, "Ellipse Fitting for Computer Vision", 2016 (first
    order analysis of algebraic fits).

    Examples
    --------
    >>> from geoprim_core.fitting import outline_points, taubin
    >>> wave = 0.1 * np.sin(7.3 * np.arange(80))
    >>> points = outline_points(Ellipse(50, 40, 30, 20, 0.3), 40) + wave.reshape(40, 2)
    >>> covariance = fit_covariance(points, taubin(points).ellipse, "taubin")
    >>> bool(0.01 < covariance[0, 0] ** 0.5 < 0.03)
    True
    """
    cloud = _check.points(points)
    if len(cloud) < 5:
        raise InputError("points", "at least five points", f"{len(cloud)}")
    row, own = ellipse_row(ellipse), checked_weights(weights, len(cloud))
    if method in _ALGEBRAIC:
        algebraic: FloatArray = algebraic_covariance(cloud, own, row)
        return algebraic
    if method not in _GEOMETRIC:
        known = ", ".join(_GEOMETRIC + _ALGEBRAIC)
        raise ParameterError("method", f"one of {known}", _check.describe(method))
    full = own if len(own) else np.ones(len(cloud))
    covariance: FloatArray = refine_kernel(cloud, full, row, 0, float("inf"))[1]
    return covariance
