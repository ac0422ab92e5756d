"""Kernels of Masood's method and of its non-parametric form, thesis 2.5.2 and errata P7.

The polygon is a doubly linked list of curve indices. The cost of a segment is its squared error
(`by_error`) or its largest deviation; costs are added in the first case, the larger one counts
in the second.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.polygon._kernels import deviation_bound_of
from geoprim_core.polygon._kernels_heap import put, take_out
from geoprim_core.polygon._kernels_reach import (
    Hulls,
    block_hulls,
    farthest_by_hulls,
    no_hulls,
)
from geoprim_core.polygon._kernels_segments import running_moments, squared_error

LONG = 1024  # points of a segment whose deviation is worth a look at the hulls


class Curve(NamedTuple):
    """A curve, written twice if it is closed, with what segments need."""

    x: FloatArray
    y: FloatArray
    sums: FloatArray
    hulls: Hulls
    size: int
    closed: bool
    by_error: bool
    window: int
    moves: int


class Chain(NamedTuple):
    """The polygon: neighbours of each vertex, and how many vertices each one's value has seen."""

    before: IntArray
    after: IntArray
    alive: BoolArray
    seen_before: IntArray
    seen_after: IntArray
    items: IntArray  # these and the next three are a heap of the values
    place: IntArray
    value: FloatArray
    size: IntArray


class Plan(NamedTuple):
    """What the deletion of a vertex does: moves (vertex, new index), `counts` up and down."""

    source: IntArray
    target: IntArray
    counts: IntArray


@kernel
def _curve_of(points: FloatArray, closed: bool, by_error: bool, window: int, moves: int) -> Curve:
    count = len(points)
    total = 2 * count if closed else count
    x, y = np.empty(total), np.empty(total)
    for i in range(total):
        source = i if i < count else i - count
        x[i], y[i] = points[source, 0], points[source, 1]
    hulls = block_hulls(x, y, total) if total > LONG else no_hulls()
    return Curve(x, y, running_moments(x, y, total), hulls, count, closed, by_error, window, moves)


@kernel
def _deviation(
    x: FloatArray, y: FloatArray, hulls: Hulls, low: int, high: int, enough: float, hint: int
) -> tuple[float, int]:
    """Return the largest deviation of a segment, or one beyond `enough`, and where it is.

    The point `hint` is looked at first: where one place of a vertex failed, the next will.
    """
    dx, dy = x[high] - x[low], y[high] - y[low]
    length = math.sqrt(dx * dx + dy * dy)
    if high - low > LONG or length == 0.0:
        place, value = farthest_by_hulls(x, y, hulls, low, high)
        return value, place
    enough *= length
    if low < hint < high:
        value = abs(dx * (y[hint] - y[low]) - dy * (x[hint] - x[low]))
        if value > enough:
            return value / length, hint
    best, place = 0.0, low
    for i in range(low + 1, high):
        value = abs(dx * (y[i] - y[low]) - dy * (x[i] - x[low]))
        if value > best:
            best, place = value, i
            if best > enough:
                break
    return best / length, place


@kernel
def _cost(
    x: FloatArray, y: FloatArray, sums: FloatArray, hulls: Hulls, count: int, by_error: bool,
    a: int, b: int,
) -> float:  # fmt: skip
    """Return the cost of the segment from vertex a on to vertex b."""
    high = b if b > a else b + count
    if by_error:
        return squared_error(x, y, sums, a, high)
    return _deviation(x, y, hulls, a, high, np.inf, -1)[0]


@kernel
def _joined(
    x: FloatArray, y: FloatArray, sums: FloatArray, hulls: Hulls, count: int, by_error: bool,
    a: int, v: int, b: int,
) -> float:  # fmt: skip
    """Return the cost of the two segments a-v-b."""
    first = _cost(x, y, sums, hulls, count, by_error, a, v)
    second = _cost(x, y, sums, hulls, count, by_error, v, b)
    return first + second if by_error else max(first, second)


@kernel
def _best_place(
    x: FloatArray, y: FloatArray, sums: FloatArray, hulls: Hulls, count: int, by_error: bool,
    window: int, a: int, v: int, b: int, now: float,
) -> tuple[int, float]:  # fmt: skip
    """Return where between a and b the vertex v costs least, and what; it stays where ties.

    The search goes from v either way and ends after `window` points without a gain. On a closed
    curve it may reach all of the curve but one point (a = b).
    """
    middle = v if v > a else v + count  # indices of the curve written twice
    last = b if b > a else b + count
    place, best = v, now - 1e-9 * (1.0 + now)  # rounding is no improvement
    first_hint, second_hint = -1, -1
    for side in (-1, 1):
        q, idle = middle + side, 0
        while a < q < last and idle < window:
            if by_error:
                value = squared_error(x, y, sums, a, q)
                if value < best:
                    value += squared_error(x, y, sums, q, last)
            else:
                value, first_hint = _deviation(x, y, hulls, a, q, best, first_hint)
                if value < best:
                    other, second_hint = _deviation(x, y, hulls, q, last, best, second_hint)
                    value = max(value, other)
            idle += 1
            if value < best:
                place, best, idle = q, value, 0
            q += side
    return (place if place < count else place - count), (best if place != v else now)


