"""Fitzgibbon, Pilu and Fisher: the direct fit as a problem of six unknowns (B2AC)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core.fitting._kernels_pencil import FITZGIBBON, RAW, pencil_points
from geoprim_core.fitting._outcome import fit_by
from geoprim_core.fitting.fit_params import FitParams
from geoprim_core.params import as_params, option
from geoprim_core.types import EllipseFit


@dataclass(frozen=True)
class FitzgibbonParams(FitParams):
    """In which coordinates the scatter matrix is built."""

    normalise: bool = option(True, "centre and whiten the points; false: as published, raw")


def fitzgibbon(
    points: npt.ArrayLike,
    *,
    params: FitzgibbonParams | None = None,
    weights: npt.ArrayLike | None = None,
) -> EllipseFit:
    """Fit an ellipse by least algebraic distance under 4 a c - b^2 = 1, S q = t C q with t > 0.

    In six unknowns the scatter matrix S holds moments of order 0 beside those of order 4, which
    in image coordinates leaves few digits or none (thesis 4.1); and on exact data S is singular
    (errata E7), where its null vector is returned. By default the points are centred and
    whitened, which does not change the minimum. `normalise=False` is the published problem in
    plain image coordinates with all its loss of digits: its residual tells what it is worth.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least five distinct ones.
    params : FitzgibbonParams, optional
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
    A. Fitzgibbon, M. Pilu and R. B. Fisher, "Direct least square fitting of ellipses", IEEE
    Trans. PAMI 21, 1999; thesis 4.2.1, (4-2) - (4-11); errata E7.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 4, 30)
    >>> fit = fitzgibbon(np.stack([50 + 20 * np.cos(t), 40 + 10 * np.sin(t)], axis=1))
    >>> round(fit.ellipse.semi_major, 6), round(fit.ellipse.semi_minor, 6)
    (20.0, 10.0)
    """
    settings = as_params(params, FitzgibbonParams)
    method = FITZGIBBON if settings.normalise else RAW
    return fit_by(pencil_points, points, weights, settings, method)
