"""Chaudhuri: centroid, principal axis, then two linear unknowns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core.fitting._kernels_pencil import CHAUDHURI, pencil_points
from geoprim_core.fitting._outcome import fit_by
from geoprim_core.fitting.fit_params import FitParams
from geoprim_core.params import as_params
from geoprim_core.types import EllipseFit


@dataclass(frozen=True)
class ChaudhuriParams(FitParams):
    """Chaudhuri has the limits of every fit and no parameters of its own."""


def chaudhuri(
    points: npt.ArrayLike,
    *,
    params: ChaudhuriParams | None = None,
    weights: npt.ArrayLike | None = None,
) -> EllipseFit:
    """Fit an ellipse about the centroid of the points and along their principal axes.

    Centre: the mean. Direction: that of the least sum of squared distances to a line through the
    mean. Axes: least squares of X^2 / a^2 + Y^2 / b^2 = 1 in 1 / a^2 and 1 / b^2, X and Y along
    the principal axes. It fits any cluster and is exact only for points spread evenly and
    symmetrically about the whole outline: an arc gets an ellipse about its own middle. Assumed:
    the centroid is that of the border points, not of the region that they enclose.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least five distinct ones.
    params : ChaudhuriParams, optional
    weights : (n,) array, optional
        Weights of at least 0, not all 0; by default 1 each.

    Returns
    -------
    EllipseFit
        With the conic and the residual that every method here returns, see `nsaf`.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array, or the weights not (n,) of at least 0.

    References
    ----------
    D. Chaudhuri, "A simple least squares method for fitting of ellipses and circles depends on
    border points of a two-tone image and their 3-D extensions", Pattern Recognition Letters 31,
    2010; thesis 4.5.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(30) * (2 * np.pi / 30)
    >>> fit = chaudhuri(np.stack([50 + 20 * np.cos(t), 40 + 10 * np.sin(t)], axis=1))
    >>> round(fit.ellipse.semi_major, 6), round(fit.ellipse.semi_minor, 6)
    (20.0, 10.0)
    """
    limits = as_params(params, ChaudhuriParams)
    return fit_by(pencil_points, points, weights, limits, CHAUDHURI)
