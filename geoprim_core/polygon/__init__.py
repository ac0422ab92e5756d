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
from geoprim_core.polygon.bounds import deviation_bound, slope_bound
from geoprim_core.polygon.optimal import OptimalParams, optimal
from geoprim_core.polygon.rdp_mod import RdpModParams, farthest_pair, rdp_mod, rdp_mod_batch
from geoprim_core.types import Contours, Polygons

__all__ = [
    "TABLE",
    "BlurredSegmentsParams",
    "OptimalParams",
    "RdpModParams",
    "approximate",
    "blurred_segments",
    "deviation_bound",
    "farthest_pair",
    "optimal",
    "rdp_mod",
    "slope_bound",
]

TABLE = Table(
    "polygon",
    Method(
        "rdp_mod",
        rdp_mod,
        RdpModParams,
        "Prasad, Leung, Quek and Cho, Image and Vision Computing 30, 2012; thesis 2.5.1.2",
    ),
    Method(
        "optimal",
        optimal,
        OptimalParams,
        "Perez and Vidal, Pattern Recognition Letters 15, 1994; thesis 2.6.1",
    ),
    Method(
        "blurred_segments",
        blurred_segments,
        BlurredSegmentsParams,
        "Nguyen and Debled-Rennesson, Pattern Recognition 44, 2011; thesis 2.6.7",
    ),
)

# Methods that treat all contours in one kernel call; the others are called once a contour.
_BATCHES: dict[str, Callable[..., tuple[IntArray, IntArray]]] = {"rdp_mod": rdp_mod_batch}


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
        raise InputError("contours", "a Contours", describe(contours))
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
