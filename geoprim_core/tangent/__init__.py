"""Tangent estimation: the direction of travel along digital curves (thesis chapter 3)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from geoprim_core._check import FloatArray, describe
from geoprim_core.errors import InputError
from geoprim_core.methods import Method, Table
from geoprim_core.params import Params, as_params
from geoprim_core.tangent.deb import DebParams, deb, deb_batch
from geoprim_core.types import Contours, Tangents

__all__ = ["TABLE", "DebParams", "deb", "estimate_tangents"]

TABLE = Table(
    "tangent",
    Method(
        "deb",
        deb,
        DebParams,
        "Prasad, Leung, Quek and Brown, IEEE Trans. Image Processing 23, 2014; thesis 3.3",
    ),
)

# Methods that treat all contours in one kernel call; the others are called once a contour.
_BATCHES: dict[str, Callable[..., FloatArray]] = {"deb": deb_batch}


def estimate_tangents(
    contours: Contours, method: str = "deb", params: Params | None = None
) -> Tangents:
    """Estimate the direction of travel at every pixel of all contours.

    Parameters
    ----------
    contours : Contours
    method : str
        A name of `TABLE`.
    params : Params, optional
        Of the method's class.

    Returns
    -------
    Tangents
        Angles in radians in (-pi, pi], NaN where a method does not define one.

    Raises
    ------
    InputError
        The contours are not a Contours.
    ParameterError
        The method is unknown or the parameters are of another class.

    References
    ----------
    Thesis chapter 3.

    Examples
    --------
    >>> line = Contours([(i, 0) for i in range(9)], [0, 9], [False])
    >>> estimate_tangents(line).angle[3:6].tolist()
    [nan, 0.0, nan]
    """
    if not isinstance(contours, Contours):
        raise InputError("contours", "a Contours", describe(contours))
    row = TABLE[method]
    checked = as_params(params, row.params)
    if method in _BATCHES:
        angle = _BATCHES[method](contours.points, contours.offsets, contours.closed, checked)
    else:
        found = [
            row.function(curve, closed=bool(closed), params=checked)
            for curve, closed in zip(contours, contours.closed, strict=True)
        ]
        angle = np.concatenate([np.zeros(0), *found])
    return Tangents(angle, contours.offsets)
