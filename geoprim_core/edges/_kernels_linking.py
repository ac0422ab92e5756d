"""Kernels that link edge pixels by their gradient."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.edges._kernels_pixels import NONE, NX, NY, OX, OY

EXCESS_SHARE = 0.5  # of the largest turn, that a link may differ by from what is around it
LEAST_STEP = 0.3  # pixels along the edge
TURN_COST = 4.0  # pixels that a step costs for one less cosine
SAME_SQUARE = 0.16  # square pixels between the edge points of two pixels that are one
CHUNK = 256  # pixels
FITS, ONWARDS, TWIN = 1, 2, 4  # what is known of a pair, or-ed
DOUBLE_COSINE = 0.9  # and their gradients
APART, UNLINKED = NONE - 1, NONE  # takes no part; no neighbour yet


@kernel
def forward_steps(reach: Any) -> Any:
    """Return the steps i, j (S, 2) that lead onwards in raster order by at most `reach`."""
    steps = np.empty((12, 2), np.int64)
    size = 0
    for j in range(3):
        for i in range(-2 if j else 1, 3):
            if i * i + j * j <= reach * reach:
                steps[size, 0], steps[size, 1] = i, j
                size += 1
    return steps[:size]


@inner_kernel
def find_pairs(
    first: Any, last: Any, xs: Any, ys: Any, flat: Any, stride: Any, table: Any, hops: Any,
    least: Any, pairs: Any, rows: Any,
) -> Any:  # fmt: skip
    """Write from, to of the near pixels with alike gradients; return how many they are.

    They follow the pixels from `first` until `last`, in raster order. Every step is written and
    kept or not: whether there is a pixel is a coin toss, which a branch loses. The `rows` (5, n)
    are the way from edge to edge, the sum of the unit gradients and their cosine.
    """
    source, target = pairs[0], pairs[1]
    near = np.uint64(0)
    for k in range(first, last):
        place = np.int64(ys[k]) * stride + xs[k]
        for s in range(len(hops)):
            m = flat[np.uint64(place + hops[s])]
            source[near] = k
            target[near] = m
            near += np.uint64(m != NONE)
    ways_x, ways_y, sums_x, sums_y, cosines = rows[0], rows[1], rows[2], rows[3], rows[4]
    alike = np.uint64(0)
    for c in range(near):
        k, m = source[c], target[c]
        source[alike] = k
        target[alike] = m
        nx, ny = table[k, NX], table[k, NY]
        mx, my = table[m, NX], table[m, NY]
        ways_x[alike] = np.float32(xs[m] - xs[k]) + (table[m, OX] - table[k, OX])
        ways_y[alike] = np.float32(ys[m] - ys[k]) + (table[m, OY] - table[k, OY])
        sums_x[alike] = nx + mx
        sums_y[alike] = ny + my
        cosine = nx * mx + ny * my
        cosines[alike] = cosine
        alike += np.uint64(cosine >= least)
    return np.int64(alike)


@inner_kernel
def judge_pairs(rows: Any, turn_cosine: Any, slant: Any, costs: Any, states: Any) -> None:
    """Write what each pair costs as a step, and whether it `FITS`, leads `ONWARDS`, is a `TWIN`.

    No branches: vector instructions.
    """
    ways_x, ways_y, sums_x, sums_y, cosines = rows[0], rows[1], rows[2], rows[3], rows[4]
    for c in range(len(states)):
        cosine = np.float64(cosines[c])
        ex, ey = np.float64(ways_x[c]), np.float64(ways_y[c])
        sx, sy = np.float64(sums_x[c]), np.float64(sums_y[c])
        scale = 1.0 / math.sqrt(2.0 + 2.0 * cosine)
        along = (ex * sy - ey * sx) * scale
        across = abs(ex * sx + ey * sy) * scale
        length = abs(along)
        costs[c] = length + across + TURN_COST * (1.0 - cosine)
        fits = (cosine >= turn_cosine) & (across <= slant * length) & (length >= LEAST_STEP)
        twin = (ex * ex + ey * ey <= SAME_SQUARE) & (cosine >= DOUBLE_COSINE)
        state = FITS if fits else 0
        state |= ONWARDS if along > 0.0 else 0
        states[c] = state | (TWIN if twin else 0)


@inner_kernel
def the_double(table: Any, k: Any, m: Any, i: Any, j: Any) -> Any:
    """Return which of two pixels that mark the same edge point lies farther from it."""
    far_k = table[k, OX] * table[k, OX] + table[k, OY] * table[k, OY]
    far_m = table[m, OX] * table[m, OX] + table[m, OY] * table[m, OY]
    # In a tie the pixel on the brighter side stays, as in the suppression.
    tie = far_m == far_k and i * table[k, NX] + j * table[k, NY] > 0.0
    return k if far_m < far_k or tie else m


@kernel
def find_steps(
    xs: Any, ys: Any, index: Any, table: Any, turn_cosine: Any, reach: Any, slant: Any
) -> Any:
    """Return the steps that a contour may take, and which pixels are doubles.

    They are: from, to (M,) uint32, cost (M + 1,), cosine (M,) float32; double (N,) bool. The last
    cost is infinite, that of no step. A step leads along the edge, with the brighter side on the
    right hand as seen on the screen, to a pixel within `reach` whose gradient has at least the
    cosine `turn_cosine` with its own. It goes across the edge by at most `slant` times what it
    goes along. A double is one of two pixels that mark the same edge point: they lie side by side
    across the edge with like gradients; the one nearer to the edge stays.
    """
    count = len(xs)
    steps = forward_steps(reach)
    pairs = np.empty((2, CHUNK * len(steps) + 1), np.uint32)
    rows = np.empty((5, CHUNK * len(steps) + 1), np.float32)
    costs = np.empty(CHUNK * len(steps), np.float32)
    states = np.empty(CHUNK * len(steps), np.uint8)
    flat, stride = index.ravel(), index.shape[1]
    hops = steps[:, 1] * stride + steps[:, 0]
    double = np.zeros(count, np.bool_)
    source = np.empty(2 * count + pairs.shape[1], np.uint32)
    target = np.empty(2 * count + pairs.shape[1], np.uint32)
    cost = np.empty(2 * count + pairs.shape[1], np.float32)
    cosines = np.empty(2 * count + pairs.shape[1], np.float32)
    size = np.uint64(0)
    for start in range(0, count, CHUNK):  # so few that they stay in the cache
        end = min(start + CHUNK, count)
        least = min(turn_cosine, DOUBLE_COSINE)
        found = find_pairs(start, end, xs, ys, flat, stride, table, hops, least, pairs, rows)
        if np.int64(size) + found >= len(source):
            more = len(source) // 2 + found
            source = np.concatenate((source, np.empty(more, np.uint32)))
            target = np.concatenate((target, np.empty(more, np.uint32)))
            cost = np.concatenate((cost, np.empty(more, np.float32)))
            cosines = np.concatenate((cosines, np.empty(more, np.float32)))
        judge_pairs(rows, turn_cosine, slant, costs[:found], states[:found])
        for c in range(found):
            k, m, state = pairs[0, c], pairs[1, c], states[c]
            if state & TWIN and not (double[k] or double[m]):
                i, j = xs[m] - xs[k], ys[m] - ys[k]
                double[the_double(table, k, m, i, j)] = True
            onwards = state & ONWARDS != 0
            source[size] = k if onwards else m
            target[size] = m if onwards else k
            cost[size] = costs[c]
            cosines[size] = rows[4, c]
            size += np.uint64(state & FITS)
    cost[size] = np.inf  # of no step
    return source[:size], target[:size], cost[: size + np.uint64(1)], cosines[:size], double


@kernel
def chain(source: Any, target: Any, cost: Any, cosine: Any, double: Any, limits: Any) -> Any:
    """Return the pixel before and after each edge pixel on its contour, `APART` or above for none.

    Of the steps that are still open the cheapest is taken first: in rounds, those that are the
    best one both for the pixel they leave and for the one they reach. First those with at least
    the first cosine of `limits`, then those with the next.
    """
    count = len(double)
    before = np.empty(count, np.uint32)
    for k in range(count):
        before[k] = APART if double[k] else UNLINKED
    after = before.copy()
    none = np.uint32(len(source))
    best_after = np.full(count, none, np.uint32)  # best open step from a pixel
    best_before = best_after.copy()
    waiting = np.empty(len(source), np.uint32)
    for limit in limits:
        size = np.uint64(0)
        for p in range(len(source)):
            waiting[size] = p
            free = (after[source[p]] == UNLINKED) & (before[target[p]] == UNLINKED)
            size += np.uint64(free & (cosine[p] >= np.float32(limit)))
        while size > 0:
            for p in waiting[:size]:
                first, second = source[p], target[p]
                best = best_after[first]
                best_after[first] = p if cost[p] < cost[best] else best
                best = best_before[second]
                best_before[second] = p if cost[p] < cost[best] else best
            if size > count // 2:  # the first round: there are fewer pixels than steps
                for k in range(count):
                    p = best_after[k]
                    second = target[p if p < none else 0]
                    both = (p < none) & (best_before[second] == p)
                    after[k] = second if both else after[k]
                    place = second if both else k
                    before[place] = k if both else before[place]
            else:
                for p in waiting[:size]:
                    first, second = source[p], target[p]
                    both = (best_after[first] == p) & (best_before[second] == p)
                    after[first] = second if both else after[first]
                    before[second] = first if both else before[second]
            kept = np.uint64(0)
            for p in waiting[:size]:
                first, second = source[p], target[p]
                best_after[first] = none
                best_before[second] = none
                waiting[kept] = p
                free = (after[first] == UNLINKED) & (before[second] == UNLINKED)
                kept += np.uint64(free)
            size = kept
    return before, after


@inner_kernel
def bend(first: Any, second: Any) -> Any:
    """Return the signed angle from one direction to another."""
    turn = np.float64(second) - np.float64(first)
    turn = turn - 2.0 * math.pi if turn > math.pi else turn
    return turn + 2.0 * math.pi if turn < -math.pi else turn


@kernel
def sharp_links(angle: Any, after: Any, max_turn: Any, sharp: Any) -> Any:
    """Write the pixels whose link to the next turns by over `max_turn`; return how many they are.

    Three loops: that with the arithmetic has neither branches nor places to look up, so it
    compiles to vector instructions.
    """
    ahead = np.empty(len(after), np.float32)
    turns = np.empty(len(after), np.uint8)
    for k in range(len(after)):
        m = after[k]
        ahead[k] = angle[m if m < APART else np.uint32(k)]
    for k in range(len(after)):
        turns[k] = abs(bend(angle[k], ahead[k])) > max_turn
    size = np.uint64(0)
    for k in range(len(after)):
        sharp[size] = k
        size += np.uint64(turns[k])
    return np.int64(size)


@kernel
def cut_corners(angle: Any, before: Any, after: Any, max_turn: Any, strong: Any, jerk: Any) -> None:
    """Undo, in place, links that turn by over `max_turn` where the contour around them does not.

    A link stays where the mean turn of the three links before and the three after it comes
    within half of `max_turn` of its own: a small circle, but not a corner or a crossing. Between
    `strong` pixels it may differ by a share `jerk` of that mean turn more.
    """
    sharp = np.empty(len(after), np.uint32)
    sharps = sharp_links(angle, after, max_turn, sharp)
    cut = np.empty(sharps, np.uint32)
    size = np.uint64(0)
    for here in sharp[:sharps]:
        m = after[here]
        turn = bend(angle[here], angle[m])
        behind = ahead = 0.0  # apart: the sum is then the same whichever way a contour runs
        first, last = here, m
        for _ in range(3):
            if before[first] < APART:
                behind += bend(angle[before[first]], angle[first])
                first = before[first]
            if after[last] < APART:
                ahead += bend(angle[last], angle[after[last]])
                last = after[last]
        expected = (behind + ahead) / 6.0
        excess = EXCESS_SHARE * max_turn
        if jerk > 0.0:
            excess += jerk * abs(expected) if strong[here] & strong[m] else 0.0
        cut[size] = here
        size += np.uint64(abs(turn - expected) > excess)
    for k in cut[:size]:  # not before all are judged: a cut link would change what is around
        before[after[k]] = UNLINKED
        after[k] = UNLINKED
