"""How far DEB can be from the tangent, and the radius that follows (thesis 3.4).

Of a smooth curve, P1 and P2 lie at the distance R from P0: the triangle has two equal sides, and
the chord's direction is the mean of those of P1P0 and P0P2. Both differ from the tangent by
kappa R / 2 to first order, with opposite signs; what is left is

    kappa' R^2 / 6 + O(R^4),        kappa' = d kappa / ds at P0        (`analytic_error`).

A bound without a remainder follows from the curvature as a function of the distance r from P0.
With m(r) the mean of kappa over the distances below r, weighted with the distance, halved, the
direction of the chord from P0 changes by m / sqrt(1 - (r m)^2) a unit of r. The difference of
both sides is at most 2/3 r max|d kappa / dr|, and d kappa / dr = kappa' / cos(alpha) with
cos(alpha) >= sqrt(1 - (R k / 2)^2), k being the largest |kappa| between P1 and P2. So

    |error| <= max|kappa'| R^2 / 6 / (1 - (R k / 2)^2)^2               (`analytic_bound`).

Pixels take the place of P1 and P2 and turn their chord by at most
`geoprim_core.digital.exact_slope_bounds`. The sum bounds DEB as thesis 3.4 and 3.5 see it: P1
and P2 exactly on the circle, then rounded. The walk along pixels (Figure 3.3-1) takes P1 and P2
at unequal distances from a pixel beside the curve: `walk_bound` says what that adds.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray
from geoprim_core.digital import exact_slope_bounds
from geoprim_core.errors import InputError


def analytic_error(curvature_slope: npt.ArrayLike, radius: float) -> FloatArray:
    """Return the error of DEB on smooth curves to leading order, in radians.

    Parameters
    ----------
    curvature_slope : array
        d kappa / ds at P0, in 1 / px^2.
    radius : float
        R in pixels.

    References
    ----------
    Thesis (3-25), (3-27); errata T2: of order R^2, not R^3.

    Examples
    --------
    >>> analytic_error([0.0006, -0.0006], 10.0).round(6).tolist()
    [0.01, 0.01]
    """
    result: FloatArray = np.abs(np.asarray(curvature_slope, np.float64)) * (radius**2 / 6.0)
    return result


def analytic_bound(
    curvature_slope: npt.ArrayLike, curvature: npt.ArrayLike, radius: float
) -> FloatArray:
    """Return what the error of DEB on smooth curves never exceeds, in radians.

    Parameters
    ----------
    curvature_slope, curvature : arrays
        The largest |d kappa / ds| and |kappa| between P1 and P2, in 1 / px^2 and 1 / px.
    radius : float
        R in pixels.

    Returns
    -------
    array
        A right angle, which no line exceeds, where the bound is larger or R k >= 2.

    References
    ----------
    Thesis (3-27), which a true error exceeds; errata T2. The proof is in the module's text.

    Examples
    --------
    >>> analytic_bound(0.0006, 0.05, 10.0).round(6).tolist()
    0.011378
    """
    slope, bend = np.abs(np.asarray(curvature_slope)), np.abs(np.asarray(curvature))
    room = np.maximum(1.0 - (0.5 * radius * bend) ** 2, 1e-9)
    result: FloatArray = np.minimum(analytic_error(slope, radius) / room**2, 0.5 * math.pi)
    return result


def conic_analytic_error(
    eccentricity: float, latus: float, theta: npt.ArrayLike, radius: float
) -> FloatArray:
    """Return the leading-order error of DEB on the conic r (1 - e cos theta) = latus.

    |error| = e^2 |sin t (e - cos t)| u^4 R^2 / (2 (a e)^2 w^3), u = 1 - e cos t,
    w = 1 + e^2 - 2 e cos t.

    Parameters
    ----------
    eccentricity : float
        e; 0 gives a circle.
    latus : float
        Semi-latus rectum in pixels, a e in (3-20).
    theta : array
        Polar angles about the focus in radians.
    radius : float
        R in pixels.

    References
    ----------
    Thesis (3-20), (3-27); errata T2.

    Examples
    --------
    >>> conic_analytic_error(0.0, 50.0, [1.0, 2.0], 10.0).tolist()
    [0.0, 0.0]
    """
    return analytic_error(conic_curvature(eccentricity, latus, theta)[1], radius)


def conic_curvature(
    eccentricity: float, latus: float, theta: npt.ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Return kappa and d kappa / ds of the conic r (1 - e cos theta) = latus.

    Examples
    --------
    >>> float(conic_curvature(0.0, 50.0, [1.0])[0][0])
    0.02
    """
    t, e = np.asarray(theta, np.float64), eccentricity
    u, w = 1.0 - e * np.cos(t), 1.0 + e * e - 2.0 * e * np.cos(t)
    slope = 3.0 * e * e * np.sin(t) * (e - np.cos(t)) * u**4 / (latus**2 * w**3)
    return u**3 / (latus * w**1.5), slope


