"""Kernels of Masood's method and of its non-parametric form, thesis 2.5.2 and errata P7.

The polygon is a doubly linked list of curve indices; costs and moves stand in `_kernels_moves`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.polygon._kernels import deviation_bound_of
from geoprim_core.polygon._kernels_heap import put, take_out
from geoprim_core.polygon._kernels_moves import (
    Curve,
    best_place,
    cost_of,
    curve_of,
    joined_cost,
    largest_deviation,
)

REMEMBERED = 4  # moves of either side whose answers are kept; the others share the last place


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
    known: IntArray  # of each vertex and move: the neighbours and vertex last asked for, the answer
    gain: FloatArray


class Plan(NamedTuple):
    """What the deletion of a vertex does: moves (vertex, new index), `counts` up and down."""

    source: IntArray
    target: IntArray
    counts: IntArray


@kernel
def _move(
    curve: Curve, known: IntArray, gain: FloatArray, slot: int, a: int, v: int, b: int
) -> tuple[int, float]:
    """Return the best place of v between a and b and the change of cost; remember the answer.

    A deletion changes few of the neighbourhoods that later plans ask for again.
    """
    if known[slot, 0] == a and known[slot, 1] == v and known[slot, 2] == b:
        return known[slot, 3], gain[slot]
    # Taken out once: a named tuple counts its arrays each time that it hands one out.
    x, y, sums, hulls = curve.x, curve.y, curve.sums, curve.hulls
    count, by_error, window = curve.size, curve.by_error, curve.window
    now = joined_cost(x, y, sums, hulls, count, by_error, a, v, b)
    place, best = best_place(x, y, sums, hulls, count, by_error, window, a, v, b, now)
    known[slot, 0], known[slot, 1], known[slot, 2], known[slot, 3] = a, v, b, place
    gain[slot] = best - now
    return place, best - now


@kernel
def _plan(curve: Curve, chain: Chain, p: int, plan: Plan) -> float:
    """Work out the deletion of p with all moves; return the squared error after less before.

    Only neighbours that gain by it move; the first that does not, ends the moves of its side.
    """
    x, y, sums, hulls = curve.x, curve.y, curve.sums, curve.hulls
    count, by_error, moves = curve.size, curve.by_error, curve.moves
    before, after, source, target = chain.before, chain.after, plan.source, plan.target
    known, gain = chain.known, chain.gain
    left, right, slot = before[p], after[p], 2 * REMEMBERED * p
    value = 0.0
    if by_error:
        value = cost_of(x, y, sums, hulls, count, by_error, left, right) - joined_cost(
            x, y, sums, hulls, count, by_error, left, p, right
        )
    size = 0
    vertex, other = left, right
    while size < moves and vertex != right and (curve.closed or vertex != 0):
        a = before[vertex]
        at = slot + min(size, REMEMBERED - 1)
        place, change = _move(curve, known, gain, at, a, vertex, other)
        if place == vertex:
            break
        value += change
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
        at = slot + REMEMBERED + min(size - up, REMEMBERED - 1)
        place, change = _move(curve, known, gain, at, other, vertex, b)
        if place == vertex:
            break
        value += change
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
        value = largest_deviation(x, y, hulls, low, high, np.inf, -1)[0]
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
        np.full((2 * REMEMBERED * count, 4), -1), np.empty(2 * REMEMBERED * count),
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
    curve = curve_of(points, closed, by_error, window, moves)
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
