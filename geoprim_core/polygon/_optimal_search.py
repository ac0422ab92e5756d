"""The search behind `optimal`: best path of N segments over a table of segment errors."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core.errors import InputError
from geoprim_core.polygon import _kernels_optimal as _dynamic
from geoprim_core.polygon import _kernels_priced as _priced
from geoprim_core.polygon._kernels_greedy import greedy_polygon

MOST_SEGMENTS = 40_000_000
"""Most segment errors, and most states, that a call may hold at a time (320 MB each)."""

ISE, ABSOLUTE, LARGEST, ISE_WITHIN = range(4)
SLACK = 1e-9
TIE = _dynamic.TIE
_SWEEPS = 50
_BISECTIONS = 14


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """A curve with the table of its segments' errors (see the kernels).

    A path is a list of nodes; that of a closed curve ends one round after its start.
    """

    curve: FloatArray
    closed: bool
    first: IntArray
    table: FloatArray

    @classmethod
    def of(cls, curve: FloatArray, closed: bool) -> Problem:
        """Return the problem of a curve, without a table as yet."""
        return cls(curve - curve[0], closed, np.zeros(len(curve) + 1, np.int64), np.zeros(0))

    @property
    def count(self) -> int:
        """The number of pixels."""
        return len(self.curve)

    @property
    def end(self) -> int:
        """The node at which a path from node 0 ends."""
        return self.count if self.closed else self.count - 1

    def limited(self, kind: int, limit: float, reach: float = 0.0) -> Problem:
        """Return the problem with the segments of at most `limit`, and `reach` of distance."""
        nodes = np.vstack([self.curve, self.curve[:-1]]) if self.closed else self.curve
        x, y = np.ascontiguousarray(nodes.T)
        wide, far = (value * (1.0 + SLACK) + SLACK for value in (limit, reach))
        first, table = _dynamic.segment_table(x, y, self.count, kind, wide, far, MOST_SEGMENTS)
        if len(first) == 0:
            expected = f"at most {MOST_SEGMENTS} segments in reach: more vertices, less tolerance"
            raise InputError("points", expected, f"{self.count} pixels")
        return replace(self, first=first, table=table)

    def error(self, path: IntArray) -> float:
        """Return the sum of the segment errors along a path; infinite off the table."""
        if len(path) == 0:
            return np.inf
        rows = path[:-1] % self.count
        places = self.first[rows] + np.diff(path) - 1
        inside = places < self.first[rows + 1]
        return float(self.table[places].sum()) if inside.all() else np.inf

    def greedy(self, vertices: int, begin: IntArray | None = None) -> IntArray:
        """Return the path of the greedy polygon that grows from the vertices `begin`."""
        if begin is None:
            begin = np.array([0] if self.closed else [0, self.count - 1])
        nodes = greedy_polygon(self.curve, self.closed, begin, vertices, _SWEEPS)
        return np.append(nodes, nodes[0] + self.count) if self.closed else nodes


def error_of(problem: Problem, path: IntArray, kind: int) -> float:
    """Return the error of any path: the sum over its segments, or for LARGEST the maximum."""
    curve, count = problem.curve, problem.count
    errors = []
    for i, j in pairwise(path):
        x, y = curve[np.arange(i, j + 1) % count].T
        errors.append(_segment_error(x - x[0], y - y[0], kind))
    return max(errors) if kind == LARGEST else sum(errors)


def _segment_error(x: FloatArray, y: FloatArray, kind: int) -> float:
    length = np.hypot(x[-1], y[-1])
    distance = np.hypot(x, y) if length == 0.0 else np.abs(x[-1] * y - y[-1] * x) / length
    if kind == LARGEST:
        return float(distance.max())
    return float(distance.sum() if kind == ABSOLUTE else (distance**2).sum())


def fewest(problem: Problem) -> IntArray:
    """Return a path of the fewest segments of the table, whatever their errors."""
    low, starts = _dynamic.start_window(problem.first) if problem.closed else (0, 0)
    _, path = _dynamic.fewest_links(problem.first, problem.table, low, starts, problem.closed)
    result: IntArray = path
    return result


def least_links(problem: Problem, cap: float) -> int:
    """Return a number of segments below which no polygon's error is within `cap`."""
    low, starts = _dynamic.start_window(problem.first) if problem.closed else (0, 0)
    goal = low + problem.end
    return int(
        _dynamic.least_links(
            problem.first, problem.table, low, starts, problem.end + starts, goal, cap
        )
    )


