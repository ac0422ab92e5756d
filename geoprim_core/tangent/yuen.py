"""Thesis 3.2.1: Yuen's centre of an ellipse from three points and their tangents."""

from __future__ import annotations

import numpy as np

from geoprim_core import _check
from geoprim_core._check import FloatArray
from geoprim_core.tangent._kernels_yuen import yuen_centre


def three_point_centre(points: FloatArray, angles: FloatArray) -> FloatArray | None:
    """Return the centre (2,) of the ellipse with three points and their tangents, or None.

    There is none where the tangents at the first two or the last two points are parallel, or
    where the two lines that meet in the centre are.

    Parameters
    ----------
    points : (3, 2) array
    angles : (3,) array
        Tangent directions in radians.

    Raises
    ------
    InputError
        An array has another shape or holds no finite numbers.

    References
    ----------
    Yuen, Illingworth and Kittler 1989; thesis (3-1) to (3-8), 5.4.3; errata T4 (no tan(theta)).

    Examples
    --------
    >>> circle = np.array([[5.0, 2.0], [3.0, 4.0], [1.0, 2.0]])
    >>> three_point_centre(circle, np.array([np.pi / 2, 0.0, np.pi / 2])).round(9).tolist()
    [3.0, 2.0]
    """
    p = _check.finite(points, "points", (3, 2))
    angle = _check.finite(angles, "angles", (3,))
    elements = np.column_stack([p, np.cos(angle), np.sin(angle)])
    found, x, y = yuen_centre(elements, 0, 1, 2, 1e-12)
    return np.array([x, y]) if found else None
