"""Ellipse fitting and the geometry of ellipses (thesis chapter 4, (5-9))."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import numpy.typing as npt

from geoprim_core.fitting._outcome import checked_weights
from geoprim_core.fitting.ahn import AhnParams, ahn
from geoprim_core.fitting.batch import EllipseFits, fit_arrays, ragged
from geoprim_core.fitting.chaudhuri import ChaudhuriParams, chaudhuri
from geoprim_core.fitting.conic import conic_from_ellipse, ellipse_from_conic
from geoprim_core.fitting.covariance import fit_covariance
from geoprim_core.fitting.distance import distance_to_ellipse
from geoprim_core.fitting.ellifit import EllifitParams, ellifit
from geoprim_core.fitting.fit_params import FitParams
from geoprim_core.fitting.fitzgibbon import FitzgibbonParams, fitzgibbon
from geoprim_core.fitting.geometric import GeometricFit, GeometricParams, fit_geometric, geometric
from geoprim_core.fitting.halir_flusser import HalirFlusserParams, halir_flusser
from geoprim_core.fitting.harker import HarkerParams, harker
from geoprim_core.fitting.hyper import HyperParams, hyper
from geoprim_core.fitting.linear import LinearParams, linear
from geoprim_core.fitting.liu import LiuParams, liu
from geoprim_core.fitting.maini import MainiParams, maini
from geoprim_core.fitting.moments import Moments, fit_moments, point_moments
from geoprim_core.fitting.nsaf import NsafParams, nsaf
from geoprim_core.fitting.overlap import overlap_matrix, overlap_ratio
from geoprim_core.fitting.selective import SelectiveParams, selective
from geoprim_core.fitting.shape import ellipse_boxes, outline_points, perimeter, point_at
from geoprim_core.fitting.span import angular_span, eccentric_angles, tangent_at
from geoprim_core.fitting.taubin import TaubinParams, taubin
from geoprim_core.methods import Method, Table
from geoprim_core.params import Params, as_params
from geoprim_core.types import Contours, EllipseFit

__all__ = [
    "TABLE",
    "AhnParams",
    "ChaudhuriParams",
    "EllifitParams",
    "EllipseFits",
    "FitParams",
    "FitzgibbonParams",
    "GeometricFit",
    "GeometricParams",
    "HalirFlusserParams",
    "HarkerParams",
    "HyperParams",
    "LinearParams",
    "LiuParams",
    "MainiParams",
    "Moments",
    "NsafParams",
    "SelectiveParams",
    "TaubinParams",
    "ahn",
    "angular_span",
    "chaudhuri",
    "conic_from_ellipse",
    "distance_to_ellipse",
    "eccentric_angles",
    "ellifit",
    "ellipse_boxes",
    "ellipse_from_conic",
    "fit_covariance",
    "fit_ellipse",
    "fit_ellipses",
    "fit_geometric",
    "fit_moments",
    "fitzgibbon",
    "geometric",
    "halir_flusser",
    "harker",
    "hyper",
    "linear",
    "liu",
    "maini",
    "nsaf",
    "outline_points",
    "overlap_matrix",
    "overlap_ratio",
    "perimeter",
    "point_at",
    "point_moments",
    "selective",
    "tangent_at",
    "taubin",
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
    Method(
        "fitzgibbon",
        fitzgibbon,
        FitzgibbonParams,
        "Fitzgibbon, Pilu and Fisher, IEEE Trans. PAMI 21, 1999; thesis 4.2.1",
    ),
    Method("halir_flusser", halir_flusser, HalirFlusserParams, "Halir and Flusser, WSCG 1998"),
    Method(
        "harker",
        harker,
        HarkerParams,
        "Harker, O'Leary and Zsombor-Murray, Image and Vision Computing 26, 2008",
    ),
    Method("maini", maini, MainiParams, "Maini, Int. J. Pattern Recognition and AI 20, 2006"),
    Method(
        "chaudhuri", chaudhuri, ChaudhuriParams, "Chaudhuri, Pattern Recognition Letters 31, 2010"
    ),
    Method("liu", liu, LiuParams, "Liu and Qiao, Pattern Recognition 42, 2009"),
    Method("ahn", ahn, AhnParams, "Ahn, Rauh and Warnecke, Pattern Recognition 34, 2001"),
    Method("taubin", taubin, TaubinParams, "Taubin, IEEE Trans. PAMI 13, 1991"),
    Method(
        "hyper",
        hyper,
        HyperParams,
        "Kanatani and Rangarajan, Computational Statistics and Data Analysis 55, 2011",
    ),
    Method("linear", linear, LinearParams, "Rosin, Pattern Recognition Letters 14, 1993"),
    Method("geometric", geometric, GeometricParams, "Gander, Golub and Strebel, BIT 34, 1994"),
    Method(
        "selective",
        selective,
        SelectiveParams,
        "Taubin, IEEE Trans. PAMI 13, 1991, with a test against the parabola",
    ),
)


def fit_ellipse(
    points: npt.ArrayLike,
    method: str = "ellifit",
    params: Params | None = None,
    weights: npt.ArrayLike | None = None,
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
    weights : (n,) array, optional
        Weights of at least 0, not all 0; by default 1 each.

    Returns
    -------
    EllipseFit
        With an ellipse, or with None and the reason.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array, or the weights not (n,) of at least 0.
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
    settings = as_params(params, row.params)
    return cast(EllipseFit, row.function(points, params=settings, weights=weights))


def fit_ellipses(
    arcs: Contours | Sequence[npt.ArrayLike],
    method: str = "ellifit",
    params: Params | None = None,
    weights: npt.ArrayLike | None = None,
) -> EllipseFits:
    """Fit an ellipse to each of many arcs.

    Arcs and points may have any number; nothing is raised because of one arc's points.

    Parameters
    ----------
    arcs : Contours or sequence of (n, 2) arrays
        Of contours the sub-pixel positions are fitted where there are any.
    method : str
        A name of `TABLE`.
    params : Params, optional
        Of the method's class.
    weights : (N,) array, optional
        Weights of at least 0 of all points, in the order of the arcs; by default 1 each.

    Returns
    -------
    EllipseFits
        The ellipses, and for every arc a status, a reason and a residual.

    Raises
    ------
    InputError
        An arc is not a finite (n, 2) array, or the weights not (N,) of at least 0.
    ParameterError
        The method is unknown or the parameters are of another class.

    References
    ----------
    Thesis chapter 4.

    Examples
    --------
    >>> circle = [(5, 0), (0, 5), (-5, 0), (0, -5), (3, 4), (4, 3)]
    >>> fits = fit_ellipses([circle, [(0, 0), (1, 1)]], "halir_flusser")
    >>> fits.found.tolist(), fits.reasons[1]
    ([True, False], 'fewer than five distinct points')
    >>> round(fits[0].ellipse.semi_major, 9)
    5.0
    """
    row = TABLE[method]
    points, offsets = ragged(arcs)
    settings = as_params(params, row.params)
    return fit_arrays(points, offsets, checked_weights(weights, len(points)), method, settings)
