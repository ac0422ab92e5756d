"""Ellipses and conics: a x^2 + b x y + c y^2 + d x + f y + g = 0, thesis (4-1)."""

from __future__ import annotations

import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray
from geoprim_core.fitting._kernels_conic import conic_of, ellipse_of
from geoprim_core.fitting._kernels_fit import OK
from geoprim_core.fitting._outcome import REASONS
from geoprim_core.fitting.shape import ellipse_row
from geoprim_core.types import Ellipse, EllipseFit


def conic_from_ellipse(ellipse: Ellipse, origin: tuple[float, float] = (0.0, 0.0)) -> FloatArray:
    """Return the conic (6,) a, b, c, d, f, g of an ellipse, scaled to -1 at its centre.

    It is negative inside and positive outside, and the same for every choice of angle of a
    circle. Its coordinates are x - origin[0], y - origin[1]: near the ellipse its six numbers
    know more digits of it.

    Raises
    ------
    InputError
        The argument is not an Ellipse, or the origin not two finite numbers.

    References
    ----------
    Thesis (4-1).

    Examples
    --------
    >>> conic_from_ellipse(Ellipse(0, 0, 2, 1, 0)).tolist()
    [0.25, 0.0, 1.0, -0.0, -0.0, -1.0]
    """
    row = ellipse_row(ellipse)
    row[:2] -= _check.finite(origin, "origin", (2,))
    conic: FloatArray = conic_of(row)
    return conic


def ellipse_from_conic(
    conic: npt.ArrayLike, origin: tuple[float, float] = (0.0, 0.0)
) -> EllipseFit:
    """Return the ellipse of a conic of any scale and sign, or the reason why it has none.

    A circle has the angle 0. The centre comes out of differences of the coefficients, so an
    ellipse of semi-minor axis b at a distance r from the origin loses a factor of about
    (r / b)^2 of the number's precision, a thin one another factor (a / b)^2.

    Parameters
    ----------
    conic : (6,) array
        a, b, c, d, f, g of thesis (4-1) in pixels.
    origin : (x0, y0)
        Where the conic's coordinates have their zero, in pixels.

    Returns
    -------
    EllipseFit
        With the conic, about the same origin, scaled to -1 at the centre; its residual is NaN,
        as there are no points.

    Raises
    ------
    InputError
        The conic is not six finite numbers, or the origin not two.

    References
    ----------
    Thesis (4-1), (4-41) - (4-46); errata E1 - E3.

    Examples
    --------
    >>> ellipse_from_conic([1, 0, 4, 0, 0, -4]).ellipse
    Ellipse(x=0.0, y=0.0, semi_major=2.0, semi_minor=1.0, angle=0.0)
    >>> ellipse_from_conic([1, 0, -1, 0, 0, -1]).reason
    'the conic is a hyperbola'
    """
    coefficients = _check.finite(conic, "conic", (6,))
    status, row = ellipse_of(coefficients)
    if status != OK:
        return EllipseFit(None, REASONS[status].replace("best conic", "conic"))
    own = conic_of(row)
    row[:2] += _check.finite(origin, "origin", (2,))
    return EllipseFit(Ellipse(*row.tolist()), "", own)
