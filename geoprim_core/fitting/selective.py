"""Selective: an ellipse only where the points are certain of one, by the fit that suits them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core.fitting._kernels_selective import selective_points
from geoprim_core.fitting._outcome import fit_by
from geoprim_core.fitting.fit_params import FitParams
from geoprim_core.params import as_params, option
from geoprim_core.types import EllipseFit


@dataclass(frozen=True)
class SelectiveParams(FitParams):
    """When an ellipse is certain, and when noise asks for the direct fit."""

    certainty: float = option(
        1.0, "standard errors by which the best conic has to be off a parabola", low=0.0
    )
    direct_noise: float = option(
        0.05, "noise, as a share of the points' extent, above which the direct fit is taken",
        low=0.0,
    )  # fmt: skip
    direct_gap: float = option(
        150.0,
        "largest gap between neighbouring points, seen at the ellipse, for the direct fit",
        unit="deg", low=0.0, high=360.0,
    )  # fmt: skip


def selective(
    points: npt.ArrayLike,
    *,
    params: SelectiveParams | None = None,
    weights: npt.ArrayLike | None = None,
) -> EllipseFit:
    """Fit an ellipse where the points tell it from a parabola, and give the reason elsewhere.

    1. The conic of least mean square distance to first order (Taubin) in whitened coordinates
       has 4 A C - B^2 > 0 if it is an ellipse. Its standard error follows from the scatter of
       the points. Fewer than `certainty` standard errors above 0 are no ellipse. The test does
       not depend on position, turn, scale or shear of the points.
    2. The ellipse itself is the geometric one. Where the points are noisy but lie all round, it
       is the direct one (`nsaf`): its pull towards small ellipses then does less harm than the
       scatter of a fit that has none.

    Neither step is of the thesis. The two limits of step 2 were set on noisy arcs of 120 to 360
    degrees with 1 to 20 per cent noise: on arcs shorter than about 200 degrees the direct fit is
    the worse one at any noise.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least five distinct ones.
    params : SelectiveParams, optional
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
    G. Taubin, IEEE Trans. PAMI 13, 1991; K. Kanatani, "Statistical Optimization for Geometric
    Computation", Elsevier, 1996 (covariance of a fitted conic to first order); the goal is that
    of thesis 4.5.4 and 4.5.5.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(-1.2, 1.2, 30)
    >>> fit = selective(np.stack([50 + 20 * np.cos(t), 40 + 10 * np.sin(t)], axis=1))
    >>> round(fit.ellipse.semi_major, 6), round(fit.ellipse.semi_minor, 6)
    (20.0, 10.0)
    >>> wave = 0.3 * np.sin(7 * np.arange(30))
    >>> selective(np.stack([20 / np.cos(0.8 * t) + wave, 30 * np.tan(0.8 * t)], axis=1)).reason
    'the best conic is a hyperbola'
    """
    settings = as_params(params, SelectiveParams)
    limits = (settings.certainty, settings.direct_noise, math.radians(settings.direct_gap))
    return fit_by(selective_points, points, weights, settings, *limits)
