"""Kernels that link edge pixels by their gradient."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.edges._kernels_pixels import NONE, NX, NY, OX, OY

EXCESS_SHARE = 0.5
CHUNK = 1024  # pixels
DOUBLE_COSINE = 0.9
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


@kernel
def find_pairs(first: Any, last: Any, xs: Any, ys: Any, index: Any, table: Any, steps: Any,
               least: Any, pairs: Any) -> Any:  # fmt: skip
    """Write from, to of the near pixels with alike gradients; return how many they are.

    They follow the pixels from `first` until `last`, in raster order. Every step is written and
    kept or not: whether there is a pixel is a coin toss, which a branch loses.
    """
    stride = index.shape[1]
    flat = index.ravel()
    hops = steps[:, 1] * stride + steps[:, 0]
    source, target = pairs[0], pairs[1]
    near = np.uint64(0)
    for k in range(first, last):
        place = np.int64(ys[k]) * stride + xs[k]
        for s in range(len(hops)):
            m = flat[np.uint64(place + hops[s])]
            source[near] = k
            target[near] = m
            near += np.uint64(m != NONE)
    alike = np.uint64(0)
    for c in range(near):
        k, m = source[c], target[c]
        source[alike] = k
        target[alike] = m
        cosine = table[k, NX] * table[m, NX] + table[k, NY] * table[m, NY]
        alike += np.uint64(cosine >= least)
    return np.int64(alike)


@inner_kernel
def measure_pairs(pairs: Any, found: Any, xs: Any, ys: Any, table: Any, rows: Any) -> None:
    """Write of each pair how far it leads along and across the edge, squared way, cosine.

    The way is that from edge to edge. No branches: vector instructions.
    """
    source, target = pairs[0], pairs[1]
    alongs, acrosses, ways, cosines = rows[0], rows[1], rows[2], rows[3]
    for c in range(found):
        k, m = source[c], target[c]
        nx, ny = table[k, NX], table[k, NY]
        mx, my = table[m, NX], table[m, NY]
        cosine = nx * mx + ny * my
        ex = xs[m] - xs[k] + table[m, OX] - table[k, OX]
        ey = ys[m] - ys[k] + table[m, OY] - table[k, OY]
        scale = 1.0 / math.sqrt(2.0 + 2.0 * cosine)
        alongs[c] = (ex * (ny + my) - ey * (nx + mx)) * scale
        acrosses[c] = abs(ex * (nx + mx) + ey * (ny + my)) * scale
        ways[c] = ex * ex + ey * ey
        cosines[c] = cosine


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
    rows = np.empty((4, CHUNK * len(steps)))
    double = np.zeros(count, np.bool_)
    source = np.empty(2 * count + pairs.shape[1], np.uint32)
    target = np.empty(2 * count + pairs.shape[1], np.uint32)
    cost = np.empty(2 * count + pairs.shape[1], np.float32)
    cosines = np.empty(2 * count + pairs.shape[1], np.float32)
    size = np.uint64(0)
    for start in range(0, count, CHUNK):  # so few that they stay in the cache
        end = min(start + CHUNK, count)
        least = min(turn_cosine, DOUBLE_COSINE)
        found = find_pairs(start, end, xs, ys, index, table, steps, least, pairs)
        if np.int64(size) + found >= len(source):
            more = len(source) // 2 + found
            source = np.concatenate((source, np.empty(more, np.uint32)))
            target = np.concatenate((target, np.empty(more, np.uint32)))
            cost = np.concatenate((cost, np.empty(more, np.float32)))
            cosines = np.concatenate((cosines, np.empty(more, np.float32)))
        measure_pairs(pairs, found, xs, ys, table, rows)
        for c in range(found):
            k, m = pairs[0, c], pairs[1, c]
            along, across, cosine = rows[0, c], rows[1, c], np.float32(rows[3, c])
            if (rows[2, c] <= 0.16) & (cosine >= DOUBLE_COSINE):
                if not (double[k] or double[m]):
                    i, j = xs[m] - xs[k], ys[m] - ys[k]
                    double[the_double(table, k, m, i, j)] = True
            source[size] = k if along > 0.0 else m
            target[size] = m if along > 0.0 else k
            cost[size] = abs(along) + across + 4.0 * (1.0 - cosine)
            cosines[size] = cosine
            fits = (cosine >= turn_cosine) & (across <= slant * abs(along)) & (abs(along) >= 0.3)
            size += np.uint64(fits)
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
    best_after = np.full(count, len(source), np.uint32)  # best open step from a pixel
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
            for p in waiting[:size]:
                first, second = source[p], target[p]
                both = (best_after[first] == p) & (best_before[second] == p)
                after[first] = second if both else after[first]
                before[second] = first if both else before[second]
            kept = np.uint64(0)
            for p in waiting[:size]:
                first, second = source[p], target[p]
                best_after[first] = len(source)
                best_before[second] = len(source)
                waiting[kept] = p
                free = (after[first] == UNLINKED) & (before[second] == UNLINKED)
                kept += np.uint64(free)
            size = kept
    return before, after


@inner_kernel
def bend(angle: Any, k: Any, m: Any) -> Any:
    """Return the signed angle from one gradient to another."""
    turn = np.float64(angle[m]) - np.float64(angle[k])
    turn = turn - 2.0 * math.pi if turn > math.pi else turn
    return turn + 2.0 * math.pi if turn < -math.pi else turn


@kernel
def cut_corners(angle: Any, before: Any, after: Any, max_turn: Any) -> None:
    """Undo, in place, links that turn by over `max_turn` where the contour around them does not.

    A link stays where the mean turn of the three links before and the three after it comes
    within half of `max_turn` of its own: a small circle, but not a corner or a crossing.
    """
    cut = np.empty(len(after), np.uint32)
    size = np.uint64(0)
    for k in range(len(after)):
        here, m = np.uint32(k), after[k]
        turn = bend(angle, here, m if m < APART else here)
        if abs(turn) <= max_turn:
            continue
        behind = ahead = 0.0  # apart: the sum is then the same whichever way a contour runs
        first, last = here, m
        for _ in range(3):
            if before[first] < APART:
                behind += bend(angle, before[first], first)
                first = before[first]
            if after[last] < APART:
                ahead += bend(angle, last, after[last])
                last = after[last]
        expected = (behind + ahead) / 6.0
        cut[size] = k
        size += np.uint64(abs(turn - expected) > EXCESS_SHARE * max_turn)
    for k in cut[:size]:  # not before all are judged: a cut link would change what is around
        before[after[k]] = UNLINKED
        after[k] = UNLINKED
