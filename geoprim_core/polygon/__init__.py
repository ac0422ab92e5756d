"""Polygonal approximation of digital curves: indices of dominant points (thesis chapter 2)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from geoprim_core._check import IntArray, describe
from geoprim_core.errors import InputError
from geoprim_core.methods import Method, Table
from geoprim_core.params import Params, as_params
from geoprim_core.polygon.blurred_segments import BlurredSegmentsParams, blurred_segments
from geoprim_core.polygon.bounds import deviation_bound, dss_bound, slope_bound, tan_bound
from geoprim_core.polygon.break_points import BreakPointsParams, break_points
from geoprim_core.polygon.carmona import CarmonaParams, carmona
from geoprim_core.polygon.carmona_mod import CarmonaModParams, carmona_mod
from geoprim_core.polygon.lowe import LoweParams, lowe
from geoprim_core.polygon.masood import MasoodParams, masood
from geoprim_core.polygon.masood_mod import MasoodModParams, masood_mod
from geoprim_core.polygon.optimal import OptimalParams, optimal
from geoprim_core.polygon.params import PolygonParams
from geoprim_core.polygon.pro import ProParams, pro, pro_batch
from geoprim_core.polygon.rdp import RdpParams, rdp, rdp_batch
from geoprim_core.polygon.rdp_mod import RdpModParams, farthest_pair, rdp_mod, rdp_mod_batch
from geoprim_core.polygon.teh_chin import TehChinParams, teh_chin
from geoprim_core.polygon.visvalingam import VisvalingamParams, visvalingam
from geoprim_core.types import Contours, Polygons

__all__ = [
    "TABLE",
    "BlurredSegmentsParams",
    "BreakPointsParams",
    "CarmonaModParams",
    "CarmonaParams",
    "LoweParams",
    "MasoodModParams",
    "MasoodParams",
    "OptimalParams",
    "PolygonParams",
    "ProParams",
    "RdpModParams",
    "RdpParams",
    "TehChinParams",
    "VisvalingamParams",
    "approximate",
    "blurred_segments",
    "break_points",
    "carmona",
    "carmona_mod",
    "deviation_bound",
    "dss_bound",
    "farthest_pair",
    "lowe",
    "masood",
    "masood_mod",
    "optimal",
    "pro",
    "rdp",
    "rdp_mod",
    "slope_bound",
    "tan_bound",
    "teh_chin",
    "visvalingam",
]

_FRAMEWORK = "Prasad, Leung, Quek and Cho, Image and Vision Computing 30, 2012; thesis "

TABLE = Table(
    "polygon",
    Method(
        "rdp",
        rdp,
        RdpParams,
        "Ramer, CGIP 1, 1972; Douglas and Peucker, Cartographica 10, 1973; thesis 2.5.1.1",
    ),
    Method("rdp_mod", rdp_mod, RdpModParams, _FRAMEWORK + "2.5.1.2"),
    Method("pro", pro, ProParams, "Prasad, Quek, Leung and Cho, ACPR 2011; thesis 2.3"),
    Method("masood", masood, MasoodParams, "Masood, Pattern Recognition 41, 2008; thesis 2.5.2.1"),
    Method("masood_mod", masood_mod, MasoodModParams, _FRAMEWORK + "2.5.2.2"),
    Method(
        "carmona",
        carmona,
        CarmonaParams,
        "Carmona-Poyato et al., Pattern Recognition 43, 2010; thesis 2.5.3.1",
    ),
    Method("carmona_mod", carmona_mod, CarmonaModParams, _FRAMEWORK + "2.5.3.2"),
    Method(
        "optimal",
        optimal,
        OptimalParams,
        "Perez and Vidal, Pattern Recognition Letters 15, 1994; thesis 2.6.1",
    ),
    Method("lowe", lowe, LoweParams, "Lowe, Artificial Intelligence 31, 1987; thesis 2.6.3"),
    Method(
        "blurred_segments",
        blurred_segments,
        BlurredSegmentsParams,
        "Nguyen and Debled-Rennesson, Pattern Recognition 44, 2011; thesis 2.6.7",
    ),
    Method(
        "break_points",
        break_points,
        BreakPointsParams,
        "Masood, Pattern Recognition 41, 2008; thesis 2.6.5",
    ),
    Method("teh_chin", teh_chin, TehChinParams, "Teh and Chin, IEEE Trans. PAMI 11, 1989"),
    Method(
        "visvalingam",
        visvalingam,
        VisvalingamParams,
        "Visvalingam and Whyatt, The Cartographic Journal 30, 1993",
    ),
)

# Methods that treat all contours in one kernel call; the others are called once a contour.
_BATCHES: dict[str, Callable[..., tuple[IntArray, IntArray]]] = {
    "rdp": rdp_batch,
    "rdp_mod": rdp_mod_batch,
    "pro": pro_batch,
}


def approximate(
    contours: Contours, method: str = "rdp_mod", params: Params | None = None
) -> Polygons:
    """Approximate every contour by a polygon.

    Parameters
    ----------
    contours : Contours
    method : str
        A name of `TABLE`.
    params : Params, optional
        Of the method's class.

    Returns
    -------
    Polygons
        One a contour, in the same order.

    Raises
    ------
    InputError
        The contours are not a Contours.
    ParameterError
        The method is unknown or the parameters are of another class.

    References
    ----------
    Thesis chapter 2.

    Examples
    --------
    >>> corner = [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (4, 1), (4, 2), (4, 3), (4, 4)]
    >>> approximate(Contours(corner, [0, 9], [False])).indices.tolist()
    [0, 4, 8]
    """
    if not isinstance(contours, Contours):
        expected = "a Contours (of bare points: Contours.from_curves([points]))"
        raise InputError("contours", expected, describe(contours))
    row = TABLE[method]
    checked = as_params(params, row.params)
    if method in _BATCHES:
        indices, offsets = _BATCHES[method](
            contours.points, contours.offsets, contours.closed, checked
        )
    else:
        indices, offsets = _one_by_one(contours, row, checked)
    return Polygons(indices, offsets, contours.closed, contours.image_size)


def _one_by_one(contours: Contours, row: Method, params: Any) -> tuple[IntArray, IntArray]:
    found = [
        row.function(curve, closed=bool(closed), params=params)
        for curve, closed in zip(contours, contours.closed, strict=True)
    ]
    counts = np.array([0, *(len(indices) for indices in found)], dtype=np.int64)
    return np.concatenate([np.zeros(0, np.int64), *found]), np.cumsum(counts)
