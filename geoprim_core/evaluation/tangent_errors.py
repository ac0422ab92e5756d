"""Errors of tangent estimators on families of digital curves whose true tangents are known.

Errors are angles between the estimated direction of travel and the true one, in degrees, 0 to
180, at every pixel; `geoprim_core.synthetic.digitised` says what the true tangent of a pixel is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core.synthetic import (
    DigitisedCurve,
    as_contours,
    digital_circle,
    digital_ellipse,
    flower_curve,
)
from geoprim_core.tangent import TABLE, estimate_tangents

RADIUS = 100.0
CONTROLS = ("radius", "half_window")
_SECTORS = 72


@dataclass(frozen=True, slots=True)
class Entrant:
    """A method with values of its parameters, under the name that tables give it."""

    label: str
    method: str
    values: tuple[tuple[str, object], ...] = ()

    def angles(self, curves: Sequence[DigitisedCurve]) -> FloatArray:
        """Return the estimated directions at every pixel of all curves, in their order."""
        params = TABLE[self.method].params.from_dict(dict(self.values))
        return estimate_tangents(as_contours(list(curves)), self.method, params).angle


@dataclass(frozen=True, slots=True)
class Row:
    """The errors of one entrant on the curves of one setting, in degrees.

    Attributes
    ----------
    mean : float
        Over all pixels with a direction.
    maximum : float
        The largest error of each curve, averaged over the curves.
    worst : float
        The largest error of all.
    defined : float
        Share of pixels with a direction.
    """

    family: str
    setting: float
    label: str
    mean: float
    maximum: float
    worst: float
    defined: float


def control_of(method: str) -> str | None:
    """Return the name of a method's control parameter (R or Q), None where it has none.

    Examples
    --------
    >>> control_of("deb")
    'radius'
    """
    names = {option.name for option in TABLE[method].params.options()}
    return next((name for name in CONTROLS if name in names), None)


def with_control(method: str, value: float) -> Entrant:
    """Return a method at a value of its control parameter.

    Examples
    --------
    >>> with_control("deb", 10).label
    'deb(10)'
    """
    name = str(control_of(method))
    exact = round(value) if name == "half_window" else float(value)
    return Entrant(f"{method}({value:g})", method, ((name, exact),))


def family_curves(
    family: str, setting: float, count: int, seed: int, size: float = RADIUS
) -> list[DigitisedCurve]:
    """Return `count` curves of a setting, their centres drawn from a square of 2 x 2 pixels.

    Examples
    --------
    >>> len(family_curves("ellipse", 0.8, 3, seed=0))
    3
    """
    random = np.random.default_rng([seed, round(1000 * setting), round(size)])
    centres = random.uniform(149.0, 151.0, (count, 2)) - 150.0
    return [_curve(family, setting, size, (float(x), float(y))) for x, y in centres]


def _curve(family: str, setting: float, size: float, centre: tuple[float, float]) -> DigitisedCurve:
    if family == "circle":
        return digital_circle(size, centre)
    if family == "ellipse":
        return digital_ellipse(size, size * float(np.sqrt(1 - setting**2)), 0.0, centre)
    return flower_curve(int(setting), size, 0.5, centre)


def errors_of(entrant: Entrant, curves: Sequence[DigitisedCurve]) -> FloatArray:
    """Return the errors in degrees at every pixel of all curves, NaN where undefined.

    Examples
    --------
    >>> errors = errors_of(with_control("deb", 10), family_curves("circle", 0.0, 1, seed=0))
    >>> bool(errors.mean() < 1.5)
    True
    """
    truth = np.concatenate([curve.tangent for curve in curves])
    turn = entrant.angles(curves) - truth
    errors: FloatArray = np.degrees(np.abs((turn + np.pi) % (2.0 * np.pi) - np.pi))
    return errors


def measure(
    name: str, setting: float, entrants: Sequence[Entrant], curves: Sequence[DigitisedCurve]
) -> list[Row]:
    """Return the row of every entrant on some curves.

    Examples
    --------
    >>> curves = family_curves("circle", 0.0, 2, seed=0)
    >>> measure("circle", 0.0, [with_control("deb", 10)], curves)[0].defined
    1.0
    """
    starts = np.cumsum([0, *(len(curve.points) for curve in curves[:-1])])
    rows = []
    for entrant in entrants:
        errors = errors_of(entrant, curves)
        known = np.isfinite(errors)
        safe = np.where(known, errors, 0.0)
        mean = float(safe.sum() / max(known.sum(), 1)) if known.any() else float("nan")
        largest = np.maximum.reduceat(safe, starts)
        figures = (mean, float(largest.mean()), float(safe.max()), float(known.mean()))
        rows.append(Row(name, setting, entrant.label, *figures))
    return rows


def pooled(rows: Iterable[Row], family: str) -> dict[str, Row]:
    """Return label -> the row of a whole family: means over its settings, the worst of all.

    Examples
    --------
    >>> two = [Row("flower", n, "a", n, 2 * n, 3 * n, 1.0) for n in (1, 3)]
    >>> pooled(two, "flower")["a"].mean, pooled(two, "flower")["a"].worst
    (2.0, 9.0)
    """
    parts: dict[str, list[Row]] = {}
    for row in rows:
        if row.family == family:
            parts.setdefault(row.label, []).append(row)

    def mean_of(found: list[Row], name: str, how: Callable[..., float] = np.mean) -> float:
        return float(how([getattr(row, name) for row in found]))

    return {
        label: Row(
            family,
            float("nan"),
            label,
            mean_of(found, "mean"),
            mean_of(found, "maximum"),
            mean_of(found, "worst", max),
            mean_of(found, "defined"),
        )
        for label, found in parts.items()
    }


def order_of_convergence(sizes: Sequence[float], errors: Sequence[float]) -> float:
    """Return k of the fit error = c h^k with h = 1 / size.

    Examples
    --------
    >>> round(order_of_convergence([10.0, 100.0, 1000.0], [3.0, 0.3, 0.03]), 6)
    1.0
    """
    return float(-np.polyfit(np.log(sizes), np.log(np.maximum(errors, 1e-12)), 1)[0])


def errors_by_direction(
    entrants: Sequence[Entrant], count: int, seed: int
) -> dict[str, FloatArray]:
    """Return label -> mean error on circles in each of 72 sectors of the true direction.

    Examples
    --------
    >>> errors_by_direction([with_control("deb", 10)], 2, 0)["deb(10)"].shape
    (72,)
    """
    curves = family_curves("circle", 0.0, count, seed)
    truth = np.concatenate([curve.tangent for curve in curves]) % (2.0 * np.pi)
    sector = np.minimum((truth * (_SECTORS / (2.0 * np.pi))).astype(np.int64), _SECTORS - 1)
    found = {}
    for entrant in entrants:
        errors = errors_of(entrant, curves)
        known = np.isfinite(errors)
        sums = np.bincount(sector[known], errors[known], _SECTORS)
        found[entrant.label] = sums / np.maximum(np.bincount(sector[known], minlength=_SECTORS), 1)
    return found
