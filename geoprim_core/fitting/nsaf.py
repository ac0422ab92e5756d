"""NSAF: numerically stable algebraic fitting of an ellipse."""

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
class NsafParams(FitParams):
    """NSAF has the limits of every fit and no parameters of its own."""


def nsaf(
    points: npt.ArrayLike,
    *,
    params: NsafParams | None = None,
    weights: npt.ArrayLike | None = None,
) -> EllipseFit:
    """Fit an ellipse by least algebraic distance under 4 a c - b^2 = 1.

    The constraint admits ellipses only, so that points of a hyperbola or a parabola get one
    too. The fit does not depend on position, turn, scale or shear of the points. They are
    centred and whitened, and the linear part is eliminated (Halir and Flusser's partition),
    which keeps exact data safe (errata E7).

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least five distinct ones.
    params : NsafParams, optional
    weights : (n,) array, optional
        Weights of at least 0, not all 0; by default 1 each.

    Returns
    -------
    EllipseFit
        The conic is scaled to the value -1 at the centre of the ellipse; the residual is the
        root mean square of its values at the points, which no affine map changes (errata C4).
        Points off a circle of radius r by s pixels have a residual of about 2 s / r.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array, or the weights not (n,) of at least 0.

    References
    ----------
    A. Fitzgibbon, M. Pilu and R. B. Fisher, IEEE Trans. PAMI 21, 1999; R. Halir and J. Flusser,
    WSCG 1998; thesis 4.2.2, (4-2) - (4-12); errata E7, C4.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 4, 30)
    >>> fit = nsaf(np.stack([50 + 20 * np.cos(t), 40 + 10 * np.sin(t)], axis=1))
    >>> round(fit.ellipse.semi_major, 6), round(fit.ellipse.semi_minor, 6)
    (20.0, 10.0)
    """
    limits = as_params(params, NsafParams)
    return fit_by(fit_curve, points, weights, limits, NSAF)
