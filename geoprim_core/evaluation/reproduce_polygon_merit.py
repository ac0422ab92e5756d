"""The part of the report on chapter 2 that holds the polygons against the optimal ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from geoprim_core.evaluation.claims import grid_lines
from geoprim_core.evaluation.polygon import MeanRelative, RelativeMetrics, mean_relative
from geoprim_core.evaluation.reproduce_polygon import (
    LONGEST_JUDGED,
    PROPOSED,
    RELATIVE,
    SHORTEST_JUDGED,
    Row,
    SetRow,
)

_ABOUT = (
    "Fidelity: ISE of the optimal polygon of as many vertices / ISE. Efficiency: fewest vertices",
    "with which an ISE as small can be had / vertices. Merit: sqrt(fidelity efficiency) (Rosin,",
    "1997; thesis 2.1.1). They judge by the ISE alone, which favours polygons through all pixels",
    "and Masood's original method, which lessens it, over limits of the largest deviation.",
)
# What was done to the curves -> which rows hold them.
_GROUPS: Mapping[str, Callable[[Row], bool]] = {
    "as they are": lambda row: row.table < "2.7",
    "degraded": lambda row: row.noise > 0,
    "at 1/2 to 1/5": lambda row: row.divisor > 1,
    "by formula, real-valued": lambda row: row.curve.endswith(" real"),
}


def merit_cells(relative: RelativeMetrics | MeanRelative | None) -> list[str]:
    """Return fidelity, efficiency and merit as they stand in a table.

    Examples
    --------
    >>> merit_cells(RelativeMetrics(0.25, 1.0)), merit_cells(None)
    (['0.25', '1.00', '0.50'], ['-', '-', '-'])
    """
    if relative is None:
        return ["-"] * len(RELATIVE)
    return [f"{getattr(relative, name):.2f}" for name in RELATIVE]


def merit_lines(rows: Sequence[Row], images: Sequence[SetRow] = ()) -> list[str]:
    """Return the section: means over the curves, what changes them, and images.

    Examples
    --------
    >>> merit_lines([])[0]
    '## Against the optimal polygon: fidelity, efficiency, merit'
    """
    lines = ["## Against the optimal polygon: fidelity, efficiency, merit", "", *_ABOUT, ""]
    lines += [*_mean_lines(rows), *_group_lines(rows), *_left_out(rows)]
    return lines + _image_lines(images)


def _mean_lines(rows: Sequence[Row]) -> list[str]:
    """Return the means of every method over the curves as they are, the best merit first."""
    found = []
    for label in dict.fromkeys(row.label for row in rows):
        own = _judged(rows, label, "as they are")
        if own:
            worst = min(own, key=lambda curve: own[curve].merit)
            found.append((label, mean_relative(list(own.values())), worst, own[worst].merit))
    found.sort(key=lambda cells: -cells[1].merit)
    cells = [
        (label, mean.count, *merit_cells(mean), f"{least:.2f} ({worst})")
        for label, mean, worst, least in found
    ]
    heads = ("method", "curves", *RELATIVE, "least merit")
    return ["Means over the curves as they are:", "", *grid_lines(heads, cells)]


def _judged(rows: Sequence[Row], label: str, group: str) -> dict[str, RelativeMetrics]:
    """Return the rows of a label and group that were judged, each under a name of its own."""
    return {
        f"{row.curve} {row.divisor} {row.noise}".removesuffix(" 1 0"): row.relative
        for row in rows
        if row.label == label and row.relative is not None and _GROUPS[group](row)
    }


def _group_lines(rows: Sequence[Row]) -> list[str]:
    """Return the merit of the proposed methods on curves that are noisy, small or no pixels."""
    cells = []
    for label in PROPOSED:
        parts = [list(_judged(rows, label, group).values()) for group in _GROUPS]
        if any(parts):
            merits = (f"{mean_relative(p).merit:.2f} ({len(p)})" if p else "-" for p in parts)
            cells.append((label, *merits))
    return ["Merit (curves):", "", *grid_lines(("method", *_GROUPS), cells)]


def _left_out(rows: Sequence[Row]) -> list[str]:
    """Tell which curves were not judged, and why."""
    missing = {row.curve: row.metrics.pixels for row in rows if row.relative is None}
    long = ", ".join(f"{k} ({m} px)" for k, m in missing.items() if m > LONGEST_JUDGED)
    single = ", ".join(k for k, m in missing.items() if m <= LONGEST_JUDGED)
    lines = [
        f"Curves of more than {LONGEST_JUDGED:,} pixels are left out, for the time of their optimum"
        f" grows with the square of the length: {long or 'none'}."
    ]
    lines += (
        [f"Left out, for the polygon of a method is a single point: {single}."] if single else []
    )
    return [*lines, ""]


def _image_lines(images: Sequence[SetRow]) -> list[str]:
    """Return the means over sets of images, and how many of their contours were judged."""
    if not images:
        return []
    cells = [
        (row.images, row.label, row.metrics.count, row.judged, row.curves,
         *merit_cells(row.relative))
        for row in images
    ]  # fmt: skip
    heads = ("set", "method", "images", "contours judged", "of", *RELATIVE)
    about = (
        f"Edge contours of images, means over the images; contours of {SHORTEST_JUDGED} to"
        f" {LONGEST_JUDGED:,} pixels. The shorter ones, mostly specks whose polygons are all"
        " optimal, would hide the differences."
    )
    return [about, "", *grid_lines(heads, cells)]
