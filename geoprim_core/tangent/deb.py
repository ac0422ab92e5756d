"""DEB: tangents of definite error bound, from the chord that a circle cuts out of the curve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core.params import Params, as_params, option
from geoprim_core.tangent._kernels import deb_of


@dataclass(frozen=True)
class DebParams(Params):
    """Parameters of DEB."""

    radius: float = option(
        4.0, "radius of the circle around the pixel", unit="px", low=1.0, high=1000.0
    )


def deb(
    points: npt.ArrayLike, *, closed: bool = False, params: DebParams | None = None
) -> FloatArray:
    """Estimate the direction of travel at every pixel of a digital curve.

    The first pixel backwards (P1) and the first one forwards (P2) whose distance from the
    pixel is the radius up to 1 / sqrt(2) are joined; the direction is that from P1 to P2.

    Parameters
    ----------
    points : (n, 2) array
        Pixels of the curve in order.
    closed : bool
        Whether the last pixel touches the first.
    params : DebParams, optional

    Returns
    -------
    (n,) float64
        Angles in radians in (-pi, pi]. NaN where P1 or P2 does not exist, as near the ends of
        an open curve or on a closed one smaller than the circle, or where both coincide.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array.

    References
    ----------
    D. K. Prasad, M. K. H. Leung, C. Quek and M. S. Brown, "DEB: definite error bounded tangent
    estimator for digital curves", IEEE Transactions on Image Processing 23, 2014; thesis
    3.3.1, Figure 3.3-1 with its loop condition inverted: errata T1.

    Examples
    --------
    >>> line = [(i, i) for i in range(9)]
    >>> deb(line).round(4).tolist()
    [nan, nan, nan, 0.7854, 0.7854, 0.7854, nan, nan, nan]
    """
    curve = _check.points(points)
    flags = np.array([bool(closed)])
    return deb_batch(curve, np.array([0, len(curve)]), flags, as_params(params, DebParams))


def deb_batch(
    points: FloatArray, offsets: IntArray, closed: BoolArray, params: DebParams
) -> FloatArray:
    """Estimate the directions of many curves in one kernel call; arguments as in `Contours`.

    Returns
    -------
    (N,) float64
        As in `Tangents`.

    Examples
    --------
    >>> line = np.stack([np.arange(7.0), np.zeros(7)], axis=1)
    >>> float(deb_batch(line, np.array([0, 7]), np.array([False]), DebParams(radius=2.0))[3])
    0.0
    """
    angle: FloatArray = deb_of(points, offsets, closed, params.radius)
    return angle
