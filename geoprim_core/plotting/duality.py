"""The lines of thesis 2.2.2: short curves with their best lines, and metrics against length."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core.evaluation.duality import fit_line
from geoprim_core.plotting._axes import axes_or_new


def plot_lines(curves: Mapping[str, FloatArray], *, columns: int = 3) -> Any:
    """Draw short curves and the line of least squared distances through each.

    Parameters
    ----------
    curves : name -> points (n, 2)
    columns : int
        Panels a line.

    Returns
    -------
    matplotlib Figure

    References
    ----------
    Thesis Figures 2.2-1 and 2.2-2.

    Examples
    --------
    >>> len(plot_lines({"bend": np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]])}).axes)
    1
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    lines = -(-len(curves) // columns)
    figure = Figure(figsize=(3.2 * columns, 1.9 * lines), layout="constrained")
    FigureCanvasAgg(figure)
    for k, (name, points) in enumerate(curves.items()):
        axes = figure.add_subplot(lines, columns, k + 1)
        middle = points.mean(axis=0)
        along = np.linalg.svd(points - middle, full_matrices=False)[2][0]
        ends = middle + np.outer(((points[[0, -1]] - middle) @ along), along)
        axes.plot(*points.T, "s", color="0.6", markersize=2.0)
        axes.plot(*ends.T, color="tab:red", linewidth=1.0)
        fit = fit_line(points)
        title = f"{name}\nprecision {fit.precision:.2f} px, reliability {fit.reliability:.2f}"
        axes.set_title(title, fontsize=7)
        axes.set(aspect="equal", adjustable="datalim")
        axes.set_axis_off()
    return figure


def plot_metrics_by_length(
    curves: Mapping[str, FloatArray], ax: Any | None = None, name: str = "precision"
) -> Any:
    """Draw a metric of the best line over the first m pixels of each curve against m.

    Parameters
    ----------
    curves : name -> points (n, 2)
    ax : matplotlib Axes or None
        None: a new figure without a window.
    name : {"precision", "reliability", "share"}
        An attribute of `LineFit`.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> bend = np.array([[x, abs(x - 3.0)] for x in range(9)])
    >>> [line.get_label() for line in plot_metrics_by_length({"bend": bend}).lines]
    ['bend']
    """
    axes = axes_or_new(ax, 5.5, 4.0)
    for curve, points in curves.items():
        lengths = np.arange(4, len(points) + 1)
        axes.plot(lengths, [getattr(fit_line(points[:m]), name) for m in lengths], label=curve)
    axes.set(xlabel="pixels of the piece", ylabel=name + (" [px]" if name == "precision" else ""))
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    return axes
