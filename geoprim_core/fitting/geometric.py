"""Geometric fit: the ellipse of least squared orthogonal distance, with its covariance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray
from geoprim_core.errors import InputError
from geoprim_core.fitting._kernels_distance import refine_kernel
from geoprim_core.fitting._kernels_geometric import geometric_points
from geoprim_core.fitting._outcome import fit_by
from geoprim_core.fitting.fit_params import FitParams
from geoprim_core.fitting.shape import ellipse_row
from geoprim_core.params import as_params, option
from geoprim_core.types import Ellipse, EllipseFit


@dataclass(frozen=True)
class GeometricParams(FitParams):
    """The steps and the cost."""

    iterations: int = option(100, "largest number of steps", low=1, high=10000)
    huber: float = option(
        0.0, "distance beyond which a point's cost grows linearly; 0: never", unit="px", low=0.0
    )


def geometric(
    points: npt.ArrayLike,
    *,
    params: GeometricParams | None = None,
    weights: npt.ArrayLike | None = None,
) -> EllipseFit:
    """Fit the ellipse of least squared orthogonal distance by damped Gauss-Newton steps.

    It starts at the direct fit or at Taubin's, whichever lies nearer to the points. Where the
    steps do not settle, as on points of a parabola whose best ellipse has no end, the reason says
    so. `fit_geometric` starts at an ellipse of one's own and tells the covariance and the mean
    distance; `fit_covariance` tells the covariance of this fit.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least five distinct ones.
    params : GeometricParams, optional
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
    W. Gander, G. H. Golub and R. Strebel, "Least-squares fitting of circles and ellipses",
    BIT 34, 1994; the distance of thesis (4-21).

    Examples
    --------
    >>> t = np.linspace(0, 4, 30)
    >>> fit = geometric(np.stack([50 + 20 * np.cos(t), 40 + 10 * np.sin(t)], axis=1))
    >>> round(fit.ellipse.semi_major, 6), round(fit.ellipse.semi_minor, 6)
    (20.0, 10.0)
    """
    settings = as_params(params, GeometricParams)
    huber = settings.huber or float("inf")
    return fit_by(geometric_points, points, weights, settings, settings.iterations, huber)


@dataclass(frozen=True, slots=True, eq=False)
class GeometricFit:
    """The outcome of a geometric fit.

    Attributes
    ----------
    ellipse : Ellipse
    covariance : (5, 5) float64
        Covariance of x, y, semi_major, semi_minor (pixels) and angle (radians), from the
        scatter of the residuals; NaN with five points or fewer. The angle of a circle has the
        variance pi^2 / 12 of an unknown direction.
    rms : float
        Root mean square orthogonal distance in pixels, weighted.
    settled : bool
        Whether the steps ended because nothing improved any more.
    """

    ellipse: Ellipse
    covariance: FloatArray
    rms: float
    settled: bool


def fit_geometric(
    points: npt.ArrayLike,
    start: Ellipse,
    weights: npt.ArrayLike | None = None,
    iterations: int = 20,
    huber: float = float("inf"),
) -> GeometricFit:
    """Refine an ellipse to the least weighted sum of squared orthogonal distances.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least five.
    start : Ellipse
        Where the damped Gauss-Newton steps begin, from an algebraic fit for instance.
    weights : (n,) array, optional
        Weights of at least 0, not all 0; by default 1.
    iterations : int
        Largest number of steps.
    huber : float
        Distance in pixels beyond which a point's cost grows linearly (Huber); by default none.

    Returns
    -------
    GeometricFit

    Raises
    ------
    InputError
        An argument is of a wrong kind, shape or range, or there are fewer than five points.

    References
    ----------
    W. Gander, G. H. Golub and R. Strebel, "Least-squares fitting of circles and ellipses",
    BIT 34, 1994; S. J. Ahn, W. Rauh and H.-J. Warnecke, Pattern Recognition 34, 2001; the
    distance of thesis (4-21).

    Examples
    --------
    >>> t = np.linspace(0, 6, 60)
    >>> points = np.stack([50 + 20 * np.cos(t), 40 + 10 * np.sin(t)], axis=1)
    >>> fit = fit_geometric(points, Ellipse(51, 39, 22, 9, 0.1))
    >>> round(fit.ellipse.semi_major, 6), fit.settled
    (20.0, True)
    """
    cloud = _check.points(points)
    if len(cloud) < 5:
        raise InputError("points", "at least five points", f"{len(cloud)}")
    if isinstance(iterations, bool) or not isinstance(iterations, int) or iterations < 0:
        raise InputError("iterations", "a whole number of at least 0", _check.describe(iterations))
    if not huber > 0:
        raise InputError("huber", "a positive distance", _check.describe(huber))
    row, covariance, rms, settled = refine_kernel(
        cloud, _weights(weights, len(cloud)), ellipse_row(start, "start"), iterations, float(huber)
    )
    ellipse = Ellipse(*(float(value) for value in row))
    return GeometricFit(ellipse, covariance, float(rms), bool(settled))


def _weights(weights: npt.ArrayLike | None, count: int) -> FloatArray:
    if weights is None:
        return np.ones(count)
    checked = _check.finite(weights, "weights", (count,))
    if (checked < 0).any() or (checked > 0).sum() < 5:
        raise InputError("weights", "numbers of at least 0, five of them positive", "others")
    return checked