@kernel
def _plan(curve: Curve, chain: Chain, p: int, plan: Plan) -> float:
    """Work out the deletion of p with all moves; return the squared error after less before.

    Only neighbours that gain by it move; the first that does not, ends the moves of its side.
    """
    # Taken out once: a named tuple counts its arrays each time that it hands one out.
    x, y, sums, hulls = curve.x, curve.y, curve.sums, curve.hulls
    count, by_error, window, moves = curve.size, curve.by_error, curve.window, curve.moves
    before, after, source, target = chain.before, chain.after, plan.source, plan.target
    left, right = before[p], after[p]
    value = 0.0
    if by_error:
        value = _cost(x, y, sums, hulls, count, by_error, left, right) - _joined(
            x, y, sums, hulls, count, by_error, left, p, right
        )
    size = 0
    vertex, other = left, right
    while size < moves and vertex != right and (curve.closed or vertex != 0):
        a = before[vertex]
        now = _joined(x, y, sums, hulls, count, by_error, a, vertex, other)
        place, best = _best_place(x, y, sums, hulls, count, by_error, window, a, vertex, other, now)
        if place == vertex:
            break
        value += best - now
        source[size], target[size] = vertex, place
        size += 1
        vertex, other = a, place
    up = size
    vertex, other = right, target[0] if up > 0 else left
    while size < up + moves and vertex != left and (curve.closed or vertex != count - 1):
        b = after[vertex]
        taken = False  # by the moves of the other side, in a small polygon
        for k in range(up):
            taken = taken or source[k] == vertex or source[k] == b
        if taken:
            break
        now = _joined(x, y, sums, hulls, count, by_error, other, vertex, b)
        place, best = _best_place(x, y, sums, hulls, count, by_error, window, other, vertex, b, now)
        if place == vertex:
            break
        value += best - now
        source[size], target[size] = vertex, place
        size += 1
        vertex, other = b, place
    plan.counts[0], plan.counts[1] = up, size - up
    chain.seen_before[p], chain.seen_after[p] = up + 2, size - up + 2
    return value


@kernel
def _new_vertices(chain: Chain, p: int, plan: Plan, vertices: IntArray) -> int:
    """List the vertices of all segments that the deletion of p changes; return how many."""
    up, down = plan.counts[0], plan.counts[1]
    size = 0
    if up == 0:
        vertices[0], size = chain.before[p], 1
    else:
        vertices[0] = chain.before[plan.source[up - 1]]
        for k in range(up):
            vertices[k + 1] = plan.target[up - 1 - k]
        size = up + 1
    if down == 0:
        vertices[size] = chain.after[p]
        return int(size + 1)
    for k in range(down):
        vertices[size + k] = plan.target[up + k]
    vertices[size + down] = chain.after[plan.source[up + down - 1]]
    return int(size + down + 1)


@kernel
def _worst(curve: Curve, vertices: IntArray, size: int, rule: int) -> tuple[float, float]:
    """Return the largest deviation of some segments, and by how much one exceeds its bound."""
    x, y, hulls, count = curve.x, curve.y, curve.hulls, curve.size
    largest, excess = 0.0, -np.inf
    for k in range(size - 1):
        low = vertices[k]
        high = vertices[k + 1] if vertices[k + 1] > low else vertices[k + 1] + count
        value = _deviation(x, y, hulls, low, high, np.inf, -1)[0]
        largest = max(largest, value)
        if rule >= 0 and high - low > 1:
            dx, dy = x[high] - x[low], y[high] - y[low]
            excess = max(excess, value - deviation_bound_of(rule, dx, dy))
    return largest, excess


@kernel
def _rate(curve: Curve, chain: Chain, p: int, plan: Plan, vertices: IntArray) -> None:
    """Compute the AEV of a vertex: (2-57) with the sign of errata P7, or (2-60)."""
    value = _plan(curve, chain, p, plan)
    if not curve.by_error:
        value = _worst(curve, vertices, _new_vertices(chain, p, plan, vertices), -1)[0]
    put(chain.items, chain.place, chain.value, chain.size, p, value)


