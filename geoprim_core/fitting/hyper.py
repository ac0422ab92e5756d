"""Hyper least squares: a constraint that leaves no bias of second order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core.fitting._kernels_hyper import hyper_points
from geoprim_core.fitting._outcome import fit_by
from geoprim_core.fitting.fit_params import FitParams
from geoprim_core.params import as_params, option
from geoprim_core.types import EllipseFit


@dataclass(frozen=True)
class HyperParams(FitParams):
    """Which terms of the constraint are used."""

    terms: str = option(
        "all",
        "terms of the constraint: all, or those that moments know",
        choices=("all", "leading"),
    )


def hyper(
    points: npt.ArrayLike,
    *,
    params: HyperParams | None = None,
    weights: npt.ArrayLike | None = None,
) -> EllipseFit:
    """Fit the conic of least algebraic distance under the constraint that removes its bias.

    The matrix of the constraint makes the mean error of the solution vanish up to the fourth
    order of the noise. Its leading terms are Taubin's and the bias of the squares; the others are
    smaller by the number of points and take every point for an independent measurement, so that
    repeating points changes them. It is a fit of conics, as `taubin`.

    Of the paper's rank-five inverse it is assumed that it is taken in centred and whitened
    coordinates with the product u v counted by the root of two, which no similarity changes; a
    weight counts as a share of the points' sum.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least five distinct ones.
    params : HyperParams, optional
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
    K. Kanatani and P. Rangarajan, "Hyper least squares fitting of circles and ellipses",
    Computational Statistics and Data Analysis 55, 2011.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 4, 30)
    >>> fit = hyper(np.stack([50 + 20 * np.cos(t), 40 + 10 * np.sin(t)], axis=1))
    >>> round(fit.ellipse.semi_major, 6), round(fit.ellipse.semi_minor, 6)
    (20.0, 10.0)
    """
    settings = as_params(params, HyperParams)
    return fit_by(hyper_points, points, weights, settings, settings.terms == "all")
