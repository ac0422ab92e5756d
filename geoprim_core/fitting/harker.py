"""Harker, O'Leary and Zsombor-Murray: direct fit of a type of conic, bias corrected."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core.fitting._kernels_pencil import HARKER, pencil_points
from geoprim_core.fitting._outcome import fit_by
from geoprim_core.fitting.fit_params import FitParams
from geoprim_core.params import as_params
from geoprim_core.types import EllipseFit


@dataclass(frozen=True)
class HarkerParams(FitParams):
    """Harker has the limits of every fit and no parameters of its own."""


def harker(
    points: npt.ArrayLike,
    *,
    params: HarkerParams | None = None,
    weights: npt.ArrayLike | None = None,
) -> EllipseFit:
    """Fit an ellipse from the pencil of the best ellipse and the best hyperbola.

    With the linear part eliminated, M q = t C q has three solutions: one ellipse, which is the
    direct fit, and two hyperbolae. The ellipse alone is biased towards low eccentricity; a linear
    combination with the hyperbola of the smaller residual corrects it. How the published method
    weighs the two is not known here in detail. Assumed: by the least mean square value over mean
    square gradient (Taubin's quotient) within the pencil, which is direct and does not depend on
    position, turn and size. Where that conic is not an ellipse, the direct one is returned: there
    always is one, and the method is not selective (thesis 4.1).

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least five distinct ones.
    params : HarkerParams, optional
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
    M. Harker, P. O'Leary and P. Zsombor-Murray, "Direct type-specific conic fitting and
    eigenvalue bias correction", Image and Vision Computing 26, 2008; thesis 4.1.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 4, 30)
    >>> fit = harker(np.stack([50 + 20 * np.cos(t), 40 + 10 * np.sin(t)], axis=1))
    >>> round(fit.ellipse.semi_major, 6), round(fit.ellipse.semi_minor, 6)
    (20.0, 10.0)
    """
    limits = as_params(params, HarkerParams)
    return fit_by(pencil_points, points, weights, limits, HARKER)
