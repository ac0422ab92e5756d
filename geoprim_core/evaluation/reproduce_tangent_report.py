"""The report of `geoprim reproduce tangent`: claims, rankings, bounds, orders; and the chooser."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from geoprim_core.evaluation.claims import Claim, claim_lines, grid_lines
from geoprim_core.evaluation.reproduce_tangent import SETTINGS
from geoprim_core.evaluation.reproduce_tangent_claims import THESIS, orders
from geoprim_core.evaluation.reproduce_tangent_run import Extent, Results
from geoprim_core.evaluation.tangent_errors import Row, control_of, pooled

_TITLES = {
    "circle": "circles of radius 100 (3.6.3)",
    "ellipse": "ellipses of semi-major axis 100, e = 0 .. 0.99 (3.6.4)",
    "flower": "flower curves (3-34), n = 1 .. 7 (3.6.5)",
}
_THIN = 0.9  # eccentricity from which an ellipse counts as thin

_METHOD_TEXT = """\
Error: angle between the estimated direction of travel and the true one, in degrees (0 to 180), at
every pixel. Curves are digitised on the lines of the grid: where the curve crosses a line, the
pixel of the line nearest to the crossing is taken. The true tangent of a pixel is that of the
curve at its point nearest to the pixel's centre. Mean: over all pixels, then over the settings.
Maximum: the largest error of each curve, averaged over the curves. Worst: of all curves.

R and Q stand in brackets: for each family the value of least mean error on other curves (another
seed) than those of the tables; `deb(10)` is the thesis' choice. Hybrids `_h10` to `_h4` choose Q
themselves."""


def report_markdown(
    results: Results, claims: Sequence[Claim], extent: Extent, seed: int, seconds: float
) -> str:
    """Return the whole report as Markdown.

    Examples
    --------
    >>> empty = Results([], [], [], [], {}, [], [], {})
    >>> report_markdown(empty, [], Extent.of(1), 0, 2.0).splitlines()[0]
    '# Tangent estimation: chapter 3 rerun'
    """
    lines = ["# Tangent estimation: chapter 3 rerun", ""]
    held = sum(claim.holds is True for claim in claims)
    tried = sum(claim.holds is not None for claim in claims)
    lines += [f"{len(extent.methods)} methods, {extent.count} curves a setting, seed {seed}."]
    lines += [f"The run took {seconds:.0f} s."]
    lines += [f"{held} of {tried} claims are reproduced.", "", _METHOD_TEXT, ""]
    lines += claim_lines(claims)
    for family in SETTINGS:
        lines += _ranking_lines(results, family)
    lines += _flower_lines(results) + _order_lines(results)
    lines += _bound_lines(results) + _walk_lines(results) + _sensitivity_lines(results)
    return "\n".join(lines) + "\n"


def ranking(rows: Iterable[Row], family: str) -> list[Row]:
    """Return the pooled rows of a family, the least mean error first; undefined ones last.

    Examples
    --------
    >>> rows = [Row("circle", 0.0, name, mean, 9, 9, 1.0) for name, mean in (("a", 2), ("b", 1))]
    >>> [row.label for row in ranking(rows, "circle")]
    ['b', 'a']
    """
    found = pooled(rows, family).values()
    return sorted(found, key=lambda row: (row.defined < 0.5, not np.isfinite(row.mean), row.mean))


def _ranking_lines(results: Results, family: str) -> list[str]:
    rows = ranking(results.rows, family)
    by_maximum = sorted(rows, key=lambda row: row.maximum)
    place = {row.label: k + 1 for k, row in enumerate(by_maximum)}
    cells = [
        (
            k + 1,
            f"**{row.label}**" if row.label == THESIS else row.label,
            f"{row.mean:.3f}",
            f"{row.maximum:.2f}",
            place[row.label],
            f"{row.worst:.2f}",
            f"{100 * row.defined:.1f}",
        )
        for k, row in enumerate(rows)
    ]
    heads = ("place", "method", "mean", "maximum", "place by maximum", "worst", "defined %")
    return [f"## Ranking: {_TITLES[family]}", "", *grid_lines(heads, cells)]


def _flower_lines(results: Results) -> list[str]:
    found: dict[str, dict[float, Row]] = {}
    for row in results.rows:
        if row.family == "flower":
            found.setdefault(row.label, {})[row.setting] = row
    best = [row.label for row in ranking(results.rows, "flower")[:10]]
    shown = list(dict.fromkeys([*best, *(n for n in (THESIS, "lambda_mst") if n in found)]))
    cells = [
        (label, *(f"{r.mean:.2f} / {r.maximum:.1f}" for r in found[label].values()))
        for label in shown
    ]
    heads = ("method", *(f"n = {n}" for n in SETTINGS["flower"]))
    title = "## Flower curves: mean / maximum for each n, the ten best and two of the thesis"
    return [title, "", *grid_lines(heads, cells)]


def _order_lines(results: Results) -> list[str]:
    found = orders(results)
    shapes = ("circle", "ellipse", "flower")
    rows = sorted(found.items(), key=lambda pair: -sum(pair[1].values()))
    cells = [
        (label, *(f"{each.get(shape, float('nan')):.2f}" for shape in shapes))
        for label, each in rows
    ]
    text = """\
