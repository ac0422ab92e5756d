"""The digitisation bounds against length and slope: thesis Figures 2.4-1(b) and 2.4-3."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from geoprim_core.plotting._axes import axes_or_new
from geoprim_core.polygon import deviation_bound


def plot_bounds_by_slope(
    rules: Sequence[str] = ("thesis", "exact", "dss4", "dss8"),
    length: float = 10.0,
    ax: Any | None = None,
) -> Any:
    """Draw bounds of the deviation against the slope of segments of one length.

    Parameters
    ----------
    rules : names of bound rules
    length : float
        Of the segments, in pixels; d_DSS does not depend on it.
    ax : matplotlib Axes or None
        None: a new figure without a window.

    Returns
    -------
    matplotlib Axes

    References
    ----------
    Thesis Figures 2.4-1(b), 2.4-3 (left).

    Examples
    --------
    >>> [line.get_label() for line in plot_bounds_by_slope(("dss4",)).lines]
    ['dss4']
    """
    axes = axes_or_new(ax, 5.5, 4.0)
    degrees = np.linspace(0.0, 90.0, 181)
    ends = length * np.stack([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))], axis=1)
    for rule in rules:
        axes.plot(degrees, [deviation_bound((0, 0), end, rule) for end in ends], label=rule)
    axes.set(xlabel="slope [deg]", ylabel=f"bound [px], length {length:g} px")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    return axes


def plot_bounds_by_length(
    rules: Sequence[str] = ("thesis", "exact", "released", "tan"),
    slope: float = np.pi / 8,
    ax: Any | None = None,
) -> Any:
    """Draw bounds of the deviation against the length of segments of one slope.

    Parameters
    ----------
    rules : names of bound rules
    slope : float
        Angle of the segments in radians; d_tan and `released` do not depend on it.
    ax : matplotlib Axes or None
        None: a new figure without a window.

    Returns
    -------
    matplotlib Axes

    References
    ----------
    Thesis Figures 2.4-1(b), 2.4-3 (right), (2-50)-(2-52).

    Examples
    --------
    >>> [line.get_label() for line in plot_bounds_by_length(("tan",)).lines]
    ['tan', 'limit of all, over all slopes']
    """
    axes = axes_or_new(ax, 5.5, 4.0)
    lengths = np.geomspace(2.0, 100.0, 200)
    along = np.array([np.cos(slope), np.sin(slope)])
    for rule in rules:
        axes.plot(lengths, [deviation_bound((0, 0), s * along, rule) for s in lengths], label=rule)
    limit = "limit of all, over all slopes"
    axes.axhline(np.sqrt(2.0), color="gray", linestyle=":", label=limit)
    axes.set(xscale="log", xlabel="length [px]", ylabel="bound [px]")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    return axes
