"""Visvalingam-Whyatt: the point of the smallest triangle with its neighbours goes first."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import IntArray
from geoprim_core.params import Params, as_params, option
from geoprim_core.polygon._kernels_visvalingam import visvalingam_of


@dataclass(frozen=True)
class VisvalingamParams(Params):
    """Parameters of Visvalingam and Whyatt's method."""

    area: float = option(4.0, "points of a smaller triangle go", unit="px^2", low=0.0, high=1e12)
    least: int = option(2, "no more points go when this many are left", low=2, high=1000000)


def visvalingam(
    points: npt.ArrayLike, *, closed: bool = False, params: VisvalingamParams | None = None
) -> IntArray:
    """Approximate a curve by dropping the points whose triangles are smallest.

    The triangle of a point with its two present neighbours is its effective area, at least that
    of the point dropped last. Points go in that order, of equal ones the first on the curve, as
    long as the area is below the limit. With an infinite area and `least` it gives a polygon of a
    wanted number of vertices. An open curve keeps both ends, a closed one its two mutually
    farthest points.

    Parameters
    ----------
    points : (n, 2) array
        Points of the curve in order, digital or not; the first is not repeated at the end.
    closed : bool
        Whether the last point leads back to the first.
    params : VisvalingamParams, optional

    Returns
    -------
    (m,) int64
        Indices of the dominant points, strictly increasing; empty for an empty curve.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array.

    References
    ----------
    M. Visvalingam and J. D. Whyatt, "Line generalisation by repeated elimination of points", The
    Cartographic Journal 30, 1993.

    Examples
    --------
    >>> roof = [(0, 0), (1, 0), (2, 0), (4, 3), (6, 0)]
    >>> visvalingam(roof).tolist(), visvalingam(roof, params=VisvalingamParams(area=2.5)).tolist()
    ([0, 3, 4], [0, 2, 3, 4])
    """
    chosen: VisvalingamParams = as_params(params, VisvalingamParams)
    indices: IntArray
    indices = visvalingam_of(_check.points(points), bool(closed), chosen.area, chosen.least)
    return indices
