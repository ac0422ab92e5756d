"""EPF, IPF and ICIPF: a parabola fitted to the window, free, through its pixel, or per axis."""

from __future__ import annotations

import numpy.typing as npt

from geoprim_core._check import FloatArray
from geoprim_core.tangent.windows import EPF, ICIPF, IPF, WindowParams, window_curve


def epf(
    points: npt.ArrayLike, *, closed: bool = False, params: WindowParams | None = None
) -> FloatArray:
    """Estimate the direction of travel by explicit parabola fitting.

    A parabola y(x) of least squares is fitted to the window, or x(y) where that extends farther
    in y; where it extends as far in both, the mean of both directions counts.

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
        than the closed curve, or where the fitted axis runs across the way of travel.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array.

    References
    ----------
    F. de Vieilleville and J.-O. Lachaud, "Comparison and improvement of tangent estimators on
    digital curves", Pattern Recognition 42, 2009; thesis 3.6.1, method 2.

    Examples
    --------
    >>> parabola = [(i, i * i / 10) for i in range(-3, 4)]
    >>> epf(parabola, params=WindowParams(half_window=1)).round(4)[[2, 3]].tolist()
    [-0.1974, 0.0]
    """
    return window_curve(points, closed, params, EPF)[0]


def ipf(
    points: npt.ArrayLike, *, closed: bool = False, params: WindowParams | None = None
) -> FloatArray:
    """Estimate the direction of travel by implicit parabola fitting.

    As `epf`, but the parabola passes through the pixel itself, which is the origin.

    References
    ----------
    T. Lewiner, J. D. Gomes, H. Lopes and M. Craizer, "Curvature and torsion estimators based on
    parametric curve fitting", Computers and Graphics 29, 2005; thesis 3.6.1, method 3.

    Examples
    --------
    >>> line = [(2 * i, i) for i in range(9)]
    >>> float(ipf(line, params=WindowParams(half_window=4))[4].round(4))
    0.4636
    """
    return window_curve(points, closed, params, IPF)[0]


def icipf(
    points: npt.ArrayLike, *, closed: bool = False, params: WindowParams | None = None
) -> FloatArray:
    """Estimate the direction of travel by independent-coordinate implicit parabola fitting.

    x and y are each a parabola of the pixel number q = -Q .. Q through the pixel; the direction
    is that of their derivatives at q = 0. NaN where both are 0. Otherwise as `epf`.

    References
    ----------
    T. Lewiner, J. D. Gomes, H. Lopes and M. Craizer, "Curvature and torsion estimators based on
    parametric curve fitting", Computers and Graphics 29, 2005; thesis 3.6.1, method 4, whose
    parameter l is taken as the pixel number.

    Examples
    --------
    >>> line = [(2 * i, i) for i in range(9)]
    >>> float(icipf(line, params=WindowParams(half_window=4))[4].round(4))
    0.4636
    """
    return window_curve(points, closed, params, ICIPF)[0]
