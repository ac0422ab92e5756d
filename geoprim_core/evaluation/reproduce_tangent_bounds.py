"""Thesis 3.2.2 and 3.5, rerun: Yuen's sensitivity to tangents, and the bounds of DEB on conics."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core.digital import exact_slope_bounds
from geoprim_core.polygon import slope_bound
from geoprim_core.tangent import three_point_centre
from geoprim_core.tangent.bounds import (
    analytic_bound,
    conic_analytic_error,
    conic_curvature,
    total_bound,
)

RADII = (3.0, 5.0, 7.0, 10.0)
TURNS = np.radians(np.linspace(-15.0, 15.0, 61))
SEMI_MAJORS = tuple(range(10, 101, 5))
_PLACES = np.array([-5.0 * np.pi / 12, np.pi / 4, 11.0 * np.pi / 12])
_ECCENTRICITY = 0.8
_FARTHEST = 5000.0  # px from the focus: beyond, the branches of open conics are straight
_WINDOW = 33  # samples between P1 and P2


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """Relative errors |O' - O| / a of Yuen's centre, one a turn of the tangents (3-9)."""

    test: int
    digitised: bool
    semi_major: float
    errors: FloatArray

    @property
    def mean(self) -> float:
        """The mean over the turns."""
        return float(np.nanmean(self.errors))

    @property
    def maximum(self) -> float:
        """The largest over the turns."""
        return float(np.nanmax(self.errors))


@dataclass(frozen=True, slots=True)
class BoundRow:
    """The largest errors and bounds of DEB on one conic and R, in degrees.

    Attributes
    ----------
    family : {"conics", "parabolae", "circles"}
    value : float
        e, a or rho.
    radius : float
        R in pixels.
    analytic, digital, total : float
        Largest measured errors: P1 and P2 on the curve; by their rounding; of both.
    leading, printed : float
        The analytic error to leading order (errata T2), and (3-27) as printed.
    analytic_limit, digital_limit, total_limit : float
        Largest bounds.
    places, exceeded : int
        Points of the conic, and those with a total error above their total bound.
    printed_exceeded, digital_exceeded : int
        Points with an analytic error above (3-27), and with one by rounding above (3-28), both as
        printed.
    shortest : float
        Least distance of P1 and P2, in pixels.
    """

    family: str
    value: float
    radius: float
    analytic: float
    digital: float
    total: float
    leading: float
    printed: float
    analytic_limit: float
    digital_limit: float
    total_limit: float
    places: int
    exceeded: int
    printed_exceeded: int
    digital_exceeded: int
    shortest: float


def yuen_errors(test: int, semi_major: float, *, digitised: bool) -> Sensitivity:
    """Return the errors of Yuen's centre of test 1 or 2 over all turns of -15 to 15 degrees.

    References
    ----------
    Thesis (3-9) to (3-14), e = 0.8; errata T4.

    Examples
    --------
    >>> exact = yuen_errors(1, 100.0, digitised=False)
    >>> bool(exact.errors[30] < 1e-9)  # no turn, no error
    True
    """
    semi_minor = semi_major * np.sqrt(1.0 - _ECCENTRICITY**2)
    axes = np.array([semi_major, semi_minor])
    points = axes * np.stack([np.cos(_PLACES), np.sin(_PLACES)], axis=1)
    slopes = axes * np.stack([-np.sin(_PLACES), np.cos(_PLACES)], axis=1)
    if digitised:
        points = np.floor(points + 0.5)
    turned = np.array([1.0, 0.0, 1.0] if test == 1 else [0.0, 1.0, 0.0])
    errors = []
    for turn in TURNS:
        centre = three_point_centre(points, np.arctan2(*slopes.T[::-1]) + turn * turned)
        errors.append(np.nan if centre is None else float(np.hypot(*centre)) / semi_major)
    return Sensitivity(test, digitised, semi_major, np.array(errors))


def sensitivities() -> list[Sensitivity]:
    """Return tests 1 and 2 without digitisation, and with it for a = 10 .. 100.

    Examples
    --------
    >>> len(sensitivities()) == 2 + 2 * len(SEMI_MAJORS)
    True
    """
    exact = [yuen_errors(test, 100.0, digitised=False) for test in (1, 2)]
    return exact + [yuen_errors(test, a, digitised=True) for test in (1, 2) for a in SEMI_MAJORS]


def conic_points(eccentricity: float, latus: float, theta: FloatArray) -> FloatArray:
    """Return points (n, 2) of the conic r (1 - e cos theta) = latus.

    Examples
    --------
    >>> conic_points(0.0, 2.0, np.array([0.0])).tolist()
    [[2.0, 0.0]]
    """
    r = latus / (1.0 - eccentricity * np.cos(theta))
    return np.stack([r * np.cos(theta), r * np.sin(theta)], axis=1)


def chord_ends(
    eccentricity: float, latus: float, theta: FloatArray, radius: float
) -> tuple[FloatArray, FloatArray]:
    """Return the polar angles of P1 (behind) and P2 (ahead), at the distance R from P0.

    Examples
    --------
    >>> back, ahead = chord_ends(0.0, 10.0, np.array([1.0]), 10.0)
    >>> bool(abs(ahead[0] - 1.0 - np.pi / 3) < 1e-9)
    True
    """
    here = conic_points(eccentricity, latus, theta)
    u = 1.0 - eccentricity * np.cos(theta)
    speed = latus / u**2 * np.sqrt(u**2 + (eccentricity * np.sin(theta)) ** 2)
    ends = []
    for way in (-1.0, 1.0):
        low, high = np.zeros(len(theta)), np.full(len(theta), 0.25 * radius) / speed
        for _ in range(8):  # widen until the circle is left
            inside = _distance(eccentricity, latus, here, theta + way * high) < radius
            low, high = np.where(inside, high, low), np.where(inside, 2.0 * high, high)
        for _ in range(60):
            middle = 0.5 * (low + high)
            inside = _distance(eccentricity, latus, here, theta + way * middle) < radius
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
        ends.append(theta + way * 0.5 * (low + high))
    return ends[0], ends[1]


def _distance(eccentricity: float, latus: float, here: FloatArray, theta: FloatArray) -> FloatArray:
    there = conic_points(eccentricity, latus, theta)
    same_branch = 1.0 - eccentricity * np.cos(theta) > 0.0
    return np.where(same_branch, np.hypot(*(there - here).T), np.inf)


def printed_bound(
    eccentricity: float, latus: float, theta: FloatArray, radius: float
) -> FloatArray:
    """Return the bound (3-27) as printed, in radians.

    Examples
    --------
    >>> float(printed_bound(0.0, 10.0, np.array([1.0]), 5.0)[0])
    0.0
    """
    e = eccentricity
    u, w = 1.0 - e * np.cos(theta), 1.0 + e * e - 2.0 * e * np.cos(theta)
    big = u**2 * (radius / latus) / np.sqrt((e * np.sin(theta)) ** 2 + u**2)
    return np.asarray(0.5 * e * e * big**3 / u * np.sin(theta) ** 2 / w)


def bound_row(
    family: str, value: float, conic: tuple[float, float], radius: float, places: int = 360
) -> BoundRow:
    """Compare errors and bounds at points spread over the polar angles of a conic.

    Each point has a grid of its own, turned and shifted, so that the family is seen in every
    direction: a hyperbola of great eccentricity is nearly a line.

    Parameters
    ----------
    family, value
        As in the row.
    conic : (e, latus)
    radius : float
    places : int

    Examples
    --------
    >>> row = bound_row("circles", 50.0, (0.0, 50.0), 10.0)
    >>> row.exceeded, row.analytic < 1e-6
    (0, True)
    """
    theta = _places(*conic, places)
    back, ahead = chord_ends(*conic, theta, radius)
    first, second, tangent = _on_grids(
        conic_points(*conic, back), conic_points(*conic, ahead), _tangent(*conic, theta)
    )
    rounded = np.floor(second + 0.5) - np.floor(first + 0.5)
    analytic, total = line_angle(second - first, tangent), line_angle(rounded, tangent)
    digital = line_angle(rounded, np.arctan2(*(second - first).T[::-1]))
    limit = _analytic_limit(conic, back, ahead, radius)
    printed = printed_bound(*conic, theta, radius)
    whole = total_bound(limit, second - first)
    largest = {
        "analytic": analytic,
        "digital": digital,
        "total": total,
        "leading": conic_analytic_error(*conic, theta, radius),
        "printed": printed,
        "analytic_limit": limit,
        "digital_limit": exact_slope_bounds(second - first),
        "total_limit": whole,
    }
    return BoundRow(
        family,
        value,
        radius,
        **{name: float(np.degrees(each.max())) for name, each in largest.items()},
        places=len(theta),
        exceeded=int((total > whole + 1e-9).sum()),
        printed_exceeded=int((analytic > printed + 1e-9).sum()),
        digital_exceeded=int((digital > _printed_digital(second - first) + 1e-9).sum()),
        shortest=float(np.hypot(*(second - first).T).min()),
    )


def _printed_digital(chords: FloatArray) -> FloatArray:
    return np.array([slope_bound((0.0, 0.0), chord, "thesis") for chord in chords])


def _on_grids(
    first: FloatArray, second: FloatArray, tangent: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return P1, P2 and the tangents turned and shifted, differently at each place.

    Multiples of irrational shares of a turn and of a pixel spread evenly.
    """
    k = np.arange(len(tangent))
    turn = 2.0 * np.pi * (k * (0.5 * np.sqrt(5.0) - 0.5) % 1.0)
    shift = np.stack([k * np.sqrt(2.0) % 1.0, k * np.sqrt(3.0) % 1.0], axis=1)
    c, s = np.cos(turn), np.sin(turn)
    turned = [
        np.stack([c * p[:, 0] - s * p[:, 1], s * p[:, 0] + c * p[:, 1]], axis=1) + shift
        for p in (first, second)
    ]
    return turned[0], turned[1], tangent + turn