Order k of the fit error = c h^k to the mean error, h being the grid step: radius, semi-major axis
(e = 0.8) and outer radius (n = 3) of 1 / h pixels. Methods with a fixed Q or R cannot converge;
DEB with R = rho/2 as in (3-32) keeps its analytic error on all but circles, as |kappa'| falls with
h^2 and R^2 grows as fast; R = 2 rho^(2/3) makes both parts of its error of order 2/3."""
    heads = ("method", "circle", "ellipse", "flower")
    return ["## Multigrid convergence", "", text, "", *grid_lines(heads, cells)]


_BOUNDS = {
    "analytic": "analytic error",
    "printed": "(3-27)",
    "leading": "T2, leading",
    "analytic_limit": "analytic bound",
    "digital": "digital error",
    "digital_limit": "digital bound (P4)",
    "total": "total error",
    "total_limit": "total bound",
}


def _bound_lines(results: Results) -> list[str]:
    cells = []
    for family in dict.fromkeys(row.family for row in results.bounds):
        for radius in dict.fromkeys(row.radius for row in results.bounds):
            rows = [r for r in results.bounds if r.family == family and r.radius == radius]
            largest = [max(getattr(row, name) for row in rows) for name in _BOUNDS]
            beyond = sum(row.exceeded for row in rows)
            shortest = min(row.shortest for row in rows)
            figures = (*(f"{value:.4f}" for value in largest), f"{shortest:.2f}", beyond)
            cells.append((family, len(rows), f"{radius:g}", *figures))
    heads = ("family", "curves", "R", *_BOUNDS.values(), "min(s)", "points above the total bound")
    title = "## Bounds of DEB: largest errors and bounds in degrees (3.5)"
    return [title, "", *grid_lines(heads, cells)]


def _walk_lines(results: Results) -> list[str]:
    cells = [
        (f"{r.rho:g}", f"{r.radius:g}", r.pixels, f"{r.worst:.2f}", r.beyond_total, r.beyond_walk)
        for r in results.walks
    ]
    heads = ("rho", "R", "pixels", "worst error", "above the total bound", "above it + walk_bound")
    return ["## DEB along the pixels of digitised circles", "", *grid_lines(heads, cells)]


def _sensitivity_lines(results: Results) -> list[str]:
    cells = [
        (e.test, "yes" if e.digitised else "no", f"{e.semi_major:g}", f"{e.mean:.4f}",
         f"{e.maximum:.4f}")
        for e in results.sensitivity
        if not e.digitised or e.semi_major % 30 == 10
    ]  # fmt: skip
    heads = ("test", "digitised", "a", "mean error / a", "largest error / a")
    return ["## Yuen's centre, tangents turned by up to 15 degrees (3.2.2)", "",
            *grid_lines(heads, cells)]  # fmt: skip


def chooser_markdown(results: Results, extent: Extent, seed: int) -> str:
    """Return the page that says which method suits which curve.

    Examples
    --------
    >>> empty = Results([], [], [], [], {}, [], [], {})
    >>> chooser_markdown(empty, Extent.of(1), 0).splitlines()[0]
    '# Which tangent estimator for which curve'
    """
    lines = ["# Which tangent estimator for which curve", ""]
    lines += [
        f"Written by `geoprim reproduce tangent --count {extent.count} --seed {seed} "
        "--chooser docs/tangents.md`. Errors in degrees: mean / maximum of a curve, averaged.",
        "",
    ]
    cells = []
    for title, rows in _situations(results):
        found = _pool_of(rows)
        if not found:
            continue
        mean, maximum = (min(found, key=lambda r: getattr(r, n)) for n in ("mean", "maximum"))
        fixed = [r for r in found if "(" not in r.label and control_of(r.label) is None]
        free = min(fixed, key=lambda r: r.mean) if fixed else None
        deb = min((r for r in found if r.label.startswith("deb")), key=lambda r: r.mean)
        cells.append((title, *(_figures(row) for row in (mean, maximum, free, deb))))
    heads = ("curve", "least mean", "least maximum", "least mean without a parameter", "best DEB")
    return "\n".join([*lines, *grid_lines(heads, cells), _ADVICE])


_ADVICE = """\
- `lr1` to `lr5`: regression of this order; `epf`, `ipf`, `icipf`: parabolae; `matas`: median;
  `lambda_mst`, `lambda_msg`: maximal segments. `_h10` to `_h4` choose Q at each pixel, or for the
  curve, from maximal segments (`geoprim_core.tangent.hybrid`).
