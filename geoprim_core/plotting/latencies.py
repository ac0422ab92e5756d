"""Latencies as curves: which share of the answers came within a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from geoprim_core.plotting._axes import axes_or_new


def plot_latencies(
    latencies_ms: Mapping[str, Sequence[float]],
    ax: Any | None = None,
    *,
    sent: Mapping[str, int] | None = None,
    title: str = "",
) -> Any:
    """Draw the empirical distribution of each group of latencies on a logarithmic time axis.

    Parameters
    ----------
    latencies_ms : mapping of name to times in milliseconds
        A group without times is left out. Names with one beginning up to a comma share a colour,
        and the second of them is dashed.
    ax : matplotlib Axes or None
        None: a new figure without a window.
    sent : mapping of name to a number, optional
        What was asked, so that a curve ends below 1 where answers are missing.
    title : str

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> axes = plot_latencies({"a": [3.0, 1.0, 2.0], "b": []})
    >>> [text.get_text() for text in axes.get_legend().get_texts()]
    ['a: p50 2, p95 2.9']
    """
    axes = axes_or_new(ax, 5.5, 4.0)
    counts = {name: len(values) for name, values in latencies_ms.items()} | dict(sent or {})
    colours = list(dict.fromkeys(name.partition(",")[0] for name in latencies_ms))
    drawn = set[str]()
    for name, values in latencies_ms.items():
        if not len(values):
            continue
        p50, p95 = np.percentile(values, [50, 95])
        head = name.partition(",")[0]
        axes.step(
            np.sort(values), np.arange(1, len(values) + 1) / counts[name], where="post",
            color=f"C{colours.index(head)}", linestyle="--" if head in drawn else "-",
            label=f"{name}: p50 {p50:.3g}, p95 {p95:.3g}",
        )  # fmt: skip
        drawn.add(head)
    axes.set(xscale="log", xlabel="ms", ylabel="share that is answered", ylim=(0, 1.01))
    axes.set_title(title, fontsize=9)
    axes.grid(alpha=0.3, which="both")
    if drawn:
        axes.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.14))
    return axes
