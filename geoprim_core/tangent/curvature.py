"""Curvatures and normals from the methods that give them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray, describe
from geoprim_core.errors import ParameterError
from geoprim_core.params import Params
from geoprim_core.tangent.deb import deb_bends
from geoprim_core.tangent.hybrid import CHOICES, hybrid_curve
from geoprim_core.tangent.windows import WINDOWS, Window, window_curve

# A line and a median of directions have no second derivative.
_BENDING = [window for name, window in WINDOWS.items() if name not in ("lr1", "matas")]


def _of_window(points: Any, closed: bool, params: Any, window: Window) -> FloatArray:
    return window_curve(points, closed, params, window)[1]


def _of_hybrid(points: Any, closed: bool, params: Any, window: Window, choice: str) -> FloatArray:
    return hybrid_curve(points, closed, params, window, choice)[1]


CURVATURES: dict[str, Callable[[Any, bool, Any], FloatArray]] = {
    "deb": deb_bends,
    **{window.name: partial(_of_window, window=window) for window in _BENDING},
    **{
        f"{window.name}_h{choice}": partial(_of_hybrid, window=window, choice=choice)
        for window in _BENDING
        for choice in CHOICES
    },
}


def curvatures(
    points: npt.ArrayLike,
    method: str = "icipf",
    *,
    closed: bool = False,
    params: Params | None = None,
) -> FloatArray:
    """Estimate the curvature at every pixel by a tangent method that gives it.

    Parameters
    ----------
    points : (n, 2) array
        Pixels of the curve in order.
    method : str
        A name of `CURVATURES`: `deb` (circle through its three pixels), and all but `lr1` and
        `matas` of the methods that fit a window, with their hybrids (second derivative).
    closed : bool
        Whether the last pixel touches the first.
    params : Params, optional
        Of the method's class.

    Returns
    -------
    (n,) float64
        In 1 / px, positive where the curve turns from +x towards +y; NaN where undefined.

    Raises
    ------
    ParameterError
        The method gives no curvature, or the parameters are of another class.
    InputError
        As the method.

    References
    ----------
    Thesis 3.6.1.

    Examples
    --------
    >>> t = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    >>> circle = 50 * np.stack([np.cos(t), np.sin(t)], axis=1)
    >>> float(curvatures(circle, "deb", closed=True).mean().round(4))
    0.02
    """
    if method not in CURVATURES:
        expected = f"a method that gives curvature, one of {', '.join(CURVATURES)}"
        raise ParameterError("method", expected, describe(method))
    return CURVATURES[method](points, bool(closed), params)


def normals(angle: npt.ArrayLike) -> FloatArray:
    """Return the unit normals (n, 2) of directions of travel, turned from +x towards +y by 90.

    In an image, whose y points down, they point to the right of the way of travel.

    Parameters
    ----------
    angle : (n,) array
        Radians; NaN gives NaN.

    Raises
    ------
    InputError
        The angles are not a numeric (n,) array.

    Examples
    --------
    >>> normals([0.0]).tolist()
    [[-0.0, 1.0]]
    """
    checked = _check.numbers(angle, "angle", (None,))
    return np.stack([-np.sin(checked), np.cos(checked)], axis=1)
