"""The report of `geoprim reproduce polygon`: claims, distances to published rows, tables."""

from __future__ import annotations

import csv
import difflib
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from geoprim_core.evaluation.claims import Claim, claim_lines, grid_lines
from geoprim_core.evaluation.duality import LineFit
from geoprim_core.evaluation.reproduce_polygon import COLUMNS, RELATIVE, Row, SetRow
from geoprim_core.evaluation.reproduce_polygon_merit import merit_cells, merit_lines
from geoprim_core.evaluation.thesis_tables import (
    DATA_SETS,
    FORMULA,
    METHODS,
    PARAMETERS,
    RECOMMENDED,
)

_NEAR = (
    "Reproduced: N within 10 % and MD within 0.2 px in the mean, ISE within 25 % in the median.",
    "The start pixel of a closed curve alone changes N by several vertices (errata P6), and the",
    "shapes are digitised anew, so that a few pixels differ.",
)
_LEGEND = (
    "M pixels, N vertices; MD largest deviation in pixels; ISE sum of squared deviations in px^2;",
    "FOM = CR / ISE; CR = M / N; precision and reliability as errata P1 and P2 of the thesis mend",
    "them, with s_max from the first pixel of a segment in the tables of curves, as printed, and",
    "between any two pixels in Table 2.7-9. Scale 1/k: the curve at 1/k of its resolution.",
    "Fidelity, efficiency and merit compare a polygon with the optimal ones of as many vertices",
    "and of as small an ISE; 1 is the optimum.",
)

_HEADS = ("M", "N", "MD", "ISE", "FOM", "precision", "reliability", "CR", *RELATIVE)
_TITLES = {
    "2.3-1": "PRO",
    "2.5-1": "Ramer-Douglas-Peucker",
    "2.5-2": "Masood",
    "2.5-3": "Carmona",
    "2.6": "other methods, default parameters (no table of the thesis)",
    "2.7-1": "scaling, PRO(1.0)",
    "2.7-2": "scaling, RDP(mod)",
    "2.7-3": "scaling, Masood(mod)",
    "2.7-4": "scaling, Carmona(mod)",
    "2.7-5": "noise (rows with a seed are degraded)",
    "2.7-7": "superformula curves",
    "2.7-8": "sinc curve",
}


def rows_csv(rows: Sequence[Row]) -> str:
    """Return the rows as CSV, numbers in full.

    Examples
    --------
    >>> rows_csv([]).splitlines()[0][:25]
    'table,curve,label,divisor'
    """
    file = io.StringIO()
    table = csv.writer(file, lineterminator="\n")
    table.writerow(["table", "curve", "label", "divisor", "noise", *COLUMNS, *RELATIVE])
    table.writerows(row.cells() for row in rows)
    return file.getvalue()


@dataclass(frozen=True, slots=True, eq=False)
class Rerun:
    """All that a rerun found; `published` are rows to compare with, also those of 2.7."""

    rows: Sequence[Row] = ()
    claims: Sequence[Claim] = ()
    duality: Sequence[tuple[str, LineFit]] = ()
    pieces: Mapping[int, LineFit] = field(default_factory=dict)
    images: Sequence[SetRow] = ()
    published: Sequence[Mapping[str, str]] = ()
    figures: Sequence[str] = ()


def report_markdown(rerun: Rerun) -> str:
    """Return the whole report as Markdown.

    Examples
    --------
    >>> report_markdown(Rerun()).splitlines()[0]
    '# Polygonal approximation: chapter 2 rerun'
    """
    rows = rerun.rows
    lines = ["# Polygonal approximation: chapter 2 rerun", "", *_LEGEND, ""]
    lines += claim_lines(rerun.claims)
    lines += _published_lines(rows, rerun.published)
    lines += merit_lines(rows, rerun.images)
    lines += _duality_lines(rerun.duality, rerun.pieces)
    for table in dict.fromkeys(row.table for row in rows):
        if table == "2.7-7":
            lines += _parameter_lines()
        lines += _table_lines(table, [row for row in rows if row.table == table])
    lines += _formula_lines(rows)
    lines += _recommendation_lines(rows)
    lines += _image_lines(rerun.images)
    lines += ["## Figures", "", *(f"![{name}]({name})" for name in rerun.figures), ""]
    return "\n".join(lines) + "\n"


def _duality_lines(
    duality: Sequence[tuple[str, LineFit]], pieces: Mapping[int, LineFit]
) -> list[str]:
    named = [*duality, *((f"pieces of {m} px, mean", fit) for m, fit in pieces.items())]
    rows = [
        (
            *(name, fit.pixels, f"{fit.share:.6f}"),
            *(f"{fit.printed_precision:.2f}", f"{fit.precision:.3f}", f"{fit.reliability:.3f}"),
        )
        for name, fit in named
    ]
    heads = ("curve", "M", "sum B / M", "(2-5)", "precision", "reliability")
    return ["## Table 2.2-1: lines fitted to short curves", "", *grid_lines(heads, rows)]


def _parameter_lines() -> list[str]:
    heads = ("curve", "a", "m", "n1", "n2", "n3", "theta_0", "x_0", "y_0")
    rows = [(name, *values) for name, values in PARAMETERS.items()]
    lines = ["## Table 2.7-6: parameters of the curves by formula", "", *grid_lines(heads, rows)]
    return [*lines, "theta = p pi / 1000, p = 0 .. 1000.", ""]


