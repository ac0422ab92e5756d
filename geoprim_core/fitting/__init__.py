"""Ellipse fitting and the geometry of ellipses (thesis chapter 4, (5-9))."""

from __future__ import annotations

from typing import cast

import numpy.typing as npt

from geoprim_core.fitting.conic import conic_from_ellipse, ellipse_from_conic
from geoprim_core.fitting.distance import distance_to_ellipse
from geoprim_core.fitting.ellifit import EllifitParams, ellifit
from geoprim_core.fitting.geometric import GeometricFit, fit_geometric
from geoprim_core.fitting.moments import Moments, fit_moments, point_moments
from geoprim_core.fitting.nsaf import NsafParams, nsaf
from geoprim_core.fitting.overlap import overlap_matrix, overlap_ratio
from geoprim_core.fitting.shape import ellipse_boxes, outline_points, perimeter, point_at
from geoprim_core.methods import Method, Table
from geoprim_core.params import Params, as_params
from geoprim_core.types import EllipseFit

__all__ = [
    "TABLE",
    "EllifitParams",
    "GeometricFit",
    "Moments",
    "NsafParams",
    "conic_from_ellipse",
    "distance_to_ellipse",
    "ellifit",
    "ellipse_boxes",
    "ellipse_from_conic",
    "fit_ellipse",
    "fit_geometric",
    "fit_moments",
    "nsaf",
    "outline_points",
    "overlap_matrix",
    "overlap_ratio",
    "perimeter",
    "point_at",
    "point_moments",
]

TABLE = Table(
    "fitting",
    Method(
        "nsaf",
        nsaf,
        NsafParams,
        "Fitzgibbon, Pilu and Fisher, IEEE Trans. PAMI 21, 1999; thesis 4.2.2",
    ),
    Method(
        "ellifit",
        ellifit,
        EllifitParams,
        "Prasad, Leung and Quek, Pattern Recognition 46, 2013; thesis 4.4",
    ),
)


def fit_ellipse(
    points: npt.ArrayLike, method: str = "ellifit", params: Params | None = None
) -> EllipseFit:
    """Fit an ellipse to points.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels.
    method : str
        A name of `TABLE`.
    params : Params, optional
        Of the method's class.

    Returns
    -------
    EllipseFit
        With an ellipse, or with None and the reason.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array.
    ParameterError
        The method is unknown or the parameters are of another class.

    References
    ----------
    Thesis chapter 4.

    Examples
    --------
    >>> fit_ellipse([(0, 0), (1, 1), (2, 2)]).reason
    'fewer than five distinct points'
    >>> circle = [(5, 0), (0, 5), (-5, 0), (0, -5), (3, 4), (4, 3)]
    >>> round(fit_ellipse(circle, "nsaf").ellipse.semi_minor, 9)
    5.0
    """
    row = TABLE[method]
    return cast(EllipseFit, row.function(points, params=as_params(params, row.params)))
