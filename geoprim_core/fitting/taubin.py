"""Taubin: algebraic distance over the mean gradient."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core.fitting._kernels_pencil import TAUBIN, pencil_points
from geoprim_core.fitting._outcome import fit_by
from geoprim_core.fitting.fit_params import FitParams
from geoprim_core.params import as_params
from geoprim_core.types import EllipseFit


@dataclass(frozen=True)
class TaubinParams(FitParams):
    """Taubin has the limits of every fit and no parameters of its own."""


def taubin(
    points: npt.ArrayLike,
    *,
    params: TaubinParams | None = None,
    weights: npt.ArrayLike | None = None,
) -> EllipseFit:
    """Fit the conic of least mean square value over mean square gradient.

    The quotient is the squared orthogonal distance to first order, with one common gradient for
    all points; the fit has little of the direct fit's pull towards small ellipses. It is a fit of
    conics: points of a hyperbola or a parabola have a reason instead of an ellipse. It turns,
    moves and grows with the points.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least five distinct ones.
    params : TaubinParams, optional
    weights : (n,) array, optional
        Weights of at least 0, not all 0; by default 1 each.

    Returns
    -------
    EllipseFit
        With the conic and the residual that every method here returns, see `nsaf`.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array, or the weights not (n,) of at least 0.

    References
    ----------
    G. Taubin, "Estimation of planar curves, surfaces and nonplanar space curves defined by
    implicit equations", IEEE Trans. PAMI 13, 1991.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 4, 30)
    >>> fit = taubin(np.stack([50 + 20 * np.cos(t), 40 + 10 * np.sin(t)], axis=1))
    >>> round(fit.ellipse.semi_major, 6), round(fit.ellipse.semi_minor, 6)
    (20.0, 10.0)
    """
    limits = as_params(params, TaubinParams)
    return fit_by(pencil_points, points, weights, limits, TAUBIN)
