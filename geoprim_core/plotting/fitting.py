"""Curves of the fitting experiments of thesis 4.5: a line a method."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from geoprim_core.evaluation.reproduce_fitting import SECTIONS, Outcome
from geoprim_core.evaluation.reproduce_fitting_outcomes import Outcomes, detected, precision, recall

_MARKS = "osD^v<>pXP*hd8"
_AXES = {"4.5.1": "span [deg]", "4.5.3": "ellipses in the image", "4.5.4": "span [deg]"}

Panel = tuple[str, Callable[[Outcome], float]]


def plot_experiment(outcomes: Outcomes, section: str, peers: Sequence[str] = ()) -> Any:
    """Draw the measures of one experiment against what it varies; peers are dashed.

    The errors are drawn as the thesis does, less those of ElliFit where that was run. Settings
    of one level are averaged.

    Parameters
    ----------
    outcomes : Outcomes
    section : str
        A name of `SECTIONS`.
    peers : names of the methods that are not ours

    Returns
    -------
    matplotlib Figure

    References
    ----------
    Thesis Figures 4.5-1 to 4.5-17.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    panels = _panels(outcomes, section)
    columns = min(3, len(panels))
    lines = -(-len(panels) // columns)
    figure = Figure(figsize=(4.6 * columns + 1.6, 3.5 * lines), layout="constrained")
    FigureCanvasAgg(figure)
    for k, panel in enumerate(panels):
        axes = figure.add_subplot(lines, columns, k + 1)
        _draw_panel(axes, outcomes, section, panel, peers)
    figure.suptitle(f"{section}: {SECTIONS[section]}", fontsize=10)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, fontsize=7, loc="outside right center")
    return figure


def _panels(outcomes: Outcomes, section: str) -> list[Panel]:
    if outcomes.of(section, outcomes.methods()[0])[0].setting.open:
        if section != "4.5.5":
            return [("share of false ellipses", detected)]
        return [
            ("false, all spans", detected),
            ("false, +-90 degrees", lambda o: detected(o) if o.setting.span == 180 else math.nan),
            ("false, +-180 degrees", lambda o: detected(o) if o.setting.span == 360 else math.nan),
        ]
    reference = {o.setting: o for o in outcomes.of(section, "ellifit")}

    def beyond(name: str) -> Callable[[Outcome], float]:
        def difference(outcome: Outcome) -> float:
            base = reference.get(outcome.setting)
            value = float(getattr(outcome, name))
            return value - float(getattr(base, name)) if base else value

        return difference

    errors = [(f"{label} - ElliFit's [px]", beyond(name)) for label, name in _ERRORS]
    counts: list[Panel] = [("detections a trial", detected), ("recall", recall)]
    return [*counts, ("precision", precision), *errors]


_ERRORS = (("E13", "e13"), ("E14", "e14"), ("d", "distance"))


def _draw_panel(
    axes: Any, outcomes: Outcomes, section: str, panel: Panel, peers: Sequence[str]
) -> None:
    from matplotlib import colormaps

    title, measure = panel
    tops: list[float] = []
    for k, method in enumerate(outcomes.methods()):
        rows = outcomes.of(section, method)
        levels = sorted({o.setting.level for o in rows})
        values = [_mean([measure(o) for o in rows if o.setting.level == x]) for x in levels]
        style: dict[str, Any] = (
            {"linestyle": "--"} if method in peers else {"marker": _MARKS[k % len(_MARKS)]}
        )
        style |= {"color": colormaps["tab20"](k % 20), "label": method}
        axes.plot(levels, values, markersize=3.5, linewidth=1.0, **style)
        tops += [v for v in values if not math.isnan(v)]
    if "ElliFit" in title and tops:  # one method that goes astray must not flatten the others
        low, high = np.percentile(tops, [2, 90])
        margin = 0.15 * (high - low) + 0.01
        axes.set_ylim(low - margin, high + margin)
    name = next((text for start, text in _AXES.items() if section.startswith(start)), "noise [%]")
    axes.set(xlabel=name, title=title)
    axes.title.set_fontsize(9)
    axes.grid(alpha=0.3)


def _mean(values: Sequence[float]) -> float:
    known = [value for value in values if not math.isnan(value)]
    return sum(known) / len(known) if known else math.nan