def total_bound(analytic: npt.ArrayLike, chords: npt.ArrayLike) -> FloatArray:
    """Return the total error bound in radians: the analytic one and that of the digitisation.

    Parameters
    ----------
    analytic : (n,) array
        In radians, of `analytic_bound`.
    chords : (n, 2) array
        From P1 to P2 before they are rounded, in pixels.

    Raises
    ------
    InputError
        The chords are not a finite (n, 2) array.

    References
    ----------
    Thesis (3-30); errata P4, T2, T3.

    Examples
    --------
    >>> total_bound([0.01], [(20.0, 0.0)]).round(4).tolist()  # atan(1 / 19) + 0.01
    [0.0626]
    """
    result: FloatArray = np.asarray(analytic, np.float64) + exact_slope_bounds(chords)
    return result


def walk_bound(curvature: npt.ArrayLike) -> FloatArray:
    """Return to first order what the walk along pixels adds to the total bound, in radians.

    The walk takes P1 and P2 within 1 / sqrt(2) of the circle, and each of the three pixels may
    be half a pixel from the curve: their distances differ by up to 2 + sqrt(2) pixels. That
    moves the middle of the chord along the curve by half as much.

    Parameters
    ----------
    curvature : array
        The largest |kappa| between P1 and P2, in 1 / px.

    References
    ----------
    Thesis 3.3.1, Figure 3.3-1; the thesis leaves this part out.

    Examples
    --------
    >>> walk_bound(0.01).round(5).tolist()
    0.01707
    """
    result: FloatArray = np.abs(np.asarray(curvature, np.float64)) * (1.0 + math.sqrt(0.5))
    return result


def conic_radius(eccentricity: float, focal: float, tolerance: float = 0.5) -> float:
    """Return R of (3-31) for the conic r (1 - e cos theta) = a e.

    Parameters
    ----------
    eccentricity : float
        e > 0.
    focal : float
        a, the distance between focus and directrix, in pixels.
    tolerance : float
        D_tol, below 1.

    Raises
    ------
    InputError
        An argument is not positive and finite.

    References
    ----------
    Thesis (3-26), (3-31).

    Examples
    --------
    >>> conic_radius(1.0, 100.0, 0.2)
    10.0
    """
    e, a = _positive(eccentricity, "eccentricity"), _positive(focal, "focal")
    return _positive(tolerance, "tolerance") * a * e / (1.0 + e)


def circle_radius(smallest: float, tolerance: float = 0.5) -> float:
    """Return R of (3-32) where no curve bends more than a circle of the radius `smallest`.

    Raises
    ------
    InputError
        An argument is not positive and finite.

    References
    ----------
    Thesis (3-32); errata T2: (3-33) has the wrong sign of its exponent. In pixels of a finer
    grid the same curve has a larger radius, so that the rule already follows the grid.

    Examples
    --------
    >>> circle_radius(20.0)
    10.0
    """
    return _positive(tolerance, "tolerance") * _positive(smallest, "smallest")


def _positive(value: float, argument: str) -> float:
    if not (math.isfinite(value) and value > 0.0):
        raise InputError(argument, "a positive, finite number", _check.describe(value))
    return float(value)