def _places(eccentricity: float, latus: float, count: int) -> FloatArray:
    """Return polar angles at which the conic is nearer to the focus than `_FARTHEST`."""
    edge = (1.0 - latus / _FARTHEST) / eccentricity if eccentricity > 0.0 else 1.0
    start = np.arccos(min(edge, 1.0)) if edge > -1.0 else np.pi
    step = 2.0 * (np.pi - start) / count
    return np.asarray(start + (np.arange(count) + 0.5) * step, np.float64)


def _tangent(eccentricity: float, latus: float, theta: FloatArray) -> FloatArray:
    """Return the direction of travel at polar angles that grow; slope (3-21)."""
    slope = np.arctan2(eccentricity - np.cos(theta), np.sin(theta))
    return np.asarray(slope + np.pi, np.float64)


def line_angle(chord: FloatArray, angle: FloatArray) -> FloatArray:
    """Return the angles between lines, 0 to a right angle.

    Examples
    --------
    >>> line_angle(np.array([[-1.0, 0.0]]), np.array([0.25])).tolist()
    [0.25]
    """
    turn = np.arctan2(chord[:, 1], chord[:, 0]) - angle
    return np.asarray(np.abs((turn + 0.5 * np.pi) % np.pi - 0.5 * np.pi))


def _analytic_limit(
    conic: tuple[float, float], back: FloatArray, ahead: FloatArray, radius: float
) -> FloatArray:
    share = np.linspace(0.0, 1.0, _WINDOW)[:, None]
    curvature, slope = conic_curvature(*conic, back + share * (ahead - back))
    return analytic_bound(np.abs(slope).max(axis=0), np.abs(curvature).max(axis=0), radius)


def bound_rows(count: int) -> Iterator[BoundRow]:
    """Yield the rows of 3.5.1.1 to 3.5.1.3, `count` conics a family and all of `RADII`.

    The conics have a = 200 and e from 0.1 to 100,000, the parabolae a from 30 to 500, the
    circles rho from 10^1.3 to 10^5; values grow by equal factors.

    Examples
    --------
    >>> sorted({row.family for row in bound_rows(2)})
    ['circles', 'conics', 'parabolae']
    """
    families = {
        "conics": np.geomspace(0.1, 1e5, count),
        "parabolae": np.geomspace(30.0, 500.0, count),
        "circles": np.geomspace(10**1.3, 1e5, count),
    }
    for family, values in families.items():
        for value in values.tolist():
            conic = {
                "conics": (value, 200.0 * value),
                "parabolae": (1.0, value),
                "circles": (0.0, value),
            }[family]
            for radius in RADII:
                yield bound_row(family, value, conic, radius)
