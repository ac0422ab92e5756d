"""By how much digitisation can turn a chord: one formula for polygons and tangents."""

from __future__ import annotations

import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray
from geoprim_core.digital._kernels_bounds import exact_slope_bounds_of


def exact_slope_bounds(chords: npt.ArrayLike) -> FloatArray:
    """Return the largest turn of chords whose ends move by at most half a pixel in x and in y.

    With s the length, c = abs(cos phi) and n = abs(sin phi) of the chord's direction phi it is
    the larger one of atan((c + n) / (s - abs(c - n))) and atan(abs(c - n) / (s - c - n)), and a
    right angle where s <= c + n.

    Parameters
    ----------
    chords : (n, 2) array
        From the first end to the second, in pixels.

    Returns
    -------
    (n,) float64
        In radians.

    Raises
    ------
    InputError
        The chords are not a finite (n, 2) array.

    References
    ----------
    Thesis (2-36), (3-28); errata P4, T3: the printed expressions are exceeded by short chords.

    Examples
    --------
    >>> exact_slope_bounds([(10, 0), (1, 0)]).round(4).tolist()  # atan(1 / 9), a right angle
    [0.1107, 1.5708]
    """
    bounds: FloatArray = exact_slope_bounds_of(_check.points(chords, "chords"))
    return bounds