def solve(problem: Problem, known: IntArray, links: int) -> IntArray:
    """Return the best path of exactly `links` segments, empty where the table has none.

    The table must hold every segment whose error is at most that of `known`, a path of `links`
    segments or fewer.
    """
    nodes = 2 * problem.count if problem.closed else problem.count
    if (links + 1) * nodes > MOST_SEGMENTS:
        expected = f"at most {MOST_SEGMENTS} states, vertices times pixels"
        raise InputError("points", expected, f"{links} on {problem.count} pixels")
    if len(known) - 1 == links:
        problem, known = _reduced(problem, known)
    if not problem.closed:
        return _from_start(problem, 0, links)
    path = _from_start(problem, int(known[0]) % problem.count, links)
    path, error = _improved(problem, path)
    return _best_start(problem, path, error, links)


def _reduced(problem: Problem, known: IntArray) -> tuple[Problem, IntArray]:
    """Strike out the segments that no polygon better than the best one known can have."""
    links = len(known) - 1
    if problem.error(known) <= SLACK:
        return problem, known
    low = int(known[0]) % problem.count if problem.closed else 0
    price, path = _price(problem, low, links, problem.error(known))
    if len(path):
        nodes = path[:-1] if problem.closed else path
        better = problem.greedy(links + (not problem.closed), nodes)
        known = min(known, better, key=problem.error)
    span = 2 * problem.count if problem.closed else problem.end
    least, _ = _priced.priced_path(problem.first, problem.table, low, span, price)
    potential = least[problem.count : span] if problem.closed else least
    spare = problem.error(known) * (1.0 + SLACK) + SLACK + price * links
    first, table = _priced.reduced_table(
        problem.first, problem.table, low, problem.closed, potential, price, spare
    )
    return replace(problem, first=first, table=table), known


def _price(problem: Problem, low: int, links: int, error: float) -> tuple[float, IntArray]:
    """Return the price at which a path has `links` segments, and the longest path of no more."""
    cheap, dear = 1e-3 * error / links, error
    best = np.zeros(0, np.int64)
    for _ in range(_BISECTIONS):
        price = float(np.sqrt(cheap * dear))
        _, path = _priced.priced_path(problem.first, problem.table, low, problem.end, price)
        if len(path) - 1 > links:
            cheap = price
            continue
        dear, best = price, path
        if len(path) - 1 == links:
            break
    return dear, best


def _from_start(problem: Problem, low: int, links: int) -> IntArray:
    """Return the best path of `links` segments from one node to the end of its round."""
    span, first, table = problem.end, problem.first, problem.table
    best = _dynamic.layers(first, table, low, span, links, np.zeros(1), low + span)
    cap = best[-1, -1] * (1.0 + SLACK)
    child = np.empty(best.shape, np.int64)
    _, path = _dynamic.trace(first, table, low, best, 0.0, low, low + span, cap, child)
    result: IntArray = path
    return result


def _improved(problem: Problem, path: IntArray) -> tuple[IntArray, float]:
    """Solve again from the vertex opposite to the start until that no longer helps."""
    error = problem.error(path)
    while len(path):
        again = _from_start(problem, int(path[len(path) // 2]) % problem.count, len(path) - 1)
        lower = problem.error(again)
        if not lower < error * (1.0 - SLACK):
            break
        path, error = again, lower
    return path, error


def _best_start(problem: Problem, path: IntArray, error: float, links: int) -> IntArray:
    """Return the best closed path, given the best one known; the search over starts is exact."""
    first, table, count = problem.first, problem.table, problem.count
    low, starts = _dynamic.start_window(first)
    head = _potentials(problem, path, low, starts, links)
    best = _dynamic.layers(first, table, low, count + starts, links, head, low + count)
    bounds = best[-1, count:] - head
    child = np.empty(best.shape, np.int64)
    for k in np.argsort(bounds, kind="stable"):
        if not bounds[k] < error * (1.0 - SLACK) - 1e-12:
            break
        cap = min(error, np.finfo(np.float64).max)
        start = low + k
        total, found = _dynamic.trace(
            first, table, low, best, head[k], start, start + count, cap, child
        )
        if len(found) and total < error * (1.0 - SLACK):
            path, error = found, total
    return path


def _potentials(problem: Problem, path: IntArray, low: int, starts: int, links: int) -> FloatArray:
    """Return D(v, s) for every start s, from a vertex v of the known path; any values would do."""
    if len(path) == 0:
        return np.zeros(starts + 1)
    first, table, goal = problem.first, problem.table, low + problem.count
    node = int((low + (path[:-1] - low) % problem.count).min())
    span = goal + starts - node
    best = _dynamic.layers(first, table, node, span, links, np.zeros(1), goal)[-1, goal - node :]
    finite = best[np.isfinite(best)]
    far = 2.0 * finite.max() if len(finite) else 0.0
    potentials: FloatArray = np.where(np.isfinite(best), best, far)
    return potentials
