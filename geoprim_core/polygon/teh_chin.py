"""Teh-Chin: dominant points by significance over each point's own region of support."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import IntArray
from geoprim_core.params import Params, as_params, option
from geoprim_core.polygon._kernels import farthest_pair_of
from geoprim_core.polygon._kernels_teh_chin import teh_chin_of

MEASURES = ("k_cosine", "1_curvature")


@dataclass(frozen=True)
class TehChinParams(Params):
    """Parameters of Teh and Chin's method."""

    measure: str = option(
        "k_cosine", "significance: angle over the region of support, or of the next points",
        choices=MEASURES,
    )  # fmt: skip
    support: int = option(
        250,
        "largest half width of a region of support; bounds the time",
        unit="points",
        low=1,
        high=1000000,
    )


def teh_chin(
    points: npt.ArrayLike, *, closed: bool = False, params: TehChinParams | None = None
) -> IntArray:
    """Find the dominant points of a digital curve without any tolerance to choose.

    The region of support of a point, k points on either side, grows until its chord l or the
    ratio d / l of the point's distance from it does so no longer. A point stays if no other
    within k / 2 has a higher significance; points where the curve goes straight on go; of
    neighbours, those of k = 1 that are not strictly higher go; of two neighbours the higher
    stays (of equal ones that of the larger region, else the first), of a longer group its ends.

    The significance is 1 plus the cosine of the angle at the point. The last of the four passes
    is applied with either measure. The regions of an open curve end at its ends, which stay. A
    closed curve with fewer than two dominant points has its two mutually farthest points.

    Parameters
    ----------
    points : (n, 2) array
        Pixels of the curve in order; the first is not repeated at the end.
    closed : bool
        Whether the last pixel touches the first.
    params : TehChinParams, optional

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
    C.-H. Teh and R. T. Chin, "On the detection of dominant points on digital curves", IEEE
    Trans. Pattern Analysis and Machine Intelligence 11, 1989.

    Examples
    --------
    >>> corner = [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (4, 1), (4, 2), (4, 3), (4, 4)]
    >>> teh_chin(corner).tolist()
    [0, 4, 8]
    """
    chosen: TehChinParams = as_params(params, TehChinParams)
    curve = _check.points(points)
    if len(curve) < 3:
        return np.arange(len(curve))
    one_step = chosen.measure == "1_curvature"
    dominant = teh_chin_of(curve, bool(closed), one_step, chosen.support)
    if not closed:
        dominant[[0, -1]] = True
    elif np.count_nonzero(dominant) < 2:
        dominant[list(farthest_pair_of(curve))] = True
    return np.flatnonzero(dominant)
