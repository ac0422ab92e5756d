"""Ahn, Rauh and Warnecke: orthogonal distances by Gauss-Newton on the feet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core.fitting._kernels_ahn import ahn_points
from geoprim_core.fitting._outcome import fit_by
from geoprim_core.fitting.fit_params import FitParams
from geoprim_core.params import as_params, option
from geoprim_core.types import EllipseFit


@dataclass(frozen=True)
class AhnParams(FitParams):
    """Start and end of the steps."""

    iterations: int = option(100, "largest number of steps", low=1, high=10000)
    start: str = option("direct", "where the steps begin", choices=("direct", "circle"))


def ahn(
    points: npt.ArrayLike,
    *,
    params: AhnParams | None = None,
    weights: npt.ArrayLike | None = None,
) -> EllipseFit:
    """Fit the ellipse of least squared orthogonal distance by the coordinates of the feet.

    Two loops: for every point the nearest point of the ellipse, and around them Gauss-Newton
    steps on the 2 n coordinate differences, with the motion of each foot from the theorem of
    implicit functions. A step that does not lower the sum of squares is halved, up to twenty
    times, unless what it would gain is below the rounding of that sum. It ends when a step is
    below 1e-10 of the semi-major axis, or when none that is below 1e-6 of it lowers the sum; where
    it does not end so, the reason says that it has not settled.

    Against the paper: it starts at the direct fit, which is more robust than the paper's circle
    (`start="circle"`), and the feet come from a Newton iteration that cannot fail. A point on the
    evolute, whose foot has no derivative, rests for one step.

    Parameters
    ----------
    points : (n, 2) array
        Points (x, y) in pixels, at least five distinct ones.
    params : AhnParams, optional
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
    S. J. Ahn, W. Rauh and H.-J. Warnecke, "Least-squares orthogonal distances fitting of
    circle, sphere, ellipse, hyperbola, and parabola", Pattern Recognition 34, 2001; thesis 4.1.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 4, 30)
    >>> fit = ahn(np.stack([50 + 20 * np.cos(t), 40 + 10 * np.sin(t)], axis=1))
    >>> round(fit.ellipse.semi_major, 6), round(fit.ellipse.semi_minor, 6)
    (20.0, 10.0)
    """
    settings = as_params(params, AhnParams)
    circle = settings.start == "circle"
    return fit_by(ahn_points, points, weights, settings, settings.iterations, circle)
