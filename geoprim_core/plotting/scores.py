"""Bars of the F-measure."""

from __future__ import annotations

from typing import Any

import numpy as np

from geoprim_core._check import describe
from geoprim_core.errors import InputError
from geoprim_core.evaluation import Report, ReportRow
from geoprim_core.evaluation.score import measure_text
from geoprim_core.plotting._axes import axes_or_new


def plot_scores(report: Report, ax: Any | None = None) -> Any:
    """Draw the F-measure of every group as bars, one colour an overlap ratio.

    Groups that are judged by recall only show their recall and are marked so.

    Parameters
    ----------
    report : Report
    ax : matplotlib Axes or None
        None: a new figure without a window.

    Returns
    -------
    matplotlib Axes

    Raises
    ------
    InputError
        The report is of another type.

    Examples
    --------
    >>> from geoprim_core.evaluation import ImageScore, Score
    >>> report = Report((ImageScore("a", "cans", 0.8, Score(1, 1, 0)),))
    >>> axes = plot_scores(report)
    >>> round(float(axes.patches[0].get_width()), 3), axes.get_yticklabels()[0].get_text()
    (0.667, 'cans')
    """
    if not isinstance(report, Report):
        raise InputError("report", "a Report", describe(report))
    rows = report.rows
    names = list(dict.fromkeys(_name(row) for row in rows))
    overlaps = report.overlaps
    thickness = 0.8 / max(len(overlaps), 1)
    axes = axes_or_new(ax, 7.0, 1.0 + 0.45 * max(len(names), 1))
    for k, overlap in enumerate(overlaps):
        chosen = [row for row in rows if row.overlap == overlap]
        middle = (k - (len(overlaps) - 1) / 2) * thickness
        places = [names.index(_name(row)) + middle for row in chosen]
        merits = [row.score.merit for row in chosen]
        lengths = np.nan_to_num(merits)  # where it is undefined a dash stands at the beginning
        bars = axes.barh(places, lengths, thickness, label=f"overlap {overlap:g}")
        axes.bar_label(bars, [measure_text(m) for m in merits], padding=2, fontsize=7)
    axes.set_yticks(range(len(names)), names)
    axes.set(xlim=(0, 1.1), xlabel="F-measure of the pooled counts")
    axes.invert_yaxis()
    if overlaps:
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=len(overlaps), frameon=False)
    return axes


def _name(row: ReportRow) -> str:
    name = row.group or "images"
    return f"{name} (recall)" if row.score.false is None else name
