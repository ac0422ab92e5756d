"""Orthogonal distance of points to an ellipse."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray
from geoprim_core.fitting._kernels_distance import signed_distances
from geoprim_core.fitting.shape import ellipse_row
from geoprim_core.types import Ellipse


def distance_to_ellipse(points: npt.ArrayLike, ellipse: Ellipse) -> FloatArray:
    """Return the distance of each point to the nearest point of an ellipse's outline.

    It is unsigned: inside and outside count alike. The foot of the perpendicular is found to
    machine precision for every position, the centre and both axes included.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels.
    ellipse : Ellipse

    Returns
    -------
    (n,) float64
        Distances in pixels, at least 0.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array, or the ellipse is not an Ellipse.

    References
    ----------
    D. Eberly, "Distance from a point to an ellipse, an ellipsoid, or a hyperellipsoid", 2013
    (the root-finding problem; solved here by Newton's method in a shifted variable).

    Examples
    --------
    >>> distance_to_ellipse([(0, 0), (7, 0), (0, 1)], Ellipse(0, 0, 5, 3, 0)).tolist()
    [3.0, 2.0, 2.0]
    """
    cloud = _check.points(points)
    distances: FloatArray = np.abs(signed_distances(cloud, ellipse_row(ellipse)))
    return distances