@kernel
def _delete(chain: Chain, p: int, plan: Plan) -> None:
    """Delete a vertex and move others as planned."""
    left, right = chain.before[p], chain.after[p]
    chain.after[left], chain.before[right] = right, left
    chain.alive[p] = False
    take_out(chain.items, chain.place, chain.value, chain.size, p)
    for k in range(plan.counts[0] + plan.counts[1]):
        v, q = plan.source[k], plan.target[k]
        a, b = chain.before[v], chain.after[v]
        chain.alive[v] = False
        take_out(chain.items, chain.place, chain.value, chain.size, v)
        chain.alive[q] = True
        chain.before[q], chain.after[q] = a, b
        chain.after[a], chain.before[b] = q, q


@kernel
def _rate_again(
    curve: Curve, chain: Chain, vertices: IntArray, size: int, farthest: IntArray,
    plan: Plan, scratch: IntArray
) -> None:  # fmt: skip
    """Rate every vertex whose value has seen one of those that changed."""
    last = curve.size - 1
    for k in range(size):
        v = vertices[k]
        if curve.closed or (v != 0 and v != last):
            _rate(curve, chain, v, plan, scratch)
            farthest[0] = max(farthest[0], max(chain.seen_before[v], chain.seen_after[v]))
    for side in range(2):
        v = vertices[0] if side == 0 else vertices[size - 1]
        for step in range(1, farthest[0] + 1):
            if not curve.closed and v == (0 if side == 0 else last):
                break
            v = chain.before[v] if side == 0 else chain.after[v]
            if not curve.closed and (v == 0 or v == last):
                break
            if (chain.seen_after[v] if side == 0 else chain.seen_before[v]) >= step:
                _rate(curve, chain, v, plan, scratch)
                farthest[0] = max(farthest[0], max(chain.seen_before[v], chain.seen_after[v]))


@kernel
def _chain_of(vertices: IntArray, count: int) -> Chain:
    chain = Chain(
        np.zeros(count, np.int64), np.zeros(count, np.int64), np.zeros(count, np.bool_),
        np.zeros(count, np.int64), np.zeros(count, np.int64),
        np.empty(count, np.int64), np.full(count, -1), np.zeros(count), np.zeros(1, np.int64),
    )  # fmt: skip
    for k in range(len(vertices)):
        a, b = vertices[k], vertices[k + 1 if k + 1 < len(vertices) else 0]
        chain.after[a], chain.before[b], chain.alive[a] = b, a, True
    return chain


@kernel
def masood_of(
    points: FloatArray, closed: bool, vertices: IntArray, rule: int, limit: float,
    refuse: bool, window: int, moves: int,
) -> IntArray:  # fmt: skip
    """Suppress break points one by one; rule -1: Masood's method with the limit d_tol.

    The method ends with the state that violates (2-58), or before the deletion that would (2-61);
    with `refuse` no segment ever violates its limit and the method ends when none can go.
    """
    left = len(vertices)
    if left <= 2:
        return vertices.copy()
    by_error = rule < 0
    curve = _curve_of(points, closed, by_error, window, moves)
    chain = _chain_of(vertices, curve.size)
    room = 2 * moves + 2
    plan = Plan(np.empty(room, np.int64), np.empty(room, np.int64), np.zeros(2, np.int64))
    changed, scratch = np.empty(room, np.int64), np.empty(room, np.int64)
    farthest = np.zeros(1, np.int64)
    inner = vertices if closed else vertices[1:-1]
    for k in range(len(inner)):
        _rate(curve, chain, inner[k], plan, scratch)
    farthest[0] = max(chain.seen_before.max(), chain.seen_after.max())
    while chain.size[0] > 0 and left > 2:
        p = chain.items[0]
        _plan(curve, chain, p, plan)
        size = _new_vertices(chain, p, plan, changed)
        largest, excess = _worst(curve, changed, size, rule)
        violates = largest * largest > limit if by_error else excess > 0.0
        if not by_error and not refuse:
            up, down = plan.counts[0], plan.counts[1]
            low = plan.target[0] if up > 0 else chain.before[p]
            high = plan.target[up] if down > 0 else chain.after[p]
            dx, dy = points[high, 0] - points[low, 0], points[high, 1] - points[low, 1]
            span = high - low if high > low else high - low + curve.size
            violates = span > 1 and largest > deviation_bound_of(rule, dx, dy)
        if violates and refuse:
            take_out(chain.items, chain.place, chain.value, chain.size, p)
            continue
        if violates and not by_error:
            break
        _delete(chain, p, plan)
        left -= 1
        if violates:
            break
        _rate_again(curve, chain, changed, size, farthest, plan, scratch)
    return np.flatnonzero(chain.alive)
