"""Fits from moments: sums over points that add, so that groups of arcs are fitted in O(1)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray, describe
from geoprim_core.errors import InputError, ParameterError
from geoprim_core.fitting._kernels_fit import ELLIFIT, NSAF, fit_group
from geoprim_core.fitting._kernels_moments import add_moments, add_weighted_moments
from geoprim_core.fitting._kernels_pencil import (
    CHAUDHURI,
    FITZGIBBON,
    HARKER,
    HYPER,
    LINEAR,
    TAUBIN,
    pencil_moments,
)
from geoprim_core.fitting._outcome import checked_weights, outcome
from geoprim_core.fitting.fit_params import FitParams
from geoprim_core.types import EllipseFit

# Each method's kernel and its number there.
_METHODS: dict[str, tuple[Callable[..., tuple[int, FloatArray, float]], int]] = {
    "nsaf": (fit_group, NSAF),
    "ellifit": (fit_group, ELLIFIT),
    "halir_flusser": (fit_group, NSAF),
    "fitzgibbon": (pencil_moments, FITZGIBBON),
    "harker": (pencil_moments, HARKER),
    "chaudhuri": (pencil_moments, CHAUDHURI),
    "taubin": (pencil_moments, TAUBIN),
    "hyper": (pencil_moments, HYPER),
    "linear": (pencil_moments, LINEAR),
}


@dataclass(frozen=True, slots=True, eq=False)
class Moments:
    """Sums of u^p v^q, p + q <= 4, over points, with u = (x - x0) / scale, v = (y - y0) / scale.

    Attributes
    ----------
    values : (15,) float64
        In the order 1, u, v, uu, uv, vv, uuu, uuv, uvv, vvv, uuuu, uuuv, uuvv, uvvv, vvvv.
    origin : (x0, y0) in pixels
    scale : float
        In pixels.
    """

    values: FloatArray
    origin: tuple[float, float] = (0.0, 0.0)
    scale: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", _check.finite(self.values, "values", (15,)))
        x, y = _check.finite(self.origin, "origin", (2,))
        object.__setattr__(self, "origin", (float(x), float(y)))
        if not 0 < self.scale < np.inf:
            raise InputError("scale", "a positive number", describe(self.scale))

    def __add__(self, other: Moments) -> Moments:
        """Return the moments of both sets of points together."""
        self._check_frame(other)
        return Moments(self.values + other.values, self.origin, self.scale)

    def __sub__(self, other: Moments) -> Moments:
        """Return the moments of the points of this set without those of another."""
        self._check_frame(other)
        return Moments(self.values - other.values, self.origin, self.scale)

    def _check_frame(self, other: Moments) -> None:
        if not isinstance(other, Moments) or (other.origin, other.scale) != (
            self.origin,
            self.scale,
        ):
            raise InputError("other", "Moments of the same origin and scale", describe(other))


def point_moments(
    points: npt.ArrayLike,
    origin: tuple[float, float] = (0.0, 0.0),
    scale: float = 1.0,
    weights: npt.ArrayLike | None = None,
) -> Moments:
    """Return the moments of points, weighted or not, about an origin and in units of a scale.

    The sum of the weights counts as the number of points, of which a fit wants at least five.

    The nearer the origin to the points and the scale to their extent, the less precision a
    fit loses: an ellipse of semi-minor axis b at a distance r loses a factor of (r / b)^4.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array, the scale is not positive, or the weights are not
        (n,) of at least 0.

    References
    ----------
    Thesis (4-57).

    Examples
    --------
    >>> point_moments([(1, 2), (3, 4)]).values[:6].tolist()
    [2.0, 4.0, 6.0, 10.0, 14.0, 20.0]
    """
    cloud = _check.points(points)
    frame = Moments(np.zeros(15), origin, scale)
    values = np.zeros(15)
    own = checked_weights(weights, len(cloud))
    if len(own):
        add_weighted_moments(cloud, own, *frame.origin, float(scale), values)
    else:
        add_moments(cloud, *frame.origin, float(scale), values)
    return Moments(values, origin, scale)


def fit_moments(
    moments: Moments, method: str = "ellifit", limits: FitParams | None = None
) -> EllipseFit:
    """Fit an ellipse to points that are known by their moments alone.

    Moments do not tell repeated points apart; where fewer than five are distinct, the reason
    says that more than one conic is free. The residual is known to about 1e-8.

    Parameters
    ----------
    moments : Moments
    method : str
        One of nsaf, ellifit, halir_flusser, fitzgibbon, harker, chaudhuri, taubin, linear and
        hyper, of which the leading terms are used: the others need moments of order 6.
    limits : FitParams, optional
        Limits on the axes.

    Returns
    -------
    EllipseFit
        As from the method of that name.

    Raises
    ------
    InputError
        The moments are not a Moments.
    ParameterError
        The method is unknown.

    Examples
    --------
    >>> t = np.linspace(0, 3, 20)
    >>> arc = np.stack([9 * np.cos(t), 5 * np.sin(t)], axis=1)
    >>> both = point_moments(arc) + point_moments(-arc)
    >>> round(fit_moments(both).ellipse.semi_minor, 9)
    5.0
    """
    if not isinstance(moments, Moments):
        raise InputError("moments", "a Moments", describe(moments))
    if method not in _METHODS:
        raise ParameterError("method", "one of " + ", ".join(_METHODS), describe(method))
    x, y = moments.origin
    kernel, number = _METHODS[method]
    return outcome(*kernel(moments.values, x, y, float(moments.scale), number), limits)
