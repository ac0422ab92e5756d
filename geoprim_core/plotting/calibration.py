"""Reliability diagrams of scores, and how often covariances hold."""

from __future__ import annotations

from typing import Any

import numpy as np

from geoprim_core._check import describe
from geoprim_core.errors import InputError
from geoprim_core.evaluation import Coverage, Reliability
from geoprim_core.evaluation.coverage import LEVELS, REGIMES
from geoprim_core.plotting._axes import axes_or_new

_LEAST_COUNT = 30
_TOLERANCES = (0.05, 0.03)


def plot_reliability(reliability: Reliability, ax: Any | None = None) -> Any:
    """Draw the share of right detections against their score, with their number in each bin.

    Parameters
    ----------
    reliability : Reliability
    ax : matplotlib Axes or None
        None: a new figure without a window.

    Returns
    -------
    matplotlib Axes

    Raises
    ------
    InputError
        The reliability is of another type.

    Examples
    --------
    >>> from geoprim_core.evaluation import ScoredDetections, measure_reliability
    >>> samples = ScoredDetections([0.75, 0.75], [True, False], ("a", "a"), ("", ""))
    >>> axes = plot_reliability(measure_reliability(samples))
    >>> [float(bar.get_height()) for bar in axes.patches]
    [0.5]
    """
    if not isinstance(reliability, Reliability):
        raise InputError("reliability", "a Reliability", describe(reliability))
    axes = axes_or_new(ax, 5.0, 5.0)
    used = np.flatnonzero(reliability.count)
    left, width = reliability.edges[used], np.diff(reliability.edges)[used]
    right, count = reliability.right[used], reliability.count[used]
    axes.bar(left, right, width, align="edge", color="#9ecae1", edgecolor="white")
    axes.plot(reliability.score[used], right, "o-", color="#08519c", label="detections")
    axes.plot([0, 1], [0, 1], ":", color="black", label="a perfect score")
    for x, number in zip(left + 0.5 * width, count, strict=True):
        axes.annotate(f"{number}", (x, 0.01), ha="center", fontsize=7)
    title = f"calibration error {reliability.error:.3f}, Brier score {reliability.brier:.3f}"
    axes.set(xlim=(0, 1), ylim=(0, 1.02), xlabel="score", ylabel="share right", title=title)
    axes.legend(loc="upper left", frameon=False)
    return axes


def plot_coverage(coverage: Coverage, ax: Any | None = None) -> Any:
    """Draw how often joint regions hold the truth against how often they should.

    One line for every regime of `Coverage.rows` with 30 ellipses or more, that of all pictures
    thick; bars mark 68 +- 5 % and 95 +- 3 %.

    Parameters
    ----------
    coverage : Coverage
    ax : matplotlib Axes or None
        None: a new figure without a window.

    Returns
    -------
    matplotlib Axes

    Raises
    ------
    InputError
        The coverage is of another type.

    Examples
    --------
    >>> from geoprim_core.evaluation import measure_coverage
    >>> axes = plot_coverage(measure_coverage(6, seed=1))
    >>> axes.get_xlabel()
    'probability of the region'
    """
    if not isinstance(coverage, Coverage):
        raise InputError("coverage", "a Coverage", describe(coverage))
    axes = axes_or_new(ax, 6.0, 6.0)
    levels = np.linspace(0.01, 0.99, 99)
    for k, name in enumerate(REGIMES):
        chosen = coverage.regimes[:, k]
        if chosen.sum() < (1 if name == "all" else _LEAST_COUNT):
            continue
        shares = [coverage.joint_share(level, chosen) for level in levels]
        style = {"color": "black", "lw": 2.5} if name == "all" else {"lw": 0.8}
        axes.plot(levels, shares, label=name, zorder=3 if name == "all" else 2, **style)
    axes.plot([0, 1], [0, 1], ":", color="black")
    axes.errorbar(LEVELS, LEVELS, yerr=_TOLERANCES, fmt="none", color="red", capsize=4, zorder=4)
    axes.set(xlim=(0, 1), ylim=(0, 1), xlabel="probability of the region")
    axes.set_ylabel("share of truths inside")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=6, loc="lower right", frameon=False)
    return axes
