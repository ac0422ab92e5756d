"""Matas: the median of the directions from and to the pixels of the window."""

from __future__ import annotations

import numpy.typing as npt

from geoprim_core._check import FloatArray
from geoprim_core.tangent.windows import MATAS, WindowParams, window_curve


def matas(
    points: npt.ArrayLike, *, closed: bool = False, params: WindowParams | None = None
) -> FloatArray:
    """Estimate the direction of travel by median filtered differencing.

    The directions from the Q pixels before to the pixel, and from the pixel to the Q ones behind
    it, are sorted by their turn from the window's way of travel; the mean of the two in the
    middle is the direction.

    Parameters
    ----------
    points : (n, 2) array
        Pixels of the curve in order.
    closed : bool
        Whether the last pixel touches the first.
    params : WindowParams, optional

    Returns
    -------
    (n,) float64
        Angles in radians in (-pi, pi]. NaN where the window reaches beyond an end, is longer
        than the closed curve, or goes nowhere.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array.

    References
    ----------
    J. Matas, Z. Shao and J. Kittler, "Estimation of curvature and tangent direction by median
    filtered differencing", LNCS 974, 1995; thesis 3.6.1, method 6. A number of angles on a
    circle has a median only about some direction: here that of the sum of q p(q).

    Examples
    --------
    >>> line = [(2 * i, i) for i in range(9)]
    >>> float(matas(line, params=WindowParams(half_window=4))[4].round(4))
    0.4636
    """
    return window_curve(points, closed, params, MATAS)[0]
