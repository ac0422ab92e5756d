"""Maini: the direct fit in a unit box, and with a little noise where there is none."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core.fitting._kernels_maini import maini_points
from geoprim_core.fitting._outcome import fit_by
from geoprim_core.fitting.fit_params import FitParams
from geoprim_core.params import as_params, option
from geoprim_core.types import EllipseFit


@dataclass(frozen=True)
class MainiParams(FitParams):
    """The perturbation of exact data."""

    noise: float = option(
        1e-6, "standard deviation of the noise, in halves of the box", low=1e-7, high=0.1
    )
    copies: int = option(10, "number of perturbed copies of exact data", low=1, high=1000)


def maini(
    points: npt.ArrayLike,
    *,
    params: MainiParams | None = None,
    weights: npt.ArrayLike | None = None,
) -> EllipseFit:
    """Fit an ellipse by Fitzgibbon's problem on points whose bounding box is [-1, 1]^2.

    The constraint 4 a c - b^2 = 1 survives that map, so the minimum is the direct fit's. Where
    the scatter matrix has an eigenvalue of zero, that is on exact data, a little Gaussian noise
    is added to the points several times and the solutions are averaged; such a fit is as exact as
    the noise lets it be. Assumed: the size and number of the perturbations, "zero" as 1e-12 of the
    largest eigenvalue, and the average over conics of unit trace. The noise is a fixed sequence,
    so that the same points give the same ellipse.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least five distinct ones.
    params : MainiParams, optional
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
    E. S. Maini, "Enhanced direct least square fitting of ellipses", International Journal of
    Pattern Recognition and Artificial Intelligence 20, 2006; thesis 4.1; errata C6.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 4, 30)
    >>> fit = maini(np.stack([50 + 20 * np.cos(t), 40 + 10 * np.sin(t)], axis=1))
    >>> round(fit.ellipse.semi_major, 4), round(fit.ellipse.semi_minor, 4)
    (20.0, 10.0)
    """
    settings = as_params(params, MainiParams)
    return fit_by(maini_points, points, weights, settings, settings.noise, settings.copies)
