"""GD: the derivative of the curve smoothed by a Gaussian."""

from __future__ import annotations

import numpy.typing as npt

from geoprim_core._check import FloatArray
from geoprim_core.tangent.windows import GAUSSIAN_DERIVATIVE, WindowParams, window_curve


def gaussian_derivative(
    points: npt.ArrayLike, *, closed: bool = False, params: WindowParams | None = None
) -> FloatArray:
    """Estimate the direction of travel by convolving x(q) and y(q) with a Gaussian's derivative.

    q is the pixel number from -Q to Q about the pixel.

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
        than the closed curve, or where both derivatives are 0.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array.

    References
    ----------
    M. Worring and A. W. M. Smeulders, "Digital curvature estimation", CVIU 58, 1993; F.
    Mokhtarian and A. Mackworth, IEEE Trans. PAMI 8, 1986; thesis 3.6.1, method 5. The thesis
    gives no standard deviation; it is Q / 3 here, as in the program ImaGene of de Vieilleville
    and Lachaud, so that the window ends at three of them.

    Examples
    --------
    >>> line = [(2 * i, i) for i in range(9)]
    >>> float(gaussian_derivative(line, params=WindowParams(half_window=4))[4].round(4))
    0.4636
    """
    return window_curve(points, closed, params, GAUSSIAN_DERIVATIVE)[0]
