"""Kernels of the `refined` scheme: candidates verified against all edge points of the image."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.ecc._kernels_refined_ends import continuing_share, unexplained_share
from geoprim_core.ecc._kernels_refined_fit import (
    add_point,
    fit_moments,
    offset_of,
    refit,
    refit_robustly,
)
from geoprim_core.ecc._kernels_refined_support import (
    COVERED,
    CROSSING,
    IN_FRAME,
    SQUARES,
    STEPS,
    SUMS,
    TURN,
    TURN_COVERED,
    Int32Array,
    arcs_of_points,
    collect,
    doubt_of_clutter,
    doubt_of_ends,
    hopeless,
    probe,
    support_evidence,
    unpromising,
)
from geoprim_core.fitting._kernels_shape import perimeter_of

SPREAD = 12.0  # times the median distance: 8 standard deviations
LEAST_REACH = 0.7  # pixels
POLISHES = 2
FIT_STEPS = 72.0  # as many places on the outline serve a fit
LEAST_POINTS = 10
FIGURES = 8
SLOTS = 8  # verified ellipses remembered for each arc
REFITS = (1.0, 0.8, 1.0)  # reach of the three collections of support, in shares of the limit
HOPE = (6.0, 2.0)  # evidence that the first and the second refit may still add
OWNED = 0.7  # an arc belongs to an ellipse that this share of its points support


# Entries of the array of limits that `improve` and `verify` take.
REACH, GROWTH, MIN_COSINE, MIN_COVERAGE, MIN_IN_FRAME, MAX_SIZE, MIN_SEMI, ENDS = range(8)


@kernel
def fit_chosen(
    points: FloatArray, chosen: IntArray, count: int, ellipse: FloatArray, work: FloatArray
) -> bool:
    """Replace an ellipse by the direct fit to some points; False (unchanged) if there is none."""
    work[:] = 0.0
    scale = 1.0 / ellipse[2]
    for k in range(count):
        x = (points[chosen[k], 0] - ellipse[0]) * scale
        y = (points[chosen[k], 1] - ellipse[1]) * scale
        add_point(work, x, y)
    out = np.empty(5)
    if not fit_moments(work, ellipse[0], ellipse[1], scale, out):
        return False
    ellipse[:] = out
    return True


@kernel
def reach_of(
    points: FloatArray, chosen: IntArray, count: int, ellipse: FloatArray, most: float
) -> float:
    """Return how far support may lie: several times the typical distance, at most `most`.

    Clean edges lie within a fraction of a pixel; what lies further is then not of this outline.
    """
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    distances = np.empty(count)
    for k in range(count):
        d, _, _ = offset_of(ellipse, cos, sin, points[chosen[k], 0], points[chosen[k], 1])
        distances[k] = abs(d)
    return min(most, max(LEAST_REACH, SPREAD * np.median(distances)))


@kernel
def near_copy(ellipses: FloatArray, count: int, ellipse: FloatArray) -> bool:
    """Tell whether an ellipse is within a pixel of one of the first `count`."""
    for k in range(count):
        other = ellipses[k]
        if abs(other[0] - ellipse[0]) > 1.0 or abs(other[1] - ellipse[1]) > 1.0:
            continue
        if abs(other[2] - ellipse[2]) > 1.0 or abs(other[3] - ellipse[3]) > 1.0:
            continue
        turn = abs(other[4] - ellipse[4])
        turn = min(turn, math.pi - turn)
        if turn * (ellipse[2] - ellipse[3]) < 1.0:
            return True
    return False


@kernel
def improve(
    head: Int32Array,
    following: Int32Array,
    points: FloatArray,
    normals: FloatArray,
    ellipse: FloatArray,
    limits: FloatArray,
    hope: float,
    polarity: int,
    known: FloatArray,
    found: int,
    stamp: IntArray,
    mark: int,
    chosen: IntArray,
    sums: FloatArray,
    work: FloatArray,
) -> int:
    """Collect support and refit, twice, then collect again; return the points, 0 for a failure.

    The first refit is direct, the second robust and orthogonal. The ellipse is changed in place;
    it fails too when it has become a copy of one of the `found` known ones, or when its evidence
    stays far below `hope`.
    """
    count = 0
    for step in range(3):
        growth = 1.0 + limits[GROWTH] * ellipse[3]
        reach = limits[REACH] * REFITS[step] * growth
        if step > 0:
            reach = reach_of(points, chosen, count, ellipse, reach)
        stride = 2.0
        if step < 2:
            stride = max(2.0, perimeter_of(ellipse[2], ellipse[3]) / FIT_STEPS)
        count = collect(
            head,
            following,
            points,
            normals,
            ellipse,
            stride,
            reach,
            limits[MIN_COSINE],
            polarity,
            stamp,
            mark + step,
            chosen,
            sums,
        )
        least = limits[MIN_COVERAGE] * (1.0 if step == 2 else 0.7)
        if count < LEAST_POINTS or sums[COVERED] < least * sums[IN_FRAME]:
            return 0
        if sums[IN_FRAME] < limits[MIN_IN_FRAME] * sums[STEPS]:
            return 0
        if step < 2 and hopeless(sums, count, stride, ellipse, growth, hope - HOPE[step]):
            return 0
        good = True
        if step == 0:
            good = fit_chosen(points, chosen, count, ellipse, work)
        elif step == 1:
            good = refit(points, chosen, count, ellipse, 2, 3.0 * reach)
            good = good and not near_copy(known, found, ellipse)
        if not good or ellipse[3] < limits[MIN_SEMI] or ellipse[2] > limits[MAX_SIZE]:
            return 0
    return count


@kernel
def polish_support(
    head: Int32Array,
    following: Int32Array,
    points: FloatArray,
    normals: FloatArray,
    ellipse: FloatArray,
    limits: FloatArray,
    polarity: int,
    stamp: IntArray,
    mark: int,
    chosen: IntArray,
    count: int,
    sums: FloatArray,
) -> int:
    """Refit an ellipse robustly and collect its support again; return the number of points."""
    for step in range(POLISHES):
        refit_robustly(points, chosen[:count], ellipse, limits[MAX_SIZE])
        most = limits[REACH] * (1.0 + limits[GROWTH] * ellipse[3])
        count = collect(
            head,
            following,
            points,
            normals,
            ellipse,
            2.0,
            reach_of(points, chosen, count, ellipse, most),
            limits[MIN_COSINE],
            polarity,
            stamp,
            mark + step,
            chosen,
            sums,
        )
        if count < LEAST_POINTS:
            break
    return count


@kernel
def share_owner(owners: IntArray, owned: IntArray, i: int, j: int) -> bool:
    """Tell whether two arcs (or one, j < 0) already belong to one verified ellipse."""
    if j < 0:
        return bool(owned[i] > 0)
    for k in range(min(SLOTS, owned[i])):
        for m in range(min(SLOTS, owned[j])):
            if owners[i, k] == owners[j, m]:
                return True
    return False


@kernel
def note_owner(
    chosen: IntArray,
    count: int,
    arc_of: IntArray,
    ends: IntArray,
    tally: IntArray,
    owners: IntArray,
    owned: IntArray,
    taken: IntArray,
    ellipse: int,
    strong: bool,
) -> None:
    """Note for each arc that supports an ellipse with most of its points that it belongs to it."""
    for k in range(count):
        if arc_of[chosen[k]] >= 0:
            tally[arc_of[chosen[k]]] += 1
    for k in range(count):
        arc = arc_of[chosen[k]]
        if arc >= 0 and tally[arc] > 0:
            if tally[arc] > OWNED * (ends[arc + 1] - ends[arc]):
                owners[arc, owned[arc] % SLOTS] = ellipse
                owned[arc] += 1
                if strong:
                    taken[arc] = 1
            tally[arc] = 0


@kernel
def describe(
    head: Int32Array,
    following: Int32Array,
    normals: FloatArray,
    contour: IntArray,
    ellipse: FloatArray,
    sums: FloatArray,
    chosen: IntArray,
    count: int,
    stamp: IntArray,
    mark: int,
    limits: FloatArray,
    row: FloatArray,
) -> float:
    """Write the figures of an ellipse (see `verify`); return its evidence but for clutter."""
    row[1] = sums[COVERED] / sums[IN_FRAME]
    row[2] = sums[TURN_COVERED] / sums[TURN]
    row[3] = math.sqrt(sums[SQUARES] / count)
    row[4] = sums[CROSSING] / count
    row[5] = 2.0 * sums[COVERED]
    row[6] = row[7] = 0.0
    share = min(row[1], row[2])
    growth = 1.0 + limits[GROWTH] * ellipse[3]
    evidence = support_evidence(sums, count, row[5], ellipse, growth)
    if limits[ENDS] > 0.0:
        row[6] = continuing_share(contour, stamp, mark, chosen, count)
        row[7] = unexplained_share(head, following, normals, ellipse, stamp, mark)
        evidence -= limits[ENDS] * doubt_of_ends(share, row[6], row[7])
    row[0] = evidence - doubt_of_clutter(share, row[4])
    return float(evidence)


@kernel
def verify(
    head: Int32Array,
    following: Int32Array,
    points: FloatArray,
    normals: FloatArray,
    order: IntArray,
    ends: IntArray,
    contour: IntArray,
    table: FloatArray,
    arcs: IntArray,
    candidates: FloatArray,
    limits: FloatArray,
    signed: bool,
    sure: float,
    polish: float,
    max_tries: int,
    max_count: int,
) -> tuple[FloatArray, FloatArray, IntArray, IntArray, IntArray, int]:
    """Verify candidates in the given order against all edge points.

    Returns the ellipses that pass; their figures: evidence, coverage, share of the turn covered,
    rms, crossing points per supporting one, length in pixels, shares of the ends at which a
    contour goes on and at which nothing explains a gap; offsets and indices of their supporting
    points; the candidate each came from; and the number of candidates looked at
    closely. An ellipse with evidence `polish` is refitted once more, robustly; one with evidence
    `sure` and half its outline covered takes its arcs. Two arcs that both failed `max_tries` times
    are left alone.
    """
    total = len(points)
    room = min(len(arcs), max_count)
    ellipses = np.empty((room, 5))
    figures = np.empty((room, FIGURES))
    sources = np.empty(room, np.int64)
    offsets = np.zeros(room + 1, np.int64)
    support = np.empty(4 * total + 1, np.int64)
    arc_of = arcs_of_points(order, ends, total)
    owners = np.empty((len(ends), SLOTS), np.int64)
    counts = np.zeros((4, len(ends)), np.int64)
    owned, taken, tally, tries = counts[0], counts[1], counts[2], counts[3]
    stamp = np.zeros(total, np.int64)
    chosen = np.empty(total, np.int64)
    work = np.empty(25)
    sums = np.empty(SUMS)
    ellipse = np.empty(5)
    found = walked = 0
    for at in range(len(arcs)):
        i, j = arcs[at, 0], arcs[at, 1]
        if taken[i] or (j >= 0 and taken[j]) or share_owner(owners, owned, i, j):
            continue
        if min(tries[i], tries[max(i, j)]) >= max_tries:  # arc i alone when j < 0
            continue
        ellipse[:] = candidates[at]
        polarity = int(table[i, 16]) if signed else 0
        share = probe(head, following, normals, ellipse, polarity)
        growth = 1.0 + limits[GROWTH] * ellipse[3]
        if share < 0.6 * limits[MIN_COVERAGE] or unpromising(share, ellipse, growth, polish):
            continue
        if walked == max_count:
            break
        walked += 1
        count = improve(
            head, following, points, normals, ellipse, limits, polish, polarity, ellipses, found,
            stamp, 8 * walked, chosen, sums, work,
        )  # fmt: skip
        if count == 0:
            tries[i] += 1
            tries[max(i, j)] += 1 if j > i else 0
            continue
        evidence = describe(
            head, following, normals, contour, ellipse, sums, chosen, count, stamp,
            8 * walked + 2, limits, figures[found],
        )  # fmt: skip
        if evidence >= polish:
            count = polish_support(
                head, following, points, normals, ellipse, limits, polarity, stamp, 8 * walked + 3,
                chosen, count, sums,
            )  # fmt: skip
            if count < LEAST_POINTS or near_copy(ellipses, found, ellipse):
                continue
            describe(
                head, following, normals, contour, ellipse, sums, chosen, count, stamp,
                8 * walked + 2 + POLISHES, limits, figures[found],
            )  # fmt: skip
        used = offsets[found]
        if used + count > len(support):
            support = np.concatenate((support, np.empty(len(support) + count, np.int64)))
        support[used : used + count] = chosen[:count]
        row = figures[found]
        strong = min(row[1], row[2]) >= 0.5 and row[0] >= sure
        note_owner(chosen, count, arc_of, ends, tally, owners, owned, taken, found, strong)
        ellipses[found] = ellipse
        sources[found] = at
        found += 1
        offsets[found] = used + count
    ellipses, figures, sources = ellipses[:found], figures[:found], sources[:found]
    return ellipses, figures, offsets[: found + 1], support[: offsets[found]], sources, walked
