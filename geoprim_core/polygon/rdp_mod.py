"""RDP-mod: Ramer-Douglas-Peucker splitting with the digitisation bound as its tolerance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core.errors import InputError
from geoprim_core.params import Params, option
from geoprim_core.polygon._kernels import farthest_pair_of
from geoprim_core.polygon._kernels_split import split_curves
from geoprim_core.polygon._one_curve import of_one_curve
from geoprim_core.polygon.bounds import RULES, rule_number


@dataclass(frozen=True)
class RdpModParams(Params):
    """Parameters of RDP-mod.

    The default rule is the one that reproduces the published tables (errata P4).
    """

    bound: str = option("released", "rule for the largest deviation of a segment", choices=RULES)


def rdp_mod(
    points: npt.ArrayLike, *, closed: bool = False, params: RdpModParams | None = None
) -> IntArray:
    """Approximate a digital curve by a polygon without any tolerance to choose.

    A segment is split at its pixel of largest deviation until that is at most what the
    digitisation of a straight line can explain. An open curve keeps both ends. A closed one is
    first split at its two mutually farthest pixels, found on the convex hull by rotating
    calipers, so that the result does not depend on the start pixel unless several pairs tie.

    Parameters
    ----------
    points : (n, 2) array
        Pixels of the curve in order; the first is not repeated at the end.
    closed : bool
        Whether the last pixel touches the first.
    params : RdpModParams, optional

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
    D. K. Prasad, M. K. H. Leung, C. Quek and S.-Y. Cho, "A novel framework for making dominant
    point detection methods non-parametric", Image and Vision Computing 30, 2012; thesis
    2.5.1.2, (2-37), (2-53), (2-54); errata P4, P6.

    Examples
    --------
    >>> corner = [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (4, 1), (4, 2), (4, 3), (4, 4)]
    >>> rdp_mod(corner).tolist()
    [0, 4, 8]
    """
    return of_one_curve(rdp_mod_batch, points, closed, params, RdpModParams)


def rdp_mod_batch(
    points: FloatArray, offsets: IntArray, closed: BoolArray, params: RdpModParams
) -> tuple[IntArray, IntArray]:
    """Approximate many curves in one kernel call; arguments as in `Contours`.

    A curve that would cost a plain search more than a few looks at every point, a comb or a
    spiral, is searched through the convex hulls of its blocks, with the same result.

    Returns
    -------
    indices : (M,) int64
    offsets : (K + 1,) int64
        As in `Polygons`.

    Examples
    --------
    >>> import numpy as np
    >>> line = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    >>> indices, offsets = rdp_mod_batch(line, np.array([0, 3]), np.array([False]), RdpModParams())
    >>> indices.tolist(), offsets.tolist()
    ([0, 2], [0, 2])
    """
    result: tuple[IntArray, IntArray]
    result = split_curves(points, offsets, closed, rule_number(params.bound), 0.0)
    return result


def farthest_pair(points: npt.ArrayLike) -> tuple[int, int]:
    """Return the indices i <= j of the two points farthest apart, the lowest ones of ties.

    Raises
    ------
    InputError
        There is no point, or the points are not a finite (n, 2) array.

    References
    ----------
    M. I. Shamos, "Computational geometry", PhD thesis, Yale, 1978 (rotating calipers).

    Examples
    --------
    >>> farthest_pair([(0, 0), (3, 1), (5, 0), (2, 2)])
    (0, 2)
    """
    cloud = _check.points(points)
    if len(cloud) == 0:
        raise InputError("points", "at least one point", "none")
    first, second = farthest_pair_of(cloud)
    return int(first), int(second)