- In brackets: R of DEB, Q of the others, chosen for that family on other curves. On small and large
  shapes (circle, ellipse of e = 0.8 and flower of n = 3 together) R and Q keep their defaults, but
  for the rules of DEB in rho, the radius of the smallest circle of curvature.
- A value that suits a large circle blurs a small one: where the size of the curves is not known,
  take a method without a parameter.
- DEB joins two pixels, and its error bound is proven and known beforehand
  (`geoprim_core.tangent.bounds`): take R as half the radius of the smallest circle expected.
"""


def _situations(results: Results) -> list[tuple[str, list[Row]]]:
    rows = results.rows
    ellipses = [row for row in rows if row.family == "ellipse"]
    sizes = [r.setting for r in results.grid]
    small, large = min(sizes, default=0.0), max(sizes, default=0.0)
    return [
        ("circle, radius 100", [r for r in rows if r.family == "circle"]),
        (f"ellipse, e < {_THIN}", [r for r in ellipses if r.setting < _THIN]),
        (f"thin ellipse, e >= {_THIN}", [r for r in ellipses if r.setting >= _THIN]),
        ("flower curve, n <= 3", [r for r in rows if r.family == "flower" and r.setting <= 3]),
        ("flower curve, n > 3", [r for r in rows if r.family == "flower" and r.setting > 3]),
        (f"small: 1/4 of these ({small:g} px)", [r for r in results.grid if r.setting == small]),
        (f"large ({large:g} px)", [r for r in results.grid if r.setting == large]),
    ]


def _pool_of(rows: Sequence[Row]) -> list[Row]:
    """Return the rows of some settings pooled, those that have a direction nearly everywhere."""
    same = [Row("all", r.setting, r.label, r.mean, r.maximum, r.worst, r.defined) for r in rows]
    return [row for row in pooled(same, "all").values() if row.defined > 0.99]


def _figures(row: Row | None) -> str:
    return "" if row is None else f"`{row.label}` {row.mean:.2f} / {row.maximum:.1f}"
