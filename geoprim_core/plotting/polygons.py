"""Curves with their polygons, panel by panel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from geoprim_core._check import FloatArray, IntArray


def plot_polygons(
    panels: Sequence[tuple[str, FloatArray, IntArray]], *, closed: bool = True, columns: int = 4
) -> Any:
    """Draw panels of a curve (grey) and the polygon of its vertices (red).

    Parameters
    ----------
    panels : sequence of (title, points (n, 2), indices (m,))
    closed : bool
    columns : int
        Panels a line.

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> line = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    >>> len(plot_polygons([("line", line, np.array([0, 2]))], closed=False).axes)
    1
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    lines = -(-len(panels) // columns)
    figure = Figure(figsize=(2.6 * min(columns, len(panels)), 2.6 * lines), layout="constrained")
    FigureCanvasAgg(figure)
    for k, (title, points, indices) in enumerate(panels):
        axes = figure.add_subplot(lines, min(columns, len(panels)), k + 1)
        around = np.append(indices, indices[:1]) if closed else indices
        axes.plot(*points.T, ".", color="0.6", markersize=1.5)
        axes.plot(*points[around].T, "-o", color="tab:red", linewidth=0.9, markersize=2.0)
        axes.set(aspect="equal")
        axes.invert_yaxis()
        axes.set_axis_off()
        axes.set_title(title, fontsize=7)
    return figure
