"""The optimal polygon of Perez and Vidal: least error for N vertices, or fewest for an error.

How the search is kept small without losing the optimum:

- *Bound.* A greedy polygon (splits, then moves of single vertices) gives an error U that the
  optimum cannot exceed; no segment of an optimal polygon errs by more than U. The sum of squared
  distances to the *best* line through a pixel only grows with the number of pixels, so the scan
  of all segments from a pixel ends once that residual exceeds U. What remains is a narrow table
  of segment errors, each in O(1) from running sums (ISE), that all layers of the dynamic
  programme share; a layer also skips the pixels from which the end is out of reach.
- *Price.* With a price p for every segment, one pass over the table finds the best path however
  many segments it has. Its potentials bound every polygon of N segments through a given segment;
  p is chosen by bisection so that the path has about N segments, where the bound is tightest. Most
  of the table is struck out before the first layer is run. The path with the missing vertices
  added also gives a better U.
- *Start of a closed curve.* Some stretch a .. a + L is jumped over by no segment of the table, so
  one of its pixels is a vertex: only these can be starts. The optimum D(v, s) of N segments from a
  vertex v of the best polygon known to each of them, one pass, is put on the starts as a
  potential, and a second pass gives for every start s the lower bound
  min over s' of D(v, s') + D(s', s) - D(v, s). Where that is at least U the start is settled; the
  others (few, often none) are solved exactly, visiting only states whose bound is below U.

Memory: the table of segment errors, and one number a layer and pixel; each is refused beyond 40
million numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import IntArray
from geoprim_core.params import Params, as_params, option
from geoprim_core.polygon import _optimal_search as _search
from geoprim_core.polygon._optimal_search import ISE, ISE_WITHIN, LARGEST, SLACK, Problem

MEASURES = ("ise", "absolute", "max_deviation")


@dataclass(frozen=True)
class OptimalParams(Params):
    """Parameters of the optimal polygon."""

    points: int = option(
        0, "number of vertices; 0: as few as the tolerance allows", low=0, high=1000000
    )
    tolerance: float = option(
        1.0,
        "largest error of the polygon, where the number is 0 (ise: px^2)",
        unit="px",
        low=0.0,
        high=1e9,
    )
    measure: str = option(
        "max_deviation",
        "error: sum of squared distances, of distances, or largest",
        choices=MEASURES,
    )


def optimal(
    points: npt.ArrayLike, *, closed: bool = False, params: OptimalParams | None = None
) -> IntArray:
    """Approximate a curve by the polygon that no other can beat.

    With `points` given (min-epsilon) the polygon has exactly that many vertices, at least two,
    and the least error; for `max_deviation` it may have fewer where more cannot lower the error.
    Otherwise (min-#) it has the fewest vertices with which the error stays within the tolerance.
    Among polygons of equal number that of least error is taken, for `max_deviation` that of least
    ISE; of polygons of equal error one with the longest outline. Distances are those to the
    infinite line through a segment's ends. A closed curve's start vertex is searched as well.
    Errors come from sums of squares, so that points closer together than some 1e-7 of the curve's
    extent count as one.

    Parameters
    ----------
    points : (n, 2) array
        Pixels of the curve in order; the first is not repeated at the end.
    closed : bool
        Whether the last pixel touches the first.
    params : OptimalParams, optional

    Returns
    -------
    (m,) int64
        Indices of the vertices, strictly increasing; an open curve keeps both ends. A closed one
        whose pixels are all the same is one vertex, unless more `points` are asked for.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array, or the search needs too large a table.

    References
    ----------
    J. C. Perez and E. Vidal, "Optimum polygonal approximation of digitized curves", Pattern
    Recognition Letters 15, 1994; M. Salotti, "Optimal polygonal approximation of digitized curves
    using the sum of square deviations criterion", Pattern Recognition 35, 2002 (ending a scan by
    the residual of a line); thesis 2.6.1; errata P3.

    Examples
    --------
    >>> corner = [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (4, 1), (4, 2), (4, 3), (4, 4)]
    >>> optimal(corner).tolist()
    [0, 4, 8]
    >>> optimal(corner, params=OptimalParams(points=2)).tolist()
    [0, 8]
    """
    curve = _check.points(points)
    settings: OptimalParams = as_params(params, OptimalParams)
    count = len(curve)
    vertices = max(settings.points, 2)
    if count <= 2 or (settings.points and vertices >= count):
        return np.arange(count)
    if closed and not settings.points and (curve == curve[0]).all():
        return np.zeros(1, np.int64)
    problem = Problem.of(curve, bool(closed))
    if settings.points:
        path = _least_error(problem, vertices, settings.measure)
    else:
        path = _fewest_vertices(problem, settings.tolerance, settings.measure)
    return np.unique((path[:-1] if closed else path) % count)


def _least_error(problem: Problem, vertices: int, measure: str) -> IntArray:
    start = problem.greedy(vertices)
    kind = MEASURES.index(measure)
    if kind == LARGEST:
        return _least_deviation(problem, start)
    return _solved(problem, start, kind)


def _solved(problem: Problem, start: IntArray, kind: int) -> IntArray:
    """Return the best path with as many segments as `start` has."""
    bound = _search.error_of(problem, start, kind)
    return _search.solve(problem.limited(kind, bound), start, len(start) - 1)


def _least_deviation(problem: Problem, start: IntArray) -> IntArray:
    """Search the least tolerance within which no more segments are needed than `start` has."""
    links = len(start) - 1
    bound = _search.error_of(problem, start, LARGEST)
    table = problem.limited(LARGEST, bound).table
    levels = np.append(np.unique(table[np.isfinite(table)]), bound)
    low, high, path = 0, int(np.searchsorted(levels, bound * (1.0 - SLACK))), start
    while low < high:
        middle = (low + high) // 2
        trial = _within(problem, levels[middle])
        if len(trial) - 1 <= links:
            high, path = middle, trial
        else:
            low = middle + 1
    return _least_ise(problem, path, float(levels[low]), links)


def _least_ise(problem: Problem, path: IntArray, deviation: float, links: int) -> IntArray:
    """Return the polygon of least ISE among those within a deviation; `path` is one of them."""
    limit = _search.error_of(problem, path, ISE)
    allowed = problem.limited(ISE_WITHIN, limit, deviation)
    more = _search.solve(allowed, path, links)
    return more if len(more) else _search.solve(allowed, path, len(path) - 1)


def _within(problem: Problem, deviation: float) -> IntArray:
    """Return the path of fewest segments that deviate by no more; two at least where closed."""
    path = _search.fewest(problem.limited(LARGEST, deviation))
    if problem.closed and len(path) == 2:
        path = np.array([path[0], path[0] + 1, path[1]])
    return path


def _fewest_vertices(problem: Problem, tolerance: float, measure: str) -> IntArray:
    kind = MEASURES.index(measure)
    if kind == LARGEST:
        path = _within(problem, tolerance)
        return _least_ise(problem, path, tolerance, len(path) - 1)
    length = float(np.hypot(*np.diff(problem.curve, axis=0, append=problem.curve[:1]).T).sum())
    cap = (tolerance + length * _search.TIE) * (1.0 + SLACK) + SLACK
    links = _search.least_links(problem.limited(kind, tolerance), cap)
    fewest = max(links, 2) if problem.closed else links + 1
    for vertices in range(fewest, problem.count):
        path = _solved(problem, problem.greedy(vertices), kind)
        if _search.error_of(problem, path, kind) <= tolerance * (1.0 + SLACK) + SLACK:
            return path
    return np.arange(problem.end + 1)
