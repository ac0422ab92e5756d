"""The experiments of thesis 4.5: every method on the same random curves, counted by setting."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, fields
from functools import partial
from multiprocessing import get_context

import numpy as np
import numpy.typing as npt

from geoprim_core._check import AnyArray, FloatArray
from geoprim_core.ecc.arcs import split_arcs
from geoprim_core.edges import extract_contours
from geoprim_core.evaluation.fitting import (
    DetectionCounts,
    accepted,
    detection_counts,
    fit_errors,
)
from geoprim_core.fitting import TABLE
from geoprim_core.polygon import approximate
from geoprim_core.synthetic import elliptic_arc, noisy_ellipse, open_conic, thesis_image
from geoprim_core.types import Ellipse, EllipseFit

Fit = Callable[[npt.ArrayLike], EllipseFit]

ARC_SPANS = (90, 112.5, 135, 180, 225, 270, 315, 360)
NOISE_LEVELS = tuple(range(2, 21, 2))
ELLIPSE_COUNTS = (4, 8, 12, 16, 20, 24)
HALF_SPANS = tuple(range(90, 181, 10))
OPEN_NOISE_LEVELS = (1, 5, 10, 15, 20, 25, 30)
SECTIONS = {
    "4.5.1": "digital elliptic arcs",
    "4.5.2": "noisy points all round an ellipse",
    "4.5.2 sector": "noisy points over 270 degrees of an ellipse",
    "4.5.3": "smooth edge curves of images of several ellipses",
    "4.5.4 analytic": "exact points of parabolae and hyperbolae",
    "4.5.4 digital": "digital parabolae and hyperbolae",
    "4.5.5": "noisy points of parabolae and hyperbolae",
    "noisy arcs": "noisy points over short sectors of an ellipse, not in the thesis",
}
"""Name and text of each experiment."""

NOISY_ARC_SPANS = (120, 150, 180, 225)
NOISY_ARC_LEVELS = (1, 2, 4, 8)

_LEAST_POINTS = 6
_SLOW = {"ahn": 10}
"""Methods that take one of so many trials of the open conics: there they take all their steps."""


@dataclass(frozen=True, slots=True)
class Setting:
    """One setting of an experiment.

    Attributes
    ----------
    section : str
        A name of `SECTIONS`.
    span : float
        Degrees of the curve; half of them on either side for the open conics.
    noise : float
        Per cent of the extent, kappa of the thesis.
    ellipses : int
        Ellipses in an image.
    """

    section: str
    span: float = 360.0
    noise: float = 0.0
    ellipses: int = 0

    @property
    def level(self) -> float:
        """What the experiment varies, its horizontal axis in a plot."""
        if self.section.startswith("4.5.2") or self.section in ("4.5.5", "noisy arcs"):
            return self.noise
        return self.ellipses if self.section == "4.5.3" else self.span

    @property
    def open(self) -> bool:
        """True where there is no ellipse to be found."""
        return self.section.startswith(("4.5.4", "4.5.5"))


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """Curves, each fitted for itself, and the ellipses that they come from."""

    curves: tuple[FloatArray, ...]
    truths: tuple[Ellipse, ...]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a method did in a setting: counts, means and deviations over its detections.

    Attributes
    ----------
    setting : Setting
    method : str
    trials, curves : int
    counts : DetectionCounts
    e13, e14, distance : float
        Means over the detections in pixels; NaN where there is none.
    e13_spread, e14_spread, distance_spread : float
        Standard deviations over the detections.
    """

    setting: Setting
    method: str
    trials: int
    curves: int
    counts: DetectionCounts
    e13: float
    e14: float
    distance: float
    e13_spread: float
    e14_spread: float
    distance_spread: float

    def cells(self) -> list[str | float]:
        """Return the outcome as it stands in a file."""
        setting = [getattr(self.setting, field.name) for field in fields(Setting)]
        counts = [getattr(self.counts, field.name) for field in fields(DetectionCounts)]
        measures = [self.counts.recall, self.counts.precision]
        measures += [self.e13, self.e14, self.distance]
        measures += [self.e13_spread, self.e14_spread, self.distance_spread]
        shown = ["" if math.isnan(value) else round(value, 6) for value in measures]
        return [*setting, self.method, self.trials, self.curves, *counts, *shown]


COLUMNS = (
    *(field.name for field in fields(Setting)), "method", "trials", "curves",
    *(field.name for field in fields(DetectionCounts)), "recall", "precision",
    "e13", "e14", "distance", "e13_spread", "e14_spread", "distance_spread",
)  # fmt: skip


def own_fits() -> dict[str, Fit]:
    """Return every method of the fitting table by name.

    Examples
    --------
    >>> "ellifit" in own_fits()
    True
    """
    return {row.name: row.function for row in TABLE}


def thesis_settings() -> list[Setting]:
    """Return the settings of thesis 4.5.1 - 4.5.5, and noisy short arcs.

    The noise of 4.5.5 is taken at seven of the thesis' thirty levels.

    Examples
    --------
    >>> settings = thesis_settings()
    >>> len(settings), settings[0].section
    (140, '4.5.1')
    """
    found = [Setting("4.5.1", span) for span in ARC_SPANS]
    found += [Setting("4.5.2", 360.0, noise) for noise in NOISE_LEVELS]
    found += [Setting("4.5.2 sector", 270.0, noise) for noise in NOISE_LEVELS]
    found += [Setting("4.5.3", ellipses=count) for count in ELLIPSE_COUNTS]
    for kind in ("analytic", "digital"):
        found += [Setting(f"4.5.4 {kind}", 2.0 * half) for half in HALF_SPANS]
    found += [
        Setting("4.5.5", 2.0 * half, noise) for noise in OPEN_NOISE_LEVELS for half in HALF_SPANS
    ]
    found += [
        Setting("noisy arcs", span, noise) for span in NOISY_ARC_SPANS for noise in NOISY_ARC_LEVELS
    ]
    return found


