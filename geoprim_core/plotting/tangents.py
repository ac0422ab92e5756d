"""Plots of the rerun of thesis chapter 3: sensitivity, bounds, sweeps, rankings, convergence."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from geoprim_core.evaluation.reproduce_tangent import CONTROL_VALUES, SETTINGS
from geoprim_core.evaluation.reproduce_tangent_bounds import TURNS
from geoprim_core.evaluation.reproduce_tangent_claims import THESIS, orders
from geoprim_core.evaluation.reproduce_tangent_report import ranking
from geoprim_core.evaluation.reproduce_tangent_run import Results
from geoprim_core.evaluation.tangent_errors import Row

_LINES = 7  # rivals shown beside DEB and the methods of maximal segments


def _figure(width: float, height: float) -> Any:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def tangent_figures(results: Results) -> dict[str, Callable[[], Any]]:
    """Return file stem -> function that draws a figure of a run.

    Examples
    --------
    >>> sorted(tangent_figures(Results([], [], [], [], {}, [], [], {})))[:3]
    ['bounds', 'convergence', 'ellipses']
    """
    return {
        "sensitivity": lambda: plot_sensitivity(results),
        "bounds": lambda: plot_bounds(results),
        "sweep": lambda: plot_sweep(results),
        "ranking": lambda: plot_ranking(results),
        "ellipses": lambda: plot_settings(results, "ellipse", "eccentricity"),
        "flowers": lambda: plot_settings(results, "flower", "lobes n"),
        "convergence": lambda: plot_convergence(results),
        "isotropy": lambda: plot_isotropy(results),
    }


def representatives(rows: Iterable[Row], family: str) -> list[str]:
    """Return labels: DEB and maximal segments, then the best variant of the best other methods.

    Examples
    --------
    >>> rows = [Row("circle", 0, n, m, 9, 9, 1.0) for n, m in (("lr1", 2), ("lr1_h3", 1))]
    >>> representatives(rows, "circle")
    ['lr1_h3']
    """
    ranked = [row.label for row in ranking(rows, family)]
    always = [n for n in ranked if n.startswith(("deb", "lambda"))]
    best: dict[str, str] = {}
    for label in ranked:
        if label not in always:
            best.setdefault(label.split("(")[0].split("_h")[0], label)
    return always + list(best.values())[:_LINES]


_COLOURS = ("C0", "C1", "C2", "C3", "C4", "C5", "C6", "C8", "C9", "navy", "tan")
_DEB = {THESIS: "-", "deb": "-", "deb(auto)": ":", "deb(R = rho/2)": "--", "deb(R = 10)": "-."}


def _styles(labels: Iterable[str]) -> dict[str, dict[str, Any]]:
    """Return black lines for DEB, grey ones for maximal segments, colours for the others."""
    colours = iter(_COLOURS)
    found: dict[str, dict[str, Any]] = {}
    for label in labels:
        if label.startswith("deb"):
            line = _DEB.get(label, "-" if "2/3" in label else "--")
            found[label] = {"color": "black", "linestyle": line}
        elif label.startswith("lambda"):
            found[label] = {"color": "0.55", "linestyle": "--" if label == "lambda_msg" else "-"}
        else:
            found[label] = {"color": next(colours, "0.8")}
        found[label]["linewidth"] = 2.2 if label == THESIS else 1.3
    return found


def _plain_numbers(axis: Any, subs: tuple[int, ...] = (1, 2, 5)) -> None:
    """Write numbers without powers at these multiples of the powers of a logarithmic axis."""
    from matplotlib.ticker import LogLocator

    axis.set_major_locator(LogLocator(subs=subs))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter("")


def plot_sensitivity(results: Results) -> Any:
    """Draw the error of Yuen's centre against turns, and against size where digitised.

    Examples
    --------
    >>> len(plot_sensitivity(Results([], [], [], [], {}, [], [], {})).axes)
    2
    """
    figure = _figure(9.0, 3.6)
    left, right = figure.subplots(1, 2)
    for each in results.sensitivity:
        if not each.digitised:
            left.plot(np.degrees(TURNS), each.errors, label=f"test {each.test}")
    for test in (1, 2):
        found = [e for e in results.sensitivity if e.digitised and e.test == test]
        sizes = [e.semi_major for e in found]
        right.plot(sizes, [e.mean for e in found], f"C{test - 1}", label=f"test {test}, mean")
        right.plot(sizes, [e.maximum for e in found], f"C{test - 1}:", label=f"test {test}, max")
    left.set(xlabel="turn of the tangents in degrees", ylabel="error / a", title="exact points")
    right.set(xlabel="semi-major axis a in px", title="rounded points", ylim=(0, None))
    for axes in (left, right):
        axes.grid(alpha=0.3)
        if results.sensitivity:
            axes.legend(fontsize=8)
    return figure


def plot_bounds(results: Results, radius: float = 10.0) -> Any:
    """Draw the largest errors and bounds of DEB for each family of conics (Figure 3.5-2).

    Examples
    --------
    >>> len(plot_bounds(Results([], [], [], [], {}, [], [], {})).axes)
    3
    """
    figure = _figure(12.0, 4.0)
    names = {"conics": "eccentricity e", "parabolae": "a in px", "circles": "rho in px"}
    lines = {
        "total_limit": ("total bound", "black", "-"),
        "digital_limit": ("digital bound", "tab:blue", "--"),
        "total": ("total error", "tab:red", "-"),
        "analytic_limit": ("analytic bound", "tab:green", "-"),
        "analytic": ("analytic error", "tab:olive", "--"),
        "printed": ("(3-27) as printed", "tab:purple", ":"),
    }
    for axes, (family, name) in zip(figure.subplots(1, 3, sharey=True), names.items(), strict=True):
        rows = [r for r in results.bounds if r.family == family and r.radius == radius]
        for field, (label, colour, line) in lines.items():
            values = np.array([getattr(row, field) for row in rows])
            shown = np.where(values > 1e-7, values, np.nan)
            axes.plot([r.value for r in rows], shown, color=colour, linestyle=line, label=label)
        axes.set(xscale="log", yscale="log", xlabel=name, title=f"{family}, R = {radius:g}")
        axes.set_ylim(1e-6, 20.0)
        _plain_numbers(axes.xaxis, (1, 2, 5) if family == "parabolae" else (1,))
        axes.grid(alpha=0.3)
    figure.axes[0].set_ylabel("degrees")
    figure.axes[0].legend(fontsize=8)
    return figure


def plot_sweep(results: Results) -> Any:
    """Draw the mean error against R or Q for each family (Figure 3.6-1(c)).

    Examples
    --------
    >>> len(plot_sweep(Results([], [], [], [], {}, [], [], {})).axes)
    3
    """
    figure = _figure(12.0, 4.2)
    for axes, family in zip(figure.subplots(1, 3), SETTINGS, strict=True):
        means: dict[str, list[float]] = {}
        for row in results.sweep:
            if row.family == f"sweep {family}":
                means.setdefault(row.label, []).append(row.mean)
        methods = dict.fromkeys(label.split("(")[0] for label in means)
        for method, style in _styles(methods).items():
            known = [v for v in CONTROL_VALUES if f"{method}({v})" in means]
            values = [np.mean(means[f"{method}({v})"]) for v in known]
            axes.plot(known, values, label=method, **style)
        axes.set(xlabel="R or Q in px", title=family, yscale="log")
        _plain_numbers(axes.yaxis)
        axes.grid(alpha=0.3, which="both")
    figure.axes[0].set_ylabel("mean error in degrees")
    if results.sweep:
        figure.axes[0].legend(fontsize=7, ncols=2)
    return figure


def plot_ranking(results: Results) -> Any:
    """Draw mean and maximum error of every entrant, the best on top, for each family.

    Examples
    --------
    >>> len(plot_ranking(Results([], [], [], [], {}, [], [], {})).axes)
    3
    """
    figure = _figure(13.0, 11.5)
    for axes, family in zip(figure.subplots(1, 3), SETTINGS, strict=True):
        rows = ranking(results.rows, family)
        height = np.arange(len(rows))
        axes.plot([row.mean for row in rows], height, "o", markersize=3.5, label="mean")
        axes.plot([row.maximum for row in rows], height, "x", markersize=4, label="maximum")
        axes.set_yticks(height, [row.label for row in rows], fontsize=6)
        for text in axes.get_yticklabels():
            text.set_color("tab:red" if text.get_text().startswith("deb") else "black")
        axes.set(xscale="log", xlabel="error in degrees", title=family)
        _plain_numbers(axes.xaxis)
        axes.set_ylim(len(rows), -1)
        axes.grid(alpha=0.3)
    figure.axes[0].legend(fontsize=8)
    return figure


def plot_settings(results: Results, family: str, name: str) -> Any:
    """Draw mean and maximum error of representative entrants against a family's setting.

    Examples
    --------
    >>> len(plot_settings(Results([], [], [], [], {}, [], [], {}), "flower", "n").axes)
    2
    """
    figure = _figure(11.0, 4.6)
    labels = representatives(results.rows, family)
    for axes, field in zip(figure.subplots(1, 2), ("mean", "maximum"), strict=True):
        for label, style in _styles(labels).items():
            rows = [r for r in results.rows if r.family == family and r.label == label]
            values = [getattr(row, field) for row in rows]
            axes.plot([row.setting for row in rows], values, label=label, **style)
        axes.set(xlabel=name, ylabel="degrees", title=f"{family}: {field} error", yscale="log")
        _plain_numbers(axes.yaxis)
        axes.grid(alpha=0.3, which="both")
    if labels:
        figure.axes[1].legend(fontsize=7, loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def plot_convergence(results: Results) -> Any:
    """Draw the mean error against the grid step with the fitted orders.

    Examples
    --------
    >>> len(plot_convergence(Results([], [], [], [], {}, [], [], {})).axes)
    3
    """
    figure = _figure(14.0, 5.6)
    found = orders(results)
    for axes, family in zip(figure.subplots(1, 3), SETTINGS, strict=True):
        finest = [r for r in results.grid if r.family == f"grid {family}"]
        for label, style in _styles(representatives(finest, f"grid {family}")).items():
            rows = [r for r in finest if r.label == label]
            steps = [1.0 / row.setting for row in rows]
            text = f"{label}: {found.get(label, {}).get(family, float('nan')):.2f}"
            axes.plot(steps, [r.mean for r in rows], marker=".", label=text, **style)
        axes.set(xscale="log", yscale="log", xlabel="grid step h", title=f"{family}: error, order")
        _plain_numbers(axes.xaxis)
        _plain_numbers(axes.yaxis)
        axes.grid(alpha=0.3, which="both")
        if finest:
            axes.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2)
    figure.axes[0].set_ylabel("mean error in degrees")
    return figure


def plot_isotropy(results: Results) -> Any:
    """Draw the mean error on circles against the direction of the tangent.

    Examples
    --------
    >>> len(plot_isotropy(Results([], [], [], [], {}, [], [], {})).axes)
    1
    """
    figure = _figure(7.5, 5.6)
    axes = figure.add_subplot(projection="polar")
    shown = [n for n in representatives(results.rows, "circle")[:9] if n != "lambda_msg"]
    for label, style in _styles(shown).items():
        errors = results.directions.get(label)
        if errors is not None:
            middle = (np.arange(len(errors) + 1) + 0.5) * (2.0 * np.pi / len(errors))
            axes.plot(middle, np.append(errors, errors[0]), label=label, **style)
    axes.set_title("mean error in degrees on circles, by direction of the tangent", fontsize=9)
    if results.directions:
        axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.1, 0.5))
    return figure
