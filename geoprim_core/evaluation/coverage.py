"""Whether the covariance of a detection holds: a simulation with pictures of one ellipse."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from geoprim_core._check import BoolArray, FloatArray
from geoprim_core.ecc import DetectorParams
from geoprim_core.ecc.refined import RefinedTrace, trace_refined
from geoprim_core.edges import extract_contours
from geoprim_core.fitting.overlap import overlap_matrix
from geoprim_core.params import as_params
from geoprim_core.synthetic import SingleEllipse, single_ellipses

LEVELS = (0.68, 0.95)
"""The regions of a coverage table."""

COLUMNS = ("x", "y", "semi_major", "semi_minor", "angle")

_LEAST_OVERLAP = 0.8
_DISTINCT_RATIO = 0.9
_COUNT_OF_PARAMETERS = 5


def _minor(one: SingleEllipse) -> float:
    return float(one.scene.ellipses.semi_minor[0])


def _ratio(one: SingleEllipse) -> float:
    return _minor(one) / float(one.scene.ellipses.semi_major[0])


REGIMES: dict[str, Callable[[SingleEllipse], bool]] = {
    "all": lambda one: True,
    "filled": lambda one: one.drawing == "filled",
    "drawn lines": lambda one: one.drawing == "outlines",
    "circles": lambda one: _ratio(one) == 1.0,
    "axis ratio 0.5 .. 1": lambda one: 0.5 <= _ratio(one) < 1.0,
    "axis ratio below 0.5": lambda one: _ratio(one) < 0.5,
    "semi-minor axis below 8 px": lambda one: _minor(one) < 8.0,
    "semi-minor axis 8 .. 16 px": lambda one: 8.0 <= _minor(one) < 16.0,
    "semi-minor axis 16 .. 40 px": lambda one: 16.0 <= _minor(one) < 40.0,
    "semi-minor axis from 40 px": lambda one: _minor(one) >= 40.0,
    "wholly visible": lambda one: one.visible == 1.0,
    "60 .. 100 % visible": lambda one: 0.6 <= one.visible < 1.0,
    "30 .. 60 % visible": lambda one: one.visible < 0.6,
    "noise below 4 % of the contrast": lambda one: one.noise < 0.04 * one.contrast,
    "noise 4 .. 10 %": lambda one: 0.04 <= one.noise / one.contrast < 0.1,
    "noise 10 .. 20 %": lambda one: 0.1 <= one.noise / one.contrast < 0.2,
    "noise from 20 %": lambda one: one.noise >= 0.2 * one.contrast,
    "sharp": lambda one: one.blur == 0.0,
    "blur up to 0.75 px": lambda one: 0.0 < one.blur <= 0.75,
    "blur 0.75 .. 1.5 px": lambda one: one.blur > 0.75,
}
"""What the pictures of a simulation are told apart by; one may be in several."""


@dataclass(frozen=True, slots=True, eq=False)
class CoverageRow:
    """How often the regions of one regime hold the truth.

    Attributes
    ----------
    regime : str
    count : int
        Number of ellipses found.
    joint : (2,) float64
        Share of ellipses inside the joint region of each of `LEVELS`.
    single : (5, 2) float64
        The same for x, y, semi_major, semi_minor and angle by itself; the last three of the
        ellipses whose axes differ by a tenth or more, NaN where there are none.
    """

    regime: str
    count: int
    joint: FloatArray
    single: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Coverage:
    """Errors of n detections, measured by their covariance.

    Attributes
    ----------
    squares : (n,) float64
        Squared Mahalanobis distance of the truth, which should follow chi-square with 5 degrees
        of freedom. It is taken in x, y, the mean m of the semi-axes and half their difference d
        as d cos 2 angle, d sin 2 angle, all pixels: these stay smooth where an ellipse becomes a
        circle, while its angle is undefined and the order of its axes is chance.
    deviates : (n, 5) float64
        Errors of x, y, semi_major, semi_minor and angle over their standard deviations.
    distinct : (n,) bool
        Ellipses whose axes differ by a tenth or more.
    regimes : (n, R) bool
        To which of `REGIMES` each belongs.
    missed, unresolved : int
        Pictures in which the ellipse was not found, and drawn lines whose two edges were not
        taken for one line: what was found is an edge, of which the truth does not tell.
    """

    squares: FloatArray
    deviates: FloatArray
    distinct: BoolArray
    regimes: BoolArray
    missed: int
    unresolved: int

    def joint_share(self, level: float, chosen: BoolArray | None = None) -> float:
        """Return the share of truths inside the joint region of a level, NaN of none."""
        squares = self.squares if chosen is None else self.squares[chosen]
        limit = chi2.ppf(level, _COUNT_OF_PARAMETERS)
        return float(np.mean(squares <= limit)) if len(squares) else math.nan

    @property
    def rows(self) -> tuple[CoverageRow, ...]:
        """One row for every regime with ellipses in it."""
        used = np.flatnonzero(self.regimes.any(axis=0))
        names = tuple(REGIMES)
        return tuple(self._row(names[k], self.regimes[:, k]) for k in used)

    def _row(self, name: str, chosen: BoolArray) -> CoverageRow:
        joint = np.array([self.joint_share(level, chosen) for level in LEVELS])
        limits = np.sqrt(chi2.ppf(LEVELS, 1))
        inside = np.abs(self.deviates)[:, :, None] <= limits
        single = np.full((len(COLUMNS), len(LEVELS)), math.nan)
        single[:2] = inside[chosen, :2].mean(axis=0)
        if (chosen & self.distinct).any():
            single[2:] = inside[chosen & self.distinct, 2:].mean(axis=0)
        return CoverageRow(name, int(chosen.sum()), joint, single)

    def markdown(self) -> str:
        """Return the table of all regimes, shares in per cent."""
        lines = [
            "| pictures | ellipses | joint 68 % | joint 95 % | "
            + " | ".join(f"{name} 68 / 95 %" for name in COLUMNS)
            + " |",
            "|---|" + "---:|" * 8,
        ]
        for row in self.rows:
            cells = [f"{100 * share:.1f}" for share in row.joint]
            cells += [_pair(shares) for shares in row.single]
            lines.append(f"| {row.regime} | {row.count} | " + " | ".join(cells) + " |")
        lines.append(
            f"\n{self.missed} ellipses were not found, {self.unresolved} lines not taken for lines."
        )
        return "\n".join(lines)


def measure_coverage(
    count: int = 1000, *, seed: int = 0, params: DetectorParams | None = None
) -> Coverage:
    """Simulate how often the covariance of a detection holds.

    Detects the ellipse in each of `single_ellipses(count, seed)` by the `refined` scheme and
    compares the detection of the largest overlap, if that is 0.8 or more, with the truth.

    Parameters
    ----------
    count : int
        Number of pictures.
    seed : int
        The same number gives the same figures.
    params : DetectorParams, optional

    Returns
    -------
    Coverage

    Raises
    ------
    InputError
        A negative count or seed.
    ParameterError
        `params` is not a `DetectorParams`.

    Examples
    --------
    >>> coverage = measure_coverage(8, seed=1)
    >>> len(coverage.squares) + coverage.missed + coverage.unresolved
    8
    """
    settings: DetectorParams = as_params(params, DetectorParams)
    return cover(single_ellipses(count, seed), settings)


def cover(pictures: Iterable[SingleEllipse], params: DetectorParams) -> Coverage:
    """Compare what is found in pictures of one ellipse with the truth."""
    squares, deviates, distinct, regimes = [], [], [], []
    missed = unresolved = 0
    for one in pictures:
        trace = trace_refined(
            extract_contours(one.scene.image, params.edges), None, params.ecc.refined
        )
        found = _found(trace, one)
        if found is None:
            missed += 1
        elif one.drawing == "outlines" and not trace.edges.stroke.any():
            unresolved += 1
        else:
            truth = one.scene.ellipses.array()[0]
            row, covariance = (
                trace.detections.ellipses.array()[found],
                trace.detections.covariance[found],
            )
            squares.append(squared_distance(row, covariance, truth))
            deviates.append(_error(row, truth) / np.sqrt(np.diag(covariance)))
            distinct.append(_ratio(one) <= _DISTINCT_RATIO)
            regimes.append([holds(one) for holds in REGIMES.values()])
    return Coverage(
        np.array(squares),
        np.array(deviates).reshape(-1, 5),
        np.array(distinct, bool),
        np.array(regimes, bool).reshape(-1, len(REGIMES)),
        missed,
        unresolved,
    )


def squared_distance(row: FloatArray, covariance: FloatArray, truth: FloatArray) -> float:
    """Return the squared Mahalanobis distance of an ellipse row (5,) from the true one.

    It is taken in parameters that stay smooth at circles, see `Coverage`.

    Raises
    ------
    numpy.linalg.LinAlgError
        The covariance is singular.

    Examples
    --------
    >>> variances = np.diag([0.04, 0.04, 0.02, 0.02, 0.01])
    >>> row = np.array([10.2, 10.0, 20.0, 15.0, 0.3])
    >>> round(squared_distance(row, variances, np.array([10.0, 10.0, 20.0, 15.0, 0.3])), 6)
    1.0
    """
    slopes = _smooth_slopes(row)
    error = _smooth(row) - _smooth(truth)
    spread = slopes @ covariance @ slopes.T
    # Of an exact circle the angle moves nothing; the least scatter that a position can have.
    spread += 1e-12 * np.eye(5)
    return float(error @ np.linalg.solve(spread, error))


def _pair(shares: FloatArray) -> str:
    return "" if np.isnan(shares).any() else "{:.0f} / {:.0f}".format(*(100 * shares))


def _found(trace: RefinedTrace, one: SingleEllipse) -> int | None:
    """Return the index of the detection that is the ellipse, None where there is none."""
    overlaps = overlap_matrix(trace.detections.ellipses, one.scene.ellipses)[:, 0]
    if len(overlaps) == 0 or overlaps.max() < _LEAST_OVERLAP:
        return None
    best = int(overlaps.argmax())
    return best if np.isfinite(trace.detections.covariance[best]).all() else None


def _error(row: FloatArray, truth: FloatArray) -> FloatArray:
    """Return the differences of two ellipses, that of the angle within a quarter turn."""
    error = row - truth
    error[4] = (error[4] + 0.5 * math.pi) % math.pi - 0.5 * math.pi
    return error


def _smooth(row: FloatArray) -> FloatArray:
    """Return x, y, mean semi-axis and half the difference as a vector at twice the angle."""
    x, y, a, b, angle = row
    half = 0.5 * (a - b)
    return np.array([x, y, 0.5 * (a + b), half * np.cos(2 * angle), half * np.sin(2 * angle)])


def _smooth_slopes(row: FloatArray) -> FloatArray:
    """Return the derivatives (5, 5) of the smooth parameters."""
    _, _, a, b, angle = row
    cos, sin = np.cos(2 * angle), np.sin(2 * angle)
    slopes = np.zeros((5, 5))
    slopes[0, 0] = slopes[1, 1] = 1.0
    slopes[2, 2:4] = 0.5
    slopes[3, 2:] = 0.5 * cos, -0.5 * cos, -(a - b) * sin
    slopes[4, 2:] = 0.5 * sin, -0.5 * sin, (a - b) * cos
    return slopes
