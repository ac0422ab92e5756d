"""DEB: tangents of definite error bound, from the chord that a circle cuts out of the curve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core.params import Params, as_params, option
from geoprim_core.tangent._kernels_deb import deb_chords, deb_curvature
from geoprim_core.tangent.pencils import pencils_of

_LEAST_RADIUS = 3.0


@dataclass(frozen=True)
class DebParams(Params):
    """Parameters of DEB."""

    radius_rule: str = option(
        "fixed",
        "R: the radius given, (3-32) for the smallest circle, or automatic at every pixel",
        choices=("fixed", "smallest_circle", "auto"),
    )
    radius: float = option(
        4.0, "radius of the circle around the pixel (rule fixed)", unit="px", low=1.0, high=1000.0
    )
    smallest_circle: float = option(
        8.0, "rho_min: radius of the smallest circle expected (rule smallest_circle)", unit="px",
        low=1.0, high=100000.0,
    )  # fmt: skip
    tolerance: float = option(
        0.5, "D_tol: R is at most this share of the radius of curvature (the other two rules)",
        low=0.01, high=1.0,
    )  # fmt: skip


def deb(
    points: npt.ArrayLike, *, closed: bool = False, params: DebParams | None = None
) -> FloatArray:
    """Estimate the direction of travel at every pixel of a digital curve.

    The first pixel backwards (P1) and the first one forwards (P2) whose distance from the
    pixel is the radius up to 1 / sqrt(2) are joined; the direction is that from P1 to P2.

    Parameters
    ----------
    points : (n, 2) array
        Pixels of the curve in order.
    closed : bool
        Whether the last pixel touches the first.
    params : DebParams, optional

    Returns
    -------
    (n,) float64
        Angles in radians in (-pi, pi]. NaN where P1 or P2 does not exist, as near the ends of
        an open curve or on a closed one smaller than the circle, or where both coincide.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array; with the automatic radius also if they are not
        whole numbers or a step is longer than 1000 px.

    References
    ----------
    D. K. Prasad, M. K. H. Leung, C. Quek and M. S. Brown, "DEB: definite error bounded tangent
    estimator for digital curves", IEEE Transactions on Image Processing 23, 2014; thesis
    3.3.1, Figure 3.3-1 with its loop condition inverted: errata T1. Radius: `radii_of`.

    Examples
    --------
    >>> line = [(i, i) for i in range(9)]
    >>> deb(line).round(4).tolist()
    [nan, nan, nan, 0.7854, 0.7854, 0.7854, nan, nan, nan]
    """
    curve = _check.points(points)
    flags = np.array([bool(closed)])
    return deb_batch(curve, np.array([0, len(curve)]), flags, as_params(params, DebParams))


def deb_batch(
    points: FloatArray, offsets: IntArray, closed: BoolArray, params: DebParams
) -> FloatArray:
    """Estimate the directions of many curves in one kernel call; arguments as in `Contours`.

    Returns
    -------
    (N,) float64
        As in `Tangents`.

    Examples
    --------
    >>> line = np.stack([np.arange(7.0), np.zeros(7)], axis=1)
    >>> float(deb_batch(line, np.array([0, 7]), np.array([False]), DebParams(radius=2.0))[3])
    0.0
    """
    curves = zip(offsets, offsets[1:], closed, strict=False)
    radii = fixed_radius(params)
    if params.radius_rule == "auto":
        parts = [radii_of(points[a:b], params, closed=bool(flag)) for a, b, flag in curves]
        radii = np.concatenate([np.zeros(0), *parts])
    chords = deb_chords(points, offsets, closed, radii)
    angle: FloatArray = np.arctan2(chords[:, 1], chords[:, 0])  # all at once: numpy's is quicker
    return angle


def deb_bends(points: npt.ArrayLike, closed: bool, params: DebParams | None) -> FloatArray:
    """Return the curvatures (n,) of the circles through P1, the pixel and P2."""
    checked: DebParams = as_params(params, DebParams)
    curve = _check.points(points)
    bends: FloatArray = deb_curvature(curve, bool(closed), radii_of(curve, checked, closed=closed))
    return bends


def fixed_radius(params: DebParams) -> FloatArray:
    """Return the one radius (1,) of the rules that need no look at the curve."""
    smallest = params.radius_rule == "smallest_circle"
    return np.array([params.tolerance * params.smallest_circle if smallest else params.radius])


def radii_of(points: npt.ArrayLike, params: DebParams, *, closed: bool = False) -> FloatArray:
    """Choose the radius of DEB: (1,) for the rules that give one, (n,) for the automatic one.

    A longer chord has a smaller digital error, of about 1 / R, and a larger analytical one,
    |d kappa / ds| R^2 / 6 (errata T2). With d kappa / ds of about 1 / rho^2, which an ellipse of
    aspect 2 reaches, the sum is least for R^3 = 3 rho^2. The radius of curvature rho comes from
    the maximal segments at the pixel: a segment of L pixels, one pixel high, fits a circle of
    rho = L^2 / 8. L - 1 is the shorter one of the ways to the first pixel of the first segment
    and to the last pixel of the last (`half_windows`, choice 11), as the chord has to stay where
    the curve bends no more than at its pixel. R is below the tolerance times rho, as in (3-32),
    but 3 at least, the thesis' rule of thumb for the smallest circle of an image (3.4.3).

    Parameters
    ----------
    points : (n, 2) array
        Pixels of the curve in order.
    params : DebParams
    closed : bool
        Whether the last pixel touches the first.

    Returns
    -------
    (1,) or (n,) float64
        In pixels.

    Raises
    ------
    InputError
        The rule is automatic, and the points are not whole numbers or a step is longer than
        1000 px.

    References
    ----------
    Thesis (3-32) and 3.4.3; the automatic radius answers its future work.

    Examples
    --------
    >>> radii_of([(0, 0), (1, 0)], DebParams(radius_rule="smallest_circle")).tolist()
    [4.0]
    >>> line = [(i, 0) for i in range(20)]
    >>> radii_of(line, DebParams(radius_rule="auto")).round(2)[[0, 10]].tolist()
    [3.0, 6.25]
    """
    if params.radius_rule != "auto":
        return fixed_radius(params)
    back, ahead = pencils_of(points, closed=closed).reaches()
    rho = (np.minimum(back, ahead) + 1.0) ** 2 / 8.0
    chosen = np.minimum(np.cbrt(3.0 * rho**2), params.tolerance * rho)
    radii: FloatArray = np.maximum(chosen, _LEAST_RADIUS)
    return radii
