"""Curves of a comparison of detectors: against alpha, precision-recall, time against accuracy."""

from __future__ import annotations

from typing import Any

import numpy as np

from geoprim_core.errors import InputError
from geoprim_core.evaluation.comparison import Comparison
from geoprim_core.evaluation.comparison_tables import (
    alpha_curve,
    comparison_rows,
    precision_recall,
)
from geoprim_core.plotting._axes import axes_or_new

_MEASURES = ("precision", "recall", "F-measure")
_MARKS = "osD^v<>pXP*h"


def plot_alpha(
    comparison: Comparison,
    set_name: str,
    overlap: float,
    measure: str = "F-measure",
    ax: Any | None = None,
) -> Any:
    """Draw a mean measure of a set against the number of ellipses in an image, by detector.

    Parameters
    ----------
    comparison : Comparison
    set_name : str
    overlap : float
    measure : "precision", "recall" or "F-measure"
    ax : matplotlib Axes or None
        None: a new figure without a window.

    Returns
    -------
    matplotlib Axes

    Raises
    ------
    InputError
        An unknown measure, or the set was not judged at that overlap.

    References
    ----------
    Thesis Figures 5.6-3 to 5.6-8.
    """
    if measure not in _MEASURES:
        raise InputError("measure", "one of " + ", ".join(_MEASURES), repr(measure))
    axes = axes_or_new(ax, 5.0, 4.0)
    for k, detector in enumerate(comparison.detectors):
        own = [m for m in comparison.of(detector) if m.truth.group == set_name]
        alphas, curve = alpha_curve(own, overlap)
        values = curve[:, _MEASURES.index(measure)]
        axes.plot(alphas, values, marker=_MARKS[k % len(_MARKS)], label=detector)
        axes.set_xticks(alphas)
    axes.set(xlabel="ellipses in the image (alpha)", ylabel=measure, ylim=(0, 1.02))
    axes.set_title(f"{set_name}, overlap {overlap:g}", fontsize=9)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7)
    return axes


def plot_precision_recall(
    comparison: Comparison, set_name: str, overlap: float, ax: Any | None = None
) -> Any:
    """Draw precision against recall of a set, by detector; one without scores is a point.

    Images that are judged by recall only are left out.

    Raises
    ------
    InputError
        The set was not judged at that overlap.
    """
    axes = axes_or_new(ax, 5.0, 4.5)
    for k, detector in enumerate(comparison.detectors):
        own = [
            m
            for m in comparison.of(detector)
            if m.truth.group == set_name and not m.truth.recall_only
        ]
        recall, precision = precision_recall(own, overlap)
        mark = _MARKS[k % len(_MARKS)]
        line = axes.plot(recall, precision, label=detector, linewidth=1.2)[0]
        axes.plot(recall[-1:], precision[-1:], mark, color=line.get_color())
    axes.set(xlabel="recall", ylabel="precision", xlim=(0, 1.02), ylim=(0, 1.02))
    axes.set_title(f"{set_name or 'images'}, overlap {overlap:g}", fontsize=9)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7, loc="lower left")
    return axes


def plot_time_accuracy(comparison: Comparison, ax: Any | None = None) -> Any:
    """Draw mean F against the median time of an image: a colour a detector, a mark a set.

    Each set is shown at its highest overlap; recall stands for F where only that is known. Sets
    with nothing to be found have no F and are left out.
    """
    rows = [row for row in comparison_rows(comparison) if row.score.actual]
    highest = {
        row.set_name: max(r.overlap for r in rows if r.set_name == row.set_name) for row in rows
    }
    shown = [row for row in rows if row.overlap == highest[row.set_name]]
    sets = list(dict.fromkeys((row.set_name, row.recall_only) for row in shown))
    axes = axes_or_new(ax, 7.5, 5.0)
    for row in shown:
        k = sets.index((row.set_name, row.recall_only))
        color = f"C{comparison.detectors.index(row.detector) % 10}"
        value = row.means[1] if row.recall_only else row.means[2]
        axes.plot(row.median_ms, value, _MARKS[k % len(_MARKS)], color=color, markersize=7)
    _two_legends(axes, comparison.detectors, [_set_label(*s, highest[s[0]]) for s in sets])
    axes.set(xscale="log", xlabel="median ms an image", ylabel="mean F-measure", ylim=(0, 1.02))
    _round_ticks(axes)
    axes.grid(alpha=0.3, which="both")
    return axes


def _round_ticks(axes: Any) -> None:
    """Write 1, 2, 5, 10, ... at a logarithmic x axis."""
    low, high = axes.get_xlim()
    steps = [k * 10.0**power for power in range(-3, 7) for k in (1, 2, 5)]
    shown = [step for step in steps if low <= step <= high]
    axes.set_xticks(shown, [f"{step:g}" for step in shown])
    axes.set_xticks([], minor=True)


def _set_label(name: str, recall_only: bool, overlap: float) -> str:
    return f"{name} {overlap:g}" + (" (recall)" if recall_only else "")


def _two_legends(axes: Any, detectors: tuple[str, ...], sets: list[str]) -> None:
    """Explain colours and marks to the right of the axes."""
    for k, detector in enumerate(detectors):
        axes.plot([], [], "-", color=f"C{k % 10}", linewidth=4, label=detector)
    for k, name in enumerate(sets):
        axes.plot([], [], _MARKS[k % len(_MARKS)], color="gray", label=name)
    axes.legend(fontsize=7, loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False)


def set_overlaps(comparison: Comparison) -> list[tuple[str, float]]:
    """Return every set with every overlap that it was judged at, in the order of the run."""
    pairs = ((score.group, score.overlap) for m in comparison.measurements for score in m.scores)
    return list(dict.fromkeys(pairs))


def has_alpha(comparison: Comparison, set_name: str) -> bool:
    """Say whether a set has images of several numbers of ellipses."""
    alphas = {m.alpha for m in comparison.measurements if m.truth.group == set_name}
    return len(alphas - {None}) > 1


def draw_alpha_panels(comparison: Comparison, set_name: str, overlap: float) -> Any:
    """Return a figure with precision, recall and F against alpha side by side."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.0, 3.8), layout="constrained")
    FigureCanvasAgg(figure)
    for measure, axes in zip(_MEASURES, np.ravel(figure.subplots(1, 3)), strict=True):
        plot_alpha(comparison, set_name, overlap, measure, axes)
    return figure