def _formula_lines(rows: Sequence[Row]) -> list[str]:
    """Return the totals of the curves by formula beside the printed ones."""
    cells = []
    for name, printed in FORMULA.items():
        wanted = ["sinc real"] if name == "sinc" else [f"curve_{k} real" for k in (1, 2, 3)]
        for label, values in zip(METHODS, printed, strict=True):
            own = [r.metrics for r in rows if r.curve in wanted and r.label == label]
            if own:
                n, ise = sum(m.vertices for m in own), np.mean([m.ise for m in own])
                ours = (n, f"{max(m.max_deviation for m in own):.2f}", f"{ise:.1f}")
                cells.append(
                    (name, label, *(f"{a} / {b}" for a, b in zip(ours, values, strict=True)))
                )
    heads = ("curves", "method", "N ours / printed", "MD", "ISE (mean)")
    return ["## Tables 2.7-7 and 2.7-8 beside the printed ones", "", *grid_lines(heads, cells)]


def _table_lines(table: str, rows: Sequence[Row]) -> list[str]:
    heads = ("curve", "method", "scale", "seed", *_HEADS)
    cells = []
    for row in rows:
        values = [getattr(row.metrics, name) for name in COLUMNS]
        shown = [f"{v}" if isinstance(v, int) else f"{v:.2f}" for v in values]
        cells.append(
            (
                row.curve,
                row.label,
                f"1/{row.divisor}",
                row.noise or "",
                *shown,
                *merit_cells(row.relative),
            )
        )
    return [f"## Table {table}: {_TITLES.get(table, '')}", "", *grid_lines(heads, cells)]


def _recommendation_lines(rows: Sequence[Row]) -> list[str]:
    """Return the means of the methods that 2.7.5 recommends, over the curves of Section 2.5."""
    names = ("vertices", "max_deviation", "ise", "precision", "reliability", "compression_ratio")
    cells = []
    for use, labels in RECOMMENDED.items():
        for label in labels:
            own = [r.metrics for r in rows if r.label == label and r.table < "2.7"]
            if own:
                means = [float(np.mean([getattr(m, name) for m in own])) for name in names]
                cells.append((use, label, *(f"{v:.2f}" for v in means)))
    heads = ("for", "method", "N", "MD", "ISE", "precision", "reliability", "CR")
    return ["## Recommendations (2.7.5): means over the curves", "", *grid_lines(heads, cells)]


def _image_lines(images: Sequence[SetRow]) -> list[str]:
    if not images:
        return []
    names = ["precision", "reliability", "compression_ratio", "max_deviation", "ise"]
    names.append("figure_of_merit")
    rows: list[Sequence[object]] = [
        (*(row.images, row.label, row.metrics.count),
         *(f"{getattr(row.metrics, n):.2f}" for n in names))
        for row in images
    ]  # fmt: skip
    rows += [
        ("printed, ten sets", label, "", *(f"{v:.2f}" for v in values))
        for label, values in DATA_SETS.items()
    ]
    heads = ("set", "method", "images", "precision", "reliability", "CR", "MD", "ISE", "FOM")
    return ["## Table 2.7-9: edge contours of images", "", *grid_lines(heads, rows)]


def _published_lines(rows: Sequence[Row], published: Sequence[Mapping[str, str]]) -> list[str]:
    """Return how far N, MD and ISE of each group of rows are from the published ones."""
    cells = []
    for table, label in dict.fromkeys((row.table, row.label) for row in rows):
        own = [row for row in rows if (row.table, row.label) == (table, label)]
        pairs = _pairs(own, label, published)
        if pairs:
            cells.append((table, label, *_distances(pairs)))
    if not cells:
        return []
    heads = ["table", "method", "rows", "mean N ours / printed", "N off by (mean)"]
    heads += ["MD off by (mean)", "ISE off by (median)", "same N", "result"]
    return ["## Distance to the published rows", "", *grid_lines(heads, cells), *_NEAR, ""]


def _distances(pairs: Sequence[tuple[Row, Mapping[str, str]]]) -> list[object]:
    metrics = [row.metrics for row, _ in pairs]
    ours = np.array([(m.vertices, m.max_deviation, m.ise) for m in metrics])
    theirs = np.array([[float(p[name]) for name in ("N", "MD", "ISE")] for _, p in pairs])
    n, md, ise = np.abs(ours - theirs).T
    share = float(np.median(ise / np.maximum(theirs[:, 2], 1e-9)))
    means = f"{ours[:, 0].mean():.1f} / {theirs[:, 0].mean():.1f}"
    off = [f"{n.mean():.1f}", f"{md.mean():.2f}", f"{100 * share:.0f} %"]
    near = n.mean() <= 0.1 * theirs[:, 0].mean() and md.mean() <= 0.2 and share <= 0.25
    return [len(pairs), means, *off, int((n == 0).sum()), "reproduced" if near else "not"]


def _pairs(
    rows: Sequence[Row], label: str, published: Sequence[Mapping[str, str]]
) -> list[tuple[Row, Mapping[str, str]]]:
    """Return the rows, all of one label, each with the published row of its curve."""
    pairs = []
    for row in rows:
        wanted = {_plain(p["shape"]): p for p in published if _is_of(p, label, row)}
        near = difflib.get_close_matches(_plain(row.curve), wanted, 1, 0.88)
        if near:
            pairs.append((row, wanted[near[0]]))
    return pairs


def _is_of(published: Mapping[str, str], label: str, row: Row) -> bool:
    """Tell whether a published row is of this label and of what was done to the curve."""
    changed = (int(published.get("divisor", 1)), int(published.get("noise", 0)))
    same = f"{published['method']}({published['param']})" == label
    return same and changed == (row.divisor, min(row.noise, 1))


def _plain(name: str) -> str:
    return "".join(letter for letter in name.lower() if letter.isalnum())
