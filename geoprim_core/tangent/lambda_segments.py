"""Lambda-MST and lambda-MSG: the weighted mean direction of the maximal segments at a pixel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core._check import FloatArray
from geoprim_core.params import Params, as_params, option
from geoprim_core.tangent._kernels_lambda import pencil_sums
from geoprim_core.tangent.pencils import pencils_of

_NOWHERE = 1e-9


@dataclass(frozen=True)
class LambdaMstParams(Params):
    """Parameters of lambda-MST."""

    floor: float = option(
        0.0, "added to the triangle function; the thesis compares with 0.4", low=0.0, high=100.0
    )


@dataclass(frozen=True)
class LambdaMsgParams(Params):
    """Parameters of lambda-MSG."""

    sigma: float = option(
        1.0 / 6.0, "standard deviation of the Gaussian, in segment lengths", low=0.01, high=10.0
    )


def lambda_mst(
    points: npt.ArrayLike, *, closed: bool = False, params: LambdaMstParams | None = None
) -> FloatArray:
    """Estimate the direction of travel by the lambda maximal segment tangent, triangle function.

    The maximal digital straight segments that hold the pixel are averaged, each in the direction
    of travel and with the weight of the pixel's eccentricity e in it: 1 - |2 e - 1|, 1 in the
    middle of the segment and 0 at its ends. e is taken at the middle of the pixel's share of
    the segment, so that no weight is 0. Without a floor a convex curve gets directions that
    turn one way.

    Parameters
    ----------
    points : (n, 2) array
        Pixels of the curve in order, whole numbers; left out ones are put on straight lines.
    closed : bool
        Whether the last pixel touches the first.
    params : LambdaMstParams, optional

    Returns
    -------
    (n,) float64
        Angles in radians in (-pi, pi]. NaN on a curve of one pixel and where the segments
        cancel.

    Raises
    ------
    InputError
        The points are not whole numbers, or a step is longer than 1000 px.

    References
    ----------
    J.-O. Lachaud, A. Vialard and F. de Vieilleville, "Fast, accurate and convergent tangent
    estimation on digital contours", Image and Vision Computing 25, 2007; thesis 3.6.1, method 7;
    errata T5 (directions of travel; "tangent function" there is the triangle function). Unit
    vectors are averaged, the paper averages angles: nothing to unwrap.

    Examples
    --------
    >>> corner = [(0, 0), (1, 0), (2, 0), (3, 1), (3, 2), (3, 3)]
    >>> lambda_mst(corner).round(3).tolist()
    [0.322, 0.322, 0.54, 1.03, 1.249, 1.249]
    """
    checked: LambdaMstParams = as_params(params, LambdaMstParams)
    return _directions(points, closed, checked.floor, 0.0)


def lambda_msg(
    points: npt.ArrayLike, *, closed: bool = False, params: LambdaMsgParams | None = None
) -> FloatArray:
    """Estimate the direction of travel by the lambda maximal segment tangent, Gaussian function.

    As `lambda_mst` with the weight exp(-(e - 1/2)^2 / (2 sigma^2)).

    References
    ----------
    As `lambda_mst`. The thesis gives no sigma; a sixth puts the ends of a segment at three
    standard deviations.

    Examples
    --------
    >>> lambda_msg([(0, 0), (1, 0), (2, 0), (3, 0)]).tolist()
    [0.0, 0.0, 0.0, 0.0]
    """
    checked: LambdaMsgParams = as_params(params, LambdaMsgParams)
    return _directions(points, closed, 0.0, checked.sigma)


def _directions(points: npt.ArrayLike, closed: bool, floor: float, sigma: float) -> FloatArray:
    pencils = pencils_of(points, closed=closed)
    s = pencils.segments
    sums = pencil_sums(s.start, s.end, s.a, s.b, pencils.count, floor, sigma)
    if pencils.before is not pencils.behind:
        sums = sums[pencils.before] + sums[pencils.behind]
    else:
        sums = sums[pencils.before]
    angle = np.arctan2(sums[:, 1], sums[:, 0])
    angle[np.hypot(sums[:, 0], sums[:, 1]) <= _NOWHERE * sums[:, 2]] = np.nan
    angle[angle == -np.pi] = np.pi
    result: FloatArray = angle
    return result
