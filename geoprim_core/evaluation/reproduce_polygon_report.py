"""The report of `geoprim reproduce polygon`: claims, distances to published rows, tables."""

from __future__ import annotations

import csv
import difflib
import io
from collections.abc import Mapping, Sequence

import numpy as np

from geoprim_core.evaluation.claims import Claim, claim_lines, grid_lines
from geoprim_core.evaluation.reproduce_polygon import COLUMNS, Row, SetRow, available

_HEADS = ("M", "N", "MD", "ISE", "FOM", "precision", "reliability", "CR")
_TITLES = {
    "2.3-1": "PRO",
    "2.5-1": "Ramer-Douglas-Peucker",
    "2.5-2": "Masood",
    "2.5-3": "Carmona",
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
    table.writerow(["table", "curve", "label", "divisor", "noise", *COLUMNS])
    table.writerows(row.cells() for row in rows)
    return file.getvalue()


def report_markdown(
    rows: Sequence[Row],
    claims: Sequence[Claim],
    duality: Sequence[tuple[str, int, float, float]],
    images: Sequence[SetRow],
    published: Sequence[Mapping[str, str]] = (),
) -> str:
    """Return the whole report as Markdown.

    Examples
    --------
    >>> report_markdown([], [], [], []).splitlines()[0]
    '# Polygonal approximation: chapter 2 rerun'
    """
    lines = ["# Polygonal approximation: chapter 2 rerun", ""]
    lines += ["Methods: " + ", ".join(variant.label for variant in available()) + ".", ""]
    lines += claim_lines(claims)
    if published:
        lines += _published_lines(rows, published)
    lines += _duality_lines(duality)
    for table in dict.fromkeys(row.table for row in rows):
        lines += _table_lines(table, [row for row in rows if row.table == table])
    lines += _image_lines(images)
    return "\n".join(lines) + "\n"


def _duality_lines(duality: Sequence[tuple[str, int, float, float]]) -> list[str]:
    rows = [(name, count, f"{p:.3f}", f"{r:.3f}") for name, count, p, r in duality]
    heads = ("curve", "pixels", "precision", "reliability")
    return ["## Table 2.2-1: lines fitted to short curves", "", *grid_lines(heads, rows)]


def _table_lines(table: str, rows: Sequence[Row]) -> list[str]:
    heads = ("curve", "method", "scale", "seed", *_HEADS)
    cells = []
    for row in rows:
        values = [getattr(row.metrics, name) for name in COLUMNS]
        shown = [f"{v}" if isinstance(v, int) else f"{v:.2f}" for v in values]
        cells.append((row.curve, row.label, f"1/{row.divisor}", row.noise or "", *shown))
    return [f"## Table {table}: {_TITLES.get(table, '')}", "", *grid_lines(heads, cells)]


def _image_lines(images: Sequence[SetRow]) -> list[str]:
    if not images:
        return []
    names = ["precision", "reliability", "compression_ratio", "max_deviation", "ise"]
    names.append("figure_of_merit")
    rows = [
        (row.label, row.metrics.count, *(f"{getattr(row.metrics, n):.2f}" for n in names))
        for row in images
    ]
    heads = ("method", "images", "precision", "reliability", "CR", "MD", "ISE", "FOM")
    return ["## Table 2.7-9: edge contours of images", "", *grid_lines(heads, rows)]


def _published_lines(rows: Sequence[Row], published: Sequence[Mapping[str, str]]) -> list[str]:
    """Return how far N, MD and ISE of each group of rows are from the published ones."""
    cells = []
    for variant in available():
        own = [row for row in rows if row.table == variant.table and row.label == variant.label]
        pairs = _pairs(own, variant.label, published)
        if not pairs:
            continue
        metrics = [row.metrics for row, _ in pairs]
        ours = np.array([(m.vertices, m.max_deviation, m.ise) for m in metrics])
        theirs = np.array([[float(p[name]) for name in ("N", "MD", "ISE")] for _, p in pairs])
        n, md, ise = np.abs(ours - theirs).T
        shares = np.median(ise / np.maximum(theirs[:, 2], 1e-9))
        cells.append(
            (
                variant.label,
                len(pairs),
                f"{ours[:, 0].mean():.1f} / {theirs[:, 0].mean():.1f}",
                f"{n.mean():.1f}",
                f"{md.mean():.2f}",
                f"{100 * shares:.0f} %",
                int((n == 0).sum()),
            )
        )
    heads = ["method", "curves", "mean N ours / printed", "N off by (mean)", "MD off by (mean)"]
    heads += ["ISE off by (median)", "same N"]
    return ["## Distance to the published rows", "", *grid_lines(heads, cells)]


def _pairs(
    rows: Sequence[Row], label: str, published: Sequence[Mapping[str, str]]
) -> list[tuple[Row, Mapping[str, str]]]:
    """Return the rows, all of one label, each with the published row of its curve."""
    wanted = {_plain(p["shape"]): p for p in published if f"{p['method']}({p['param']})" == label}
    pairs = []
    for row in rows:
        near = difflib.get_close_matches(_plain(row.curve), wanted, 1, 0.88)
        if near:
            pairs.append((row, wanted[near[0]]))
    return pairs


def _plain(name: str) -> str:
    return "".join(letter for letter in name.lower() if letter.isalnum())
