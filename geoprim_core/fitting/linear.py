"""Linear least squares on a conic with a fixed constant term, twice."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core.fitting._kernels_pencil import LINEAR, pencil_points
from geoprim_core.fitting._outcome import fit_by
from geoprim_core.fitting.fit_params import FitParams
from geoprim_core.params import as_params
from geoprim_core.types import EllipseFit


@dataclass(frozen=True)
class LinearParams(FitParams):
    """`linear` has the limits of every fit and no parameters of its own."""


def linear(
    points: npt.ArrayLike,
    *,
    params: LinearParams | None = None,
    weights: npt.ArrayLike | None = None,
) -> EllipseFit:
    """Fit a conic with the constant term -1 by linear least squares, about the points' mean.

    Its centre is kept, and about it A u^2 + B u v + C v^2 = 1 is fitted once more. The constant
    term draws the conic away from the points' mean, so the ellipse is not as small as the direct
    fits' where arcs are short and noisy: there it finds the most of all methods, as does OpenCV's
    `fitEllipse`, which takes these two steps as well and the absolute values of its axes. It is a
    fit of conics: points of a hyperbola or a parabola have a reason instead of an ellipse. It
    turns, moves and grows with the points, and stretches with them.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least five distinct ones.
    params : LinearParams, optional
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
    P. L. Rosin, "A note on the least squares fitting of ellipses", Pattern Recognition Letters 14,
    1993 (the constant term as the constraint); A. W. Fitzgibbon and R. B. Fisher, "A buyer's guide
    to conic fitting", BMVC 1995.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 4, 30)
    >>> fit = linear(np.stack([50 + 20 * np.cos(t), 40 + 10 * np.sin(t)], axis=1))
    >>> round(fit.ellipse.semi_major, 6), round(fit.ellipse.semi_minor, 6)
    (20.0, 10.0)
    """
    limits = as_params(params, LinearParams)
    return fit_by(pencil_points, points, weights, limits, LINEAR)
