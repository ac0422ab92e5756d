"""Liu and Qiao: the direct fit, then gradient descent point by point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core.fitting._kernels_sequential import liu_points
from geoprim_core.fitting._outcome import fit_by
from geoprim_core.fitting.fit_params import FitParams
from geoprim_core.params import as_params, option
from geoprim_core.types import EllipseFit


@dataclass(frozen=True)
class LiuParams(FitParams):
    """The descent."""

    rate: float = option(1.0, "learning rate, in units of 1 / n", low=0.0, high=10.0)
    sweeps: int = option(1, "number of passes over the points", low=0, high=10000)


def liu(
    points: npt.ArrayLike,
    *,
    params: LiuParams | None = None,
    weights: npt.ArrayLike | None = None,
) -> EllipseFit:
    """Fit an ellipse by the direct fit and descend the squared distance of one point after another.

    Every point moves the ellipse a little towards itself, in the order of the points, so that the
    last ones have the last word (thesis 4.1): the fit depends on the order. Only this part of the
    paper is meant here, not its detector. Assumed: the distance is the first-order one, the
    conic's value over its gradient, cut off at the semi-minor axis; the five parameters are
    centre, axes and, in pixels at the root of a b, the angle; the rate is 1 / n as in thesis
    5.6, and there is one pass.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least five distinct ones.
    params : LiuParams, optional
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
    Z. Y. Liu and H. Qiao, "Multiple ellipses detection in noisy environments: A hierarchical
    approach", Pattern Recognition 42, 2009; thesis 4.1.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 4, 30)
    >>> fit = liu(np.stack([50 + 20 * np.cos(t), 40 + 10 * np.sin(t)], axis=1))
    >>> round(fit.ellipse.semi_major, 6), round(fit.ellipse.semi_minor, 6)
    (20.0, 10.0)
    """
    settings = as_params(params, LiuParams)
    return fit_by(liu_points, points, weights, settings, settings.rate, settings.sweeps)
