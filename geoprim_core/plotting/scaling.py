"""Times against sizes on logarithmic axes."""

from __future__ import annotations

from typing import Any

import numpy as np

from geoprim_core.evaluation.scaling import Growth, fitted_exponent
from geoprim_core.evaluation.speed import STAGES
from geoprim_core.plotting._axes import axes_or_new


def plot_growth(growth: Growth, ax: Any | None = None, *, by_edge_pixels: bool = False) -> Any:
    """Draw the time of each stage and of the whole chain with the exponents that fit them.

    Parameters
    ----------
    growth : Growth
    ax : matplotlib Axes or None
        None: a new figure without a window.
    by_edge_pixels : bool
        Against the number of contour points instead of the size.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> sizes = np.array([10.0, 100.0])
    >>> growth = Growth("a", "arcs", sizes, sizes, sizes, np.array([[1.0, 1, 1], [10, 10, 100]]))
    >>> [text.get_text() for text in plot_growth(growth).get_legend().get_texts()][2]
    'ecc: exponent 2.00'
    """
    axes = axes_or_new(ax, 5.5, 4.2)
    size = growth.edge_pixels if by_edge_pixels else growth.size
    what = "edge pixels" if by_edge_pixels else growth.size_name
    for k, stage in enumerate((*STAGES, "all")):
        milliseconds = growth.columns[:, k] * 1e3
        if not np.isfinite(milliseconds).any():
            continue
        exponent = fitted_exponent(size, milliseconds)
        style = {"color": "black", "linewidth": 2} if stage == "all" else {}
        axes.plot(
            size, milliseconds, marker="o", label=f"{stage}: exponent {exponent:.2f}", **style
        )
    axes.set(xscale="log", yscale="log", xlabel=what, ylabel="ms")
    axes.set_title(growth.name, fontsize=9)
    axes.grid(alpha=0.3, which="both")
    axes.legend(fontsize=7)
    return axes
