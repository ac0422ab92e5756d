"""Where on an ellipse points lie: eccentric angles, the span of an arc, tangents."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray
from geoprim_core.errors import InputError
from geoprim_core.fitting.shape import ellipse_row
from geoprim_core.types import Ellipse


def tangent_at(ellipse: Ellipse, parameter: npt.ArrayLike) -> FloatArray:
    """Return the unit tangents of the outline at given eccentric angles, from +x towards +y.

    Parameters
    ----------
    ellipse : Ellipse
    parameter : float or (n,) array
        Eccentric angle in radians, as of `point_at`.

    Returns
    -------
    (2,) or (n, 2) float64
        Directions of travel of growing eccentric angle, of length 1.

    Raises
    ------
    InputError
        A parameter is not finite, or the ellipse is not an Ellipse.

    References
    ----------
    Thesis (4-17).

    Examples
    --------
    >>> tangent_at(Ellipse(5, 5, 3, 2, 0), [np.pi / 2, np.pi]).round(12).tolist()
    [[-1.0, 0.0], [-0.0, -1.0]]
    """
    row = ellipse_row(ellipse)
    single = np.ndim(parameter) == 0
    t = _check.finite([parameter] if single else parameter, "parameter", (None,))
    along, across = -row[2] * np.sin(t), row[3] * np.cos(t)
    cos, sin = np.cos(row[4]), np.sin(row[4])
    steps = np.stack([cos * along - sin * across, sin * along + cos * across], axis=1)
    tangents: FloatArray = steps / np.hypot(along, across)[:, None]
    return tangents[0] if single else tangents


def eccentric_angles(points: npt.ArrayLike, ellipse: Ellipse) -> FloatArray:
    """Return the eccentric angle of each point, or of the outline point on its affine ray.

    The affine map of the ellipse to a circle takes the ray from the centre through the point to
    a ray; the centre itself has the angle 0.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels.
    ellipse : Ellipse

    Returns
    -------
    (n,) float64
        Eccentric angles in [0, 2 pi), as `point_at` takes them.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array, or the ellipse is not an Ellipse.

    Examples
    --------
    >>> eccentric_angles([(8, 5), (5, 7), (5, 3)], Ellipse(5, 5, 3, 2, 0)).round(4).tolist()
    [0.0, 1.5708, 4.7124]
    """
    row = ellipse_row(ellipse)
    dx, dy = (_check.points(points) - row[:2]).T
    cos, sin = np.cos(row[4]), np.sin(row[4])
    u, v = (cos * dx + sin * dy) / row[2], (cos * dy - sin * dx) / row[3]
    angles: FloatArray = np.arctan2(v, u) % (2 * np.pi)
    angles[angles >= 2 * np.pi] = 0.0  # a tiny negative angle rounds up to a turn
    return angles


def angular_span(points: npt.ArrayLike, ellipse: Ellipse) -> float:
    """Return the shortest range of eccentric angles that holds all points.

    It is a turn without the widest gap between neighbours, so that points all around an outline
    span a turn less their spacing.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least one.
    ellipse : Ellipse

    Returns
    -------
    float
        In radians, in [0, 2 pi).

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array with a point, or the ellipse is not an Ellipse.

    Examples
    --------
    >>> from geoprim_core.fitting import point_at
    >>> ellipse = Ellipse(5, 5, 3, 2, 0.4)
    >>> round(angular_span(point_at(ellipse, np.linspace(-1, 2, 20)), ellipse), 9)
    3.0
    """
    angles = np.sort(eccentric_angles(points, ellipse))
    if len(angles) == 0:
        raise InputError("points", "at least one point", "none")
    gaps = np.diff(angles, append=angles[0] + 2 * np.pi)
    return float(max(2 * np.pi - gaps.max(), 0.0))
