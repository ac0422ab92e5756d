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
    curve_of,
    error_between,
    largest_deviation,
    place_of_least_deviation,
    place_of_least_error,
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
    found: FloatArray  # with it: the change of the squared error, or both segments' deviations


class Plan(NamedTuple):
    """What the deletion of a vertex does: moves (vertex, new index), `counts` up and down."""

    source: IntArray
    target: IntArray
    counts: IntArray


@kernel
def _change(curve: Curve, a: int, v: int, b: int) -> float:
    """Return by how much the squared error grows when v goes from between a and b."""
    x, y, sums, count = curve.x, curve.y, curve.sums, curve.size
    parts = error_between(x, y, sums, count, a, v) + error_between(x, y, sums, count, v, b)
    return error_between(x, y, sums, count, a, b) - parts


@kernel
def _rate(curve: Curve, chain: Chain, wanted: IntArray, number: int, plan: Plan) -> None:
    """Work out the deletion of some vertices with all moves; `plan` is that of the last one.

    The AEV is the squared error after less before, (2-57) with the sign of errata P7, or the
    largest deviation of the segments that change (2-60). Only neighbours that gain by it move; the
    first that does not, ends the moves of its side. What a move asks, and the answer, is kept: a
    deletion changes few of the neighbourhoods that later plans ask for again.
    """
    # One loop, and all taken out once: at every call, and each time that a named tuple hands an
    # array out, numba counts it, which took most of the time.
    x, y, sums, hulls = curve.x, curve.y, curve.sums, curve.hulls
    count, by_error, moves, window = curve.size, curve.by_error, curve.moves, curve.window
    known, found = chain.known, chain.found
    before, after, source, target = chain.before, chain.after, plan.source, plan.target
    for p in wanted[:number]:
        left, right = before[p], after[p]
        value = _change(curve, left, p, right) if by_error else 0.0
        central, size = -1.0, 0  # deviation of the segment on which p was
        for side in range(2):
            begin, outer = size, 0.0
            vertex, other = (left, right) if side == 0 else (right, target[0] if size > 0 else left)
            fixed, end = (right, 0) if side == 0 else (left, count - 1)
            while size - begin < moves and vertex != fixed and (curve.closed or vertex != end):
                beyond = before[vertex] if side == 0 else after[vertex]
                taken = False  # by the moves of the other side, in a small polygon
                for k in range(begin):
                    taken = taken or source[k] == vertex or source[k] == beyond
                if taken:
                    break
                a, b = (beyond, other) if side == 0 else (other, beyond)
                at = 2 * REMEMBERED * p + side * REMEMBERED + min(size - begin, REMEMBERED - 1)
                if known[at, 0] != a or known[at, 1] != vertex or known[at, 2] != b:
                    middle = vertex if vertex > a else vertex + count  # of the curve written twice
                    last = b if b > a else b + count
                    if by_error:
                        place, found[at, 0] = place_of_least_error(
                            x, y, sums, count, window, a, middle, last
                        )
                    else:
                        place, found[at, 0], found[at, 1] = place_of_least_deviation(
                            x, y, hulls, window, a, middle, last
                        )
                    known[at, 0], known[at, 1], known[at, 2] = a, vertex, b
                    known[at, 3] = place if place < count else place - count
                place = known[at, 3]
                inner = found[at, 1 - side]
                if size == begin:
                    central = inner
                if place == vertex:
                    break
                if by_error:
                    value += found[at, 0]
                else:
                    value, outer = max(value, inner if size > begin else 0.0), found[at, side]
                source[size], target[size] = vertex, place
                size += 1
                vertex, other = beyond, place
            if not by_error:
                value = max(value, outer)
            plan.counts[side] = size - begin
        chain.seen_before[p], chain.seen_after[p] = plan.counts[0] + 2, plan.counts[1] + 2
        if not by_error:
            if central < 0.0:  # no neighbour may move
                last = right if right > left else right + count
                central = largest_deviation(x, y, hulls, left, last)
            value = max(value, central)
        put(chain.items, chain.place, chain.value, chain.size, p, value)


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
        value = largest_deviation(x, y, hulls, low, high)
        largest = max(largest, value)
        if rule >= 0 and high - low > 1:
            dx, dy = x[high] - x[low], y[high] - y[low]
            excess = max(excess, value - deviation_bound_of(rule, dx, dy))
    return largest, excess


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
def _touched(curve: Curve, chain: Chain, changed: IntArray, size: int, touched: IntArray) -> int:
    """List every vertex whose value has seen one of those that changed; return how many."""
    before, after = chain.before, chain.after
    last, number = curve.size - 1, 0
    for k in range(size):
        v = changed[k]
        if curve.closed or (v != 0 and v != last):
            touched[number] = v
            number += 1
    for side in range(2):
        v = changed[0] if side == 0 else changed[size - 1]
        for step in range(1, curve.moves + 3):
            if not curve.closed and v == (0 if side == 0 else last):
                break
            v = before[v] if side == 0 else after[v]
            if not curve.closed and (v == 0 or v == last):
                break
            if (chain.seen_after[v] if side == 0 else chain.seen_before[v]) >= step:
                touched[number] = v
                number += 1
    return number


@kernel
def _chain_of(vertices: IntArray, count: int) -> Chain:
    chain = Chain(
        np.zeros(count, np.int64), np.zeros(count, np.int64), np.zeros(count, np.bool_),
        np.zeros(count, np.int64), np.zeros(count, np.int64),
        np.empty(count, np.int64), np.full(count, -1), np.zeros(count), np.zeros(1, np.int64),
        np.full((2 * REMEMBERED * count, 4), -1), np.empty((2 * REMEMBERED * count, 2)),
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
    changed, touched = np.empty(room, np.int64), np.empty(2 * room + 4, np.int64)
    inner = (vertices if closed else vertices[1:-1]).copy()
    _rate(curve, chain, inner, len(inner), plan)
    while chain.size[0] > 0 and left > 2:
        p = chain.items[0]
        _rate(curve, chain, chain.items, 1, plan)
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
        _rate(curve, chain, touched, _touched(curve, chain, changed, size, touched), plan)
    return np.flatnonzero(chain.alive)
