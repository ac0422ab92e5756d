"""The figures of `geoprim reproduce polygon`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from geoprim_core._check import FloatArray
from geoprim_core.cli.benchmark_images import save
from geoprim_core.evaluation.duality import short_curves
from geoprim_core.evaluation.reproduce_polygon import DIVISORS, PROPOSED, Variant, available
from geoprim_core.plotting import plot_bounds_by_length, plot_bounds_by_slope
from geoprim_core.plotting.duality import plot_lines, plot_metrics_by_length
from geoprim_core.plotting.polygons import plot_polygons
from geoprim_core.synthetic import degrade_curve, formula_curve, shrunk_boundary

Files = dict[str, Callable[[Path], object]]
_SHOWN = ("PRO(0.4)", "RDP(1.0)", "Masood(0.9)", "Carmona(0.3)", *PROPOSED)
_SEED = 1  # of the noisy curves drawn, the first of those measured


def figures(curves: Mapping[str, FloatArray], chosen: Mapping[str, FloatArray]) -> Files:
    """Return file name -> how to draw it: Figures 2.2-1/2, 2.3-2, 2.4-1/3, 2.5-*, 2.7-*."""
    drawn: dict[str, Callable[[], Any]] = {
        "duality_lines.png": lambda: plot_lines(short_curves()),
        "duality_lengths.png": _by_length,
        "bounds_by_slope.png": lambda: plot_bounds_by_slope().figure,
        "bounds_by_length.png": lambda: plot_bounds_by_length().figure,
        "formula_curves.png": lambda: _by_formula(("curve_1", "curve_2", "curve_3"), "real"),
        "formula_sinc.png": lambda: _by_formula(("sinc",), "real"),
        "noise.png": lambda: _noisy(chosen),
    }
    for variant in available(_SHOWN):
        drawn[f"polygons_{_stem(variant)}.png"] = lambda v=variant: _polygons(v, curves.items())  # type: ignore[misc]
    for variant in available(PROPOSED):
        drawn[f"scaling_{_stem(variant)}.png"] = lambda v=variant: _scaled(v, chosen)  # type: ignore[misc]
    return {name: _saved(draw) for name, draw in drawn.items()}


def _saved(draw: Callable[[], Any]) -> Callable[[Path], object]:
    return lambda path: save(draw(), path)


def _stem(variant: Variant) -> str:
    return "".join(c if c.isalnum() else "_" for c in variant.label.lower()).strip("_")


def _by_length() -> Any:
    """Draw precision and reliability of lines over pieces that grow, side by side."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.5, 3.6), layout="constrained")
    FigureCanvasAgg(figure)
    for k, name in enumerate(("precision", "reliability")):
        plot_metrics_by_length(_disturbed(), figure.add_subplot(1, 2, k + 1), name)
    return figure


def _disturbed() -> dict[str, FloatArray]:
    wanted = ("slope 0.38", "spike of 3 px", "step of 2 px", "bend", "arc", "wave of 2 px")
    curves = short_curves()
    return {name: curves[name] for name in wanted}


def _polygons(
    variant: Variant, curves: Iterable[tuple[str, FloatArray]], *, closed: bool = True
) -> Any:
    panels = [
        (f"{name}: N = {len(found)}", curve, found)
        for name, curve in curves
        for found in (variant.polygon(curve, closed=closed),)
    ]
    return plot_polygons(panels, closed=closed)


def _scaled(variant: Variant, chosen: Mapping[str, FloatArray]) -> Any:
    """Draw the curves scaled down, a line of panels each (Figures 2.7-1 to 2.7-4)."""
    small = [(f"{k}, 1/{d}", shrunk_boundary(c, d)) for k, c in chosen.items() for d in DIVISORS]
    return _polygons(variant, small)


def _noisy(chosen: Mapping[str, FloatArray]) -> Any:
    """Draw the methods on noisy curves, a line of panels each (Figure 2.7-5)."""
    panels = [
        (f"{name}, {variant.label}: N = {len(found)}", curve, found)
        for name, clean in chosen.items()
        for curve in (degrade_curve(clean, _SEED),)
        for variant in available(PROPOSED)
        for found in (variant.polygon(curve, closed=True),)
    ]
    return plot_polygons(panels)


def _by_formula(names: Iterable[str], kind: str) -> Any:
    """Draw the methods on curves by formula (Figures 2.7-6 to 2.7-8)."""
    panels = [
        (f"{name}, {variant.label}: N = {len(found)}", curve, found)
        for name in names
        for curve in (formula_curve(name, kind),)
        for variant in available(PROPOSED)
        for found in (variant.polygon(curve, closed=False),)
    ]
    return plot_polygons(panels, closed=False)
