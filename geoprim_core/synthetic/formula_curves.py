"""The thesis' curves by formula, (2-68) - (2-70): real-valued, semi-digital and digital."""

from __future__ import annotations

import numpy as np

from geoprim_core import _check
from geoprim_core._check import FloatArray
from geoprim_core.errors import InputError
from geoprim_core.synthetic.boundaries import without_repeats

# a, m, n1, n2, n3, theta_0, x_0, y_0 of Table 2.7-6
_CURVES = {
    "curve_1": (100.0, 9.0, 9.0, 14.0, 11.0, 0.0, 90.0, 20.0),
    "curve_2": (100.0, 7.0, 9.0, 3.0, 11.0, np.pi, 30.0, 60.0),
    "curve_3": (100.0, 6.0, 1.0, 1.0, 6.0, np.pi / 3, -80.0, 10.0),
}
FORMULA_CURVES = (*_CURVES, "sinc")
KINDS = ("real", "semi_digital", "digital")
_FINE = 40  # samples of a digital curve for each of a real-valued one


def formula_curve(name: str, kind: str = "real") -> FloatArray:
    """Return a curve of thesis 2.7.3 as an open sequence of points.

    Parameters
    ----------
    name : {"curve_1", "curve_2", "curve_3", "sinc"}
        (2-68), (2-69) with the rows of Table 2.7-6, 1001 points; (2-70), 100 points.
    kind : {"real", "semi_digital", "digital"}
        As the formula gives them; x rounded; or all pixels in turn, 8-connected.

    Returns
    -------
    (n, 2) float64

    Raises
    ------
    InputError
        The name or the kind is unknown.

    References
    ----------
    Thesis (2-68) - (2-70), Table 2.7-6. The powers in (2-68) are taken of absolute values, as in
    the superformula of J. Gielis, American Journal of Botany 90, 2003: the printed ones are
    complex where a cosine or a sine is negative.

    Examples
    --------
    >>> formula_curve("curve_1").shape, formula_curve("sinc").shape
    ((1001, 2), (100, 2))
    """
    if name not in FORMULA_CURVES:
        raise InputError("name", "one of " + ", ".join(FORMULA_CURVES), _check.describe(name))
    if kind not in KINDS:
        raise InputError("kind", "one of " + ", ".join(KINDS), _check.describe(kind))
    curve = _points(name, _FINE if kind == "digital" else 1)
    if kind == "semi_digital":
        curve[:, 0] = np.floor(curve[:, 0] + 0.5)
    if kind == "digital":
        curve = without_repeats(np.floor(curve + 0.5), closed=False)
    return curve


def _points(name: str, samples: int) -> FloatArray:
    if name == "sinc":
        x = np.linspace(1.0, 100.0, 99 * samples + 1)
        return np.stack([x, 100 * np.sin(x / 5) / (x / 5)], axis=1)
    a, m, n1, n2, n3, turn, x0, y0 = _CURVES[name]
    theta = np.linspace(0.0, np.pi, 1000 * samples + 1)
    powers = np.abs(np.cos(m * theta / 4)) ** n2 + np.abs(np.sin(m * theta / 4)) ** n3
    r = a * powers ** (-1 / n1)
    return np.stack([r * np.cos(theta + turn) + x0, r * np.sin(theta + turn) + y0], axis=1)
