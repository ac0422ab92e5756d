"""LR1 to LR5: a polynomial of order 1 to 5 fitted to the window by linear regression."""

from __future__ import annotations

import numpy.typing as npt

from geoprim_core._check import FloatArray
from geoprim_core.tangent.windows import REGRESSIONS, WindowParams, window_curve


def lr1(
    points: npt.ArrayLike, *, closed: bool = False, params: WindowParams | None = None
) -> FloatArray:
    """Estimate the direction of travel by the line of least squares through a window.

    The coordinates u, v of the window run along its principal axis and across; v(u) is a
    polynomial of order N (LR1: of order 1, LR2: 2, ...) with the least sum of squares, and the
    direction is that of its tangent at the pixel. Where the window holds too few different u,
    the order falls.

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
        than the closed curve, spreads as far in all directions, or where the line runs across
        the way of travel.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array.

    References
    ----------
    F. Cazals and M. Pouget, "Estimating differential quantities using polynomial fitting of
    osculating jets", Computer Aided Geometric Design 22, 2005 (frame of principal axes);
    thesis 3.6.1, method 1. The thesis names no axes. Those of the image would make LR2 the
    explicit parabola, which it measures as another method.

    Examples
    --------
    >>> line = [(i, 2 * i) for i in range(9)]
    >>> lr1(line, params=WindowParams(half_window=4)).round(4).tolist()
    [nan, nan, nan, nan, 1.1071, nan, nan, nan, nan]
    """
    return window_curve(points, closed, params, REGRESSIONS[0])[0]


def lr2(
    points: npt.ArrayLike, *, closed: bool = False, params: WindowParams | None = None
) -> FloatArray:
    """Estimate the direction of travel by a parabola along the principal axis; as `lr1`.

    Examples
    --------
    >>> line = [(i, 2 * i) for i in range(9)]
    >>> float(lr2(line, params=WindowParams(half_window=4))[4].round(4))
    1.1071
    """
    return window_curve(points, closed, params, REGRESSIONS[1])[0]


def lr3(
    points: npt.ArrayLike, *, closed: bool = False, params: WindowParams | None = None
) -> FloatArray:
    """Estimate the direction of travel by a polynomial of order 3; as `lr1`."""
    return window_curve(points, closed, params, REGRESSIONS[2])[0]


def lr4(
    points: npt.ArrayLike, *, closed: bool = False, params: WindowParams | None = None
) -> FloatArray:
    """Estimate the direction of travel by a polynomial of order 4; as `lr1`."""
    return window_curve(points, closed, params, REGRESSIONS[3])[0]


def lr5(
    points: npt.ArrayLike, *, closed: bool = False, params: WindowParams | None = None
) -> FloatArray:
    """Estimate the direction of travel by a polynomial of order 5; as `lr1`."""
    return window_curve(points, closed, params, REGRESSIONS[4])[0]
