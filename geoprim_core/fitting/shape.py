"""The shape of an ellipse: length, points on the outline, bounding box."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray
from geoprim_core.errors import InputError
from geoprim_core.fitting._kernels_shape import boxes_of, perimeter_of, points_at
from geoprim_core.types import Ellipse, Ellipses


def ellipse_row(ellipse: Ellipse, argument: str = "ellipse") -> FloatArray:
    """Return an ellipse as the row (5,) x, y, semi_major, semi_minor, angle that kernels take.

    Raises
    ------
    InputError
        The argument is not an Ellipse.

    Examples
    --------
    >>> ellipse_row(Ellipse(1, 2, 4, 3, 0.5)).tolist()
    [1.0, 2.0, 4.0, 3.0, 0.5]
    """
    if not isinstance(ellipse, Ellipse):
        raise InputError(argument, "an Ellipse", _check.describe(ellipse))
    values = (ellipse.x, ellipse.y, ellipse.semi_major, ellipse.semi_minor, ellipse.angle)
    return np.array(values, dtype=np.float64)


def perimeter(ellipse: Ellipse) -> float:
    """Return the length of the outline in pixels, exact up to rounding.

    Raises
    ------
    InputError
        The argument is not an Ellipse.

    References
    ----------
    Complete elliptic integral of the second kind by the arithmetic-geometric mean:
    M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, 17.6.

    Examples
    --------
    >>> round(perimeter(Ellipse(0, 0, 1, 1, 0)) / np.pi, 12)
    2.0
    """
    row = ellipse_row(ellipse)
    return float(perimeter_of(row[2], row[3]))


def point_at(ellipse: Ellipse, parameter: npt.ArrayLike) -> FloatArray:
    """Return the points of the outline at given eccentric angles.

    Parameters
    ----------
    ellipse : Ellipse
    parameter : float or (n,) array
        Eccentric angle in radians: 0 is the end of the semi-major axis at the ellipse's angle,
        pi / 2 the end of the semi-minor axis a quarter turn from +x towards +y later.

    Returns
    -------
    (2,) or (n, 2) float64
        Points in pixels.

    Raises
    ------
    InputError
        A parameter is not finite, or the ellipse is not an Ellipse.

    Examples
    --------
    >>> point_at(Ellipse(5, 5, 3, 2, 0), [0.0, np.pi / 2]).round(12).tolist()
    [[8.0, 5.0], [5.0, 7.0]]
    """
    row = ellipse_row(ellipse)
    single = np.ndim(parameter) == 0
    values = _check.finite([parameter] if single else parameter, "parameter", (None,))
    points: FloatArray = points_at(row, values)
    return points[0] if single else points


def outline_points(ellipse: Ellipse, count: int) -> FloatArray:
    """Return points (count, 2) of the outline at evenly spaced eccentric angles from 0 on.

    Raises
    ------
    InputError
        The count is not a whole number of at least 1, or the ellipse is not an Ellipse.

    Examples
    --------
    >>> outline_points(Ellipse(0, 0, 2, 1, 0), 4).round(12).tolist()
    [[2.0, 0.0], [0.0, 1.0], [-2.0, 0.0], [-0.0, -1.0]]
    """
    if isinstance(count, bool) or not isinstance(count, int | np.integer) or count < 1:
        raise InputError("count", "a whole number of at least 1", _check.describe(count))
    return point_at(ellipse, np.arange(count) * (2 * np.pi / count))


def ellipse_boxes(ellipses: Ellipses) -> FloatArray:
    """Return the tight boxes (n, 4) of ellipses: x_min, y_min, x_max, y_max in pixels.

    Raises
    ------
    InputError
        The argument is not an Ellipses.

    Examples
    --------
    >>> ellipse_boxes(Ellipses([5], [5], [3], [2], [0])).tolist()
    [[2.0, 3.0, 8.0, 7.0]]
    """
    if not isinstance(ellipses, Ellipses):
        raise InputError("ellipses", "an Ellipses", _check.describe(ellipses))
    boxes: FloatArray = boxes_of(np.ascontiguousarray(ellipses.array()))
    return boxes
