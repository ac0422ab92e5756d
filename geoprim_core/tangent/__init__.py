"""Tangent estimation: the direction of travel along digital curves (thesis chapter 3)."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from geoprim_core._check import FloatArray, describe
from geoprim_core.errors import InputError
from geoprim_core.methods import Method, Table
from geoprim_core.params import Params, as_params
from geoprim_core.tangent.curvature import CURVATURES, curvatures, normals
from geoprim_core.tangent.deb import DebParams, deb, deb_batch, radii_of
from geoprim_core.tangent.gaussian import gaussian_derivative
from geoprim_core.tangent.hybrid import HYBRIDS, HybridParams, half_windows
from geoprim_core.tangent.lambda_segments import (
    LambdaMsgParams,
    LambdaMstParams,
    lambda_msg,
    lambda_mst,
)
from geoprim_core.tangent.matas import matas
from geoprim_core.tangent.parabola import epf, icipf, ipf
from geoprim_core.tangent.regression import lr1, lr2, lr3, lr4, lr5
from geoprim_core.tangent.windows import WINDOWS, WindowParams, window_batch
from geoprim_core.tangent.yuen import three_point_centre
from geoprim_core.types import Contours, Tangents

__all__ = [
    "CURVATURES",
    "TABLE",
    "DebParams",
    "HybridParams",
    "LambdaMsgParams",
    "LambdaMstParams",
    "WindowParams",
    "curvatures",
    "deb",
    "epf",
    "estimate_tangents",
    "gaussian_derivative",
    "half_windows",
    "icipf",
    "ipf",
    "lambda_msg",
    "lambda_mst",
    "lr1",
    "lr2",
    "lr3",
    "lr4",
    "lr5",
    "matas",
    "normals",
    "radii_of",
    "three_point_centre",
]

_CAZALS = "Cazals and Pouget, Computer Aided Geometric Design 22, 2005; thesis 3.6.1, method 1"
_LEWINER = "Lewiner, Gomes, Lopes and Craizer, Computers and Graphics 29, 2005; thesis 3.6.1"
_LACHAUD = "Lachaud, Vialard and de Vieilleville, Image and Vision Computing 25, 2007; thesis 3.6.1"
_VIEILLEVILLE = "de Vieilleville and Lachaud, Pattern Recognition 42, 2009; thesis 3.6.1"

# The thesis compares DEB with 72 others: ten with a parameter Q, six choices of Q from the
# maximal segments for each of the ten, and two without a parameter (3.6.1; "71" in 3.1 is a slip).
TABLE = Table(
    "tangent",
    Method(
        "deb",
        deb,
        DebParams,
        "Prasad, Leung, Quek and Brown, IEEE Trans. Image Processing 23, 2014; thesis 3.3",
    ),
    Method("lr1", lr1, WindowParams, _CAZALS),
    Method("lr2", lr2, WindowParams, _CAZALS),
    Method("lr3", lr3, WindowParams, _CAZALS),
    Method("lr4", lr4, WindowParams, _CAZALS),
    Method("lr5", lr5, WindowParams, _CAZALS),
    Method("epf", epf, WindowParams, f"{_VIEILLEVILLE}, method 2"),
    Method("ipf", ipf, WindowParams, f"{_LEWINER}, method 3"),
    Method("icipf", icipf, WindowParams, f"{_LEWINER}, method 4"),
    Method(
        "gaussian_derivative",
        gaussian_derivative,
        WindowParams,
        "Worring and Smeulders, CVIU 58, 1993; thesis 3.6.1, method 5",
    ),
    Method(
        "matas",
        matas,
        WindowParams,
        "Matas, Shao and Kittler, LNCS 974, 1995; thesis 3.6.1, method 6",
    ),
    Method("lambda_mst", lambda_mst, LambdaMstParams, f"{_LACHAUD}, method 7"),
    Method("lambda_msg", lambda_msg, LambdaMsgParams, f"{_LACHAUD}, method 7"),
    *(
        Method(name, function, HybridParams, f"{_VIEILLEVILLE}, method 8")
        for name, function in HYBRIDS.items()
    ),
)

# Methods that treat all contours in one kernel call; the others are called once a contour.
_BATCHES: dict[str, Callable[..., FloatArray]] = {
    "deb": deb_batch,
    **{name: partial(window_batch, window=window) for name, window in WINDOWS.items()},
}


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
        expected = "a Contours (of bare points: Contours.from_curves([points]))"
        raise InputError("contours", expected, describe(contours))
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
