"""Halir and Flusser: the direct fit, solved in its partitioned form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core.fitting._kernels_arcs import fit_curve
from geoprim_core.fitting._kernels_fit import NSAF
from geoprim_core.fitting._outcome import fit_by
from geoprim_core.fitting.fit_params import FitParams
from geoprim_core.params import as_params
from geoprim_core.types import EllipseFit


@dataclass(frozen=True)
class HalirFlusserParams(FitParams):
    """Halir and Flusser's fit has the limits of every fit and no parameters of its own."""


def halir_flusser(
    points: npt.ArrayLike,
    *,
    params: HalirFlusserParams | None = None,
    weights: npt.ArrayLike | None = None,
) -> EllipseFit:
    """Fit an ellipse by least algebraic distance under 4 a c - b^2 = 1, the linear part eliminated.

    The scatter matrix falls into S1 (squares), S2 (mixed) and S3 (linear); with
    T = -S3^-1 S2' the problem is one of three unknowns, M = C1^-1 (S1 + S2 T), and exact data do
    no harm. The paper solves it in image coordinates; here the points are centred and whitened
    first, which leaves the minimum as it is, and the eigenvalue is found by Laguerre's iteration
    on the cubic. `fitzgibbon` and `nsaf` seek the same minimum; `nsaf` is solved by this very
    partition (errata E7) and agrees to the last bit.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least five distinct ones.
    params : HalirFlusserParams, optional
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
    R. Halir and J. Flusser, "Numerically stable direct least squares fitting of ellipses", WSCG
    1998; thesis 4.1; errata E7.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 4, 30)
    >>> fit = halir_flusser(np.stack([50 + 20 * np.cos(t), 40 + 10 * np.sin(t)], axis=1))
    >>> round(fit.ellipse.semi_major, 6), round(fit.ellipse.semi_minor, 6)
    (20.0, 10.0)
    """
    limits = as_params(params, HalirFlusserParams)
    return fit_by(fit_curve, points, weights, limits, NSAF)