def make_trial(setting: Setting, seed: int, index: int) -> Trial:
    """Draw one trial of a setting; the same arguments give the same one.

    Examples
    --------
    >>> trial = make_trial(Setting("4.5.2", noise=10), 0, 0)
    >>> trial.curves[0].shape, len(trial.truths)
    ((36, 2), 1)
    """
    key = [seed, index, *setting.section.encode(), round(8 * setting.span), round(setting.noise)]
    random = np.random.default_rng(key)
    span = math.radians(setting.span)
    if setting.section == "4.5.3":
        return _image_trial(setting.ellipses, int(random.integers(2**31)))
    if setting.section == "4.5.5":
        return Trial((open_conic(random, span / 2, "noisy", setting.noise),), ())
    if setting.open:
        return Trial((open_conic(random, span / 2, setting.section.split()[1]),), ())
    if setting.section == "4.5.1":
        ellipse, points = elliptic_arc(random, span)
    else:
        ellipse, points = noisy_ellipse(random, setting.noise, span)
    return Trial((points,), (ellipse,))


def _image_trial(ellipses: int, seed: int) -> Trial:
    """Return the smooth edge curves (thesis 5.3.1, 5.3.2) of an image of occluded ellipses."""
    scene = thesis_image(ellipses, seed, kind="occluded")
    contours = extract_contours(scene.image)
    if len(contours) == 0:
        return Trial((), tuple(scene.ellipses))
    arcs = split_arcs(contours, approximate(contours))
    curves = tuple(arc.copy() for arc in arcs if len(arc) >= _LEAST_POINTS)
    return Trial(curves, tuple(scene.ellipses))


def measure_setting(
    setting: Setting, fits: Mapping[str, Fit], count: int, seed: int = 0
) -> list[Outcome]:
    """Run every method on `count` trials of a setting.

    An image of 4.5.3 stands for ten trials of the others, as in the thesis: 100 for 1,000. A
    slow method takes only a tenth of the open conics; its outcome tells the number.

    Examples
    --------
    >>> from geoprim_core.fitting import nsaf
    >>> (outcome,) = measure_setting(Setting("4.5.1"), {"nsaf": nsaf}, 3)
    >>> outcome.counts.recall, outcome.distance < 0.5
    (1.0, True)
    """
    trials = max(1, -(-count // 10)) if setting.section == "4.5.3" else count
    counts = dict.fromkeys(fits, DetectionCounts())
    errors: dict[str, list[tuple[float, float, float]]] = {name: [] for name in fits}
    used, curves = dict.fromkeys(fits, 0), dict.fromkeys(fits, 0)
    for index in range(trials):
        trial = make_trial(setting, seed, index)
        for name, fit in fits.items():
            if setting.open and index % _SLOW.get(name, 1):
                continue
            found, rows = _fitted(trial, fit)
            counts[name] += detection_counts(found, trial.truths)
            errors[name] += rows
            used[name] += 1
            curves[name] += len(trial.curves)
    return [
        _outcome(setting, name, used[name], curves[name], counts[name], errors[name])
        for name in fits
    ]


def _fitted(trial: Trial, fit: Fit) -> tuple[list[Ellipse], list[tuple[float, float, float]]]:
    """Return the detections of a trial and, where ellipses are true, E13, E14 and distance."""
    found, rows = [], []
    for curve in trial.curves:
        ellipse = fit(curve).ellipse
        if ellipse is None or not accepted(ellipse):
            continue
        found.append(ellipse)
        if trial.truths:
            errors = fit_errors(curve, ellipse)
            rows.append((errors.e13, errors.e14, errors.mean_distance))
    return found, rows


def _outcome(
    setting: Setting,
    name: str,
    trials: int,
    curves: int,
    counts: DetectionCounts,
    errors: Sequence[tuple[float, float, float]],
) -> Outcome:
    table: AnyArray = np.array(errors or [(np.nan,) * 3])
    means, spreads = table.mean(axis=0).tolist(), table.std(axis=0).tolist()
    return Outcome(setting, name, trials, curves, counts, *means, *spreads)


def run_experiments(
    settings: Sequence[Setting],
    fits: Mapping[str, Fit],
    count: int = 1000,
    seed: int = 0,
    processes: int = 1,
) -> Iterator[list[Outcome]]:
    """Yield the outcomes of each setting in turn, worked out in so many processes.

    The result does not depend on the number of processes. With more than one the fits have to be
    functions of a module.

    Examples
    --------
    >>> from geoprim_core.fitting import ellifit
    >>> runs = run_experiments([Setting("4.5.4 analytic")], {"ellifit": ellifit}, 5)
    >>> [outcome.counts.detected for outcomes in runs for outcome in outcomes]
    [0]
    """
    work = partial(measure_setting, fits=dict(fits), count=count, seed=seed)
    if processes <= 1:
        yield from map(work, settings)
        return
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        yield from pool.map(work, settings)
