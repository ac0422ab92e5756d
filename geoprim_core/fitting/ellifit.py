"""ElliFit: least squares fitting of an ellipse through a linear operator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core.fitting._kernels_arcs import fit_curve
from geoprim_core.fitting._kernels_fit import ELLIFIT
from geoprim_core.fitting._outcome import fit_by
from geoprim_core.fitting.fit_params import FitParams
from geoprim_core.params import as_params
from geoprim_core.types import EllipseFit


@dataclass(frozen=True)
class EllifitParams(FitParams):
    """ElliFit has the limits of every fit and no parameters of its own."""


def ellifit(
    points: npt.ArrayLike,
    *,
    params: EllifitParams | None = None,
    weights: npt.ArrayLike | None = None,
) -> EllipseFit:
    """Fit an ellipse by linear least squares with the coefficient of y^2 fixed at 1.

    It is an algebraic fit, not a geometric one, and depends on how the axes are turned
    (errata E5). Its merit is that points of a parabola or a hyperbola give no ellipse: one
    exists if and only if D = 4 phi1 - phi2^2 > 0 and K > 0 (errata E1, E3). The points are
    centred and scaled, which leaves the solution as it is. A parabola with an upright axis has
    no y^2; there the fixed coefficient makes the outcome a matter of rounding.

    Five distinct points suffice: the seven of the thesis rest on points of zero y having no
    say, but such a point still gives an equation for phi1, phi3 and phi5.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least five distinct ones.
    params : EllifitParams, optional
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
    D. K. Prasad, M. K. H. Leung and C. Quek, "ElliFit: an unconstrained, non-iterative, least
    squares based geometric ellipse fitting method", Pattern Recognition 46, 2013; thesis
    4.4, (4-34) - (4-60); errata E1 - E6, C4.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 4, 30)
    >>> fit = ellifit(np.stack([50 + 20 * np.cos(t), 40 + 10 * np.sin(t)], axis=1))
    >>> round(fit.ellipse.semi_major, 6), round(fit.ellipse.semi_minor, 6)
    (20.0, 10.0)
    >>> ellifit([(y * y, y) for y in range(-5, 6)]).reason
    'the best conic is a parabola'
    """
    limits = as_params(params, EllifitParams)
    return fit_by(fit_curve, points, weights, limits, ELLIFIT)
