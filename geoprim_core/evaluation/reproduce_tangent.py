"""The comparisons of thesis 3.6 as tasks: every tangent estimator, every family of curves."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from geoprim_core.evaluation.tangent_errors import (
    RADIUS,
    Entrant,
    Row,
    control_of,
    family_curves,
    measure,
    with_control,
)
from geoprim_core.tangent import TABLE

ECCENTRICITIES = tuple(round(0.01 * g, 2) for g in range(100))
LOBES = (1, 2, 3, 4, 5, 6, 7)
SETTINGS: dict[str, tuple[float, ...]] = {
    "circle": (0.0,),
    "ellipse": ECCENTRICITIES,
    "flower": LOBES,
}
"""Family -> its settings: nothing, eccentricity e, number of lobes n."""

CONTROL_VALUES = (2, 3, 4, 5, 6, 8, 10, 12, 14, 16, 18, 20, 22, 25, 30)
SIZES = (25, 50, 100, 200, 400, 800)
_SHAPES = ("circle", "ellipse", "flower")
_TUNING = 1  # added to the seed for the curves that control values are chosen on


@dataclass(frozen=True, slots=True)
class Task:
    """What one worker measures: entrants on the curves of one setting."""

    family: str
    setting: float
    entrants: tuple[Entrant, ...]
    count: int
    seed: int
    size: float = RADIUS
    name: str = ""

    def rows(self) -> list[Row]:
        """Return one row an entrant."""
        curves = family_curves(self.family, self.setting, self.count, self.seed, self.size)
        on_grid = self.name.startswith("grid")
        setting = self.size if on_grid else self.setting
        return measure(self.name or self.family, setting, self.entrants, curves)


def sweep_tasks(count: int, seed: int, methods: Sequence[str] = TABLE.names) -> Iterator[Task]:
    """Yield the tasks of Figure 3.6-1(c), for each family: every R and Q, on curves of their own.

    Examples
    --------
    >>> {task.name for task in sweep_tasks(1, 0)} == {f"sweep {family}" for family in SETTINGS}
    True
    """
    tuned = [method for method in methods if control_of(method)]
    entrants = tuple(with_control(m, value) for m in tuned for value in CONTROL_VALUES)
    chosen = {"ellipse": (0.0, 0.2, 0.4, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99)}
    for family, settings in SETTINGS.items():
        few = max(count // len(chosen.get(family, settings)), 1)
        for setting in chosen.get(family, settings):
            yield Task(family, setting, entrants, few, seed + _TUNING, name=f"sweep {family}")


def best_controls(rows: Iterable[Row]) -> dict[tuple[str, str], float]:
    """Return (family, method) -> the control value of the least mean error in the sweeps.

    Examples
    --------
    >>> few = [Row("sweep circle", 0.0, f"deb({r})", 3.0 - r, 9.0, 9.0, 1.0) for r in (1, 2)]
    >>> best_controls(few)
    {('circle', 'deb'): 2.0}
    """
    means: dict[tuple[str, str, float], list[float]] = {}
    for row in rows:
        method, text = row.label.rstrip(")").split("(")
        key = (row.family.removeprefix("sweep "), method, float(text))
        means.setdefault(key, []).append(row.mean / row.defined if row.defined else np.inf)
    best: dict[tuple[str, str], tuple[float, float]] = {}
    for (family, method, value), found in means.items():
        candidate = (float(np.mean(found)), value)
        best[family, method] = min(best.get((family, method), (np.inf, 0.0)), candidate)
    return {key: value for key, (_, value) in best.items()}


def entrants_of(
    family: str, controls: Mapping[tuple[str, str], float], methods: Sequence[str] = TABLE.names
) -> tuple[Entrant, ...]:
    """Return every method once, at its best control value, then DEB's other choices.

    Examples
    --------
    >>> [entrant.label for entrant in entrants_of("circle", {("circle", "deb"): 20.0})][:2]
    ['deb(20)', 'deb(10)']
    """
    found = []
    for method in methods:
        value = controls.get((family, method))
        found.append(Entrant(method, method) if value is None else with_control(method, value))
        if method == "deb":
            found += _deb_choices(None if value is None else round(value))
    return tuple(found)


def _deb_choices(best: int | None) -> list[Entrant]:
    """Return DEB with the thesis' R and, where this version has it, with an automatic one."""
    found = [] if best == 10 else [with_control("deb", 10)]
    options = {option.name: option.choices for option in TABLE["deb"].params.options()}
    if "auto" in options.get("radius_rule", ()):
        found.append(Entrant("deb(auto)", "deb", (("radius_rule", "auto"),)))
    return found


def family_tasks(
    controls: Mapping[tuple[str, str], float],
    count: int,
    seed: int,
    methods: Sequence[str] = TABLE.names,
) -> Iterator[Task]:
    """Yield the tasks of 3.6.3 to 3.6.5: all entrants on every setting of every family.

    Examples
    --------
    >>> len(list(family_tasks({}, 1, 0)))
    108
    """
    for family, settings in SETTINGS.items():
        entrants = entrants_of(family, controls, methods)
        for setting in settings:
            yield Task(family, setting, entrants, count, seed)


def grid_tasks(
    count: int, seed: int, sizes: Sequence[int] = SIZES, methods: Sequence[str] = TABLE.names
) -> Iterator[Task]:
    """Yield the tasks on finer and finer grids: shapes of growing size in pixels.

    Rows keep their default control values. DEB also follows three rules in the radius rho of the
    shape's smallest circle of curvature: R = 10, rho / 2 as in (3-32), and 2 rho^(2/3), which
    keeps the analytic error and that of the digitisation of one order.

    Examples
    --------
    >>> {task.name for task in grid_tasks(1, 0, [25])} == {f"grid {shape}" for shape in _SHAPES}
    True
    """
    settings = {"circle": 0.0, "ellipse": 0.8, "flower": 3.0}
    shares = {"circle": 1.0, "ellipse": 0.36, "flower": 1.0 / 24.0}  # of the smallest circle
    for family, setting in settings.items():
        for size in sizes:
            rho = shares[family] * size
            entrants = (*_at_defaults(methods), *_scaled_deb(rho))
            few = max(1, min(count, count * 200 // size))
            yield Task(family, setting, entrants, few, seed, float(size), f"grid {family}")


def _at_defaults(methods: Sequence[str]) -> list[Entrant]:
    return [Entrant(method, method) for method in methods if method != "deb"]


def _scaled_deb(rho: float) -> list[Entrant]:
    rules = {
        "deb(R = 10)": 10.0,
        "deb(R = rho/2)": rho / 2,
        "deb(R = 2 rho^2/3)": 2 * rho ** (2 / 3),
    }
    found = [Entrant(label, "deb", (("radius", max(r, 1.5)),)) for label, r in rules.items()]
    return found + [entrant for entrant in _deb_choices(10) if entrant.label == "deb(auto)"]
