"""Kernels of the `refined` scheme: candidates verified against all edge points of the image."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc._kernels_refined_ends import (
    continuing_share,
    neighbours_of,
    unexplained_share,
)
from geoprim_core.ecc._kernels_refined_improve import (
    ENDS,
    GROWTH,
    LEAST_POINTS,
    MAX_SIZE,
    POLISHES,
    WEIGHTS,
    improve,
    near_copy,
    polish_support,
)
from geoprim_core.ecc._kernels_refined_outline import (
    COVERED,
    CROSSING,
    IN_FRAME,
    SQUARES,
    STEPS,
    SUMS,
    TURN,
    TURN_COVERED,
    Int32Array,
    Walk,
    new_walk,
)
from geoprim_core.ecc._kernels_refined_support import (
    FEW_PIXELS,
    SMALL_WEIGHT,
    arcs_of_points,
    doubt_of_clutter,
    doubt_of_ends,
    doubt_of_small,
    support_evidence,
    typical_slant,
)

FIGURES = 8
SLOTS = 8  # verified ellipses remembered for each arc
OWNED = 0.7  # an arc belongs to an ellipse that this share of its points support
TAKEN = 0.9  # and is taken by a sure one that this share supports: no other may need the rest


@inner_kernel
def share_owner(owners: IntArray, owned: IntArray, i: int, j: int) -> bool:
    """Tell whether two arcs (or one, j < 0) already belong to one verified ellipse."""
    if j < 0:
        return bool(owned[i] > 0)
    for k in range(min(SLOTS, owned[i])):
        for m in range(min(SLOTS, owned[j])):
            if owners[i, k] == owners[j, m]:
                return True
    return False


@inner_kernel
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
                if strong and tally[arc] > TAKEN * (ends[arc + 1] - ends[arc]):
                    taken[arc] = 1
            tally[arc] = 0


@inner_kernel
def describe(
    head: Int32Array,
    following: Int32Array,
    points: FloatArray,
    normals: FloatArray,
    links: Int32Array,
    walk: Walk,
    ellipse: FloatArray,
    sums: FloatArray,
    chosen: IntArray,
    count: int,
    stamp: Int32Array,
    mark: int,
    limits: FloatArray,
    least: float,
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
    evidence = support_evidence(sums, count, row[5], ellipse, growth, limits[WEIGHTS:])
    outline = row[5] / share
    if evidence >= least and limits[WEIGHTS + SMALL_WEIGHT] > 0.0 and outline < FEW_PIXELS[1]:
        slant = typical_slant(points, normals, ellipse, chosen, count)
        evidence -= doubt_of_small(slant, outline, limits[WEIGHTS + SMALL_WEIGHT])
    if limits[ENDS] > 0.0 and evidence >= least:  # else it is too weak already
        row[6] = continuing_share(links, stamp, mark, chosen, count)
        if evidence - limits[ENDS] * doubt_of_ends(share, row[6], 0.0) >= least:
            row[7] = unexplained_share(
                head, following, normals, ellipse, walk, int(sums[STEPS]) // 4
            )
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
    contours: IntArray,
    table: FloatArray,
    arcs: IntArray,
    candidates: FloatArray,
    limits: FloatArray,
    signed: bool,
    weak_claims: bool,
    sure: float,
    polish: float,
    margin: float,
    max_tries: int,
    max_count: int,
) -> tuple[FloatArray, FloatArray, IntArray, IntArray, IntArray, int]:
    """Verify candidates in the given order against all edge points.

    Returns the ellipses that pass; their figures: evidence, coverage, share of the turn covered,
    rms, crossing points per supporting one, length in pixels, shares of the ends at which a
    contour goes on and at which nothing explains a gap; offsets and indices of their supporting
    points; the candidate each came from; and the number of candidates looked at closely, one more
    than `max_count` where that left a candidate out. An ellipse with evidence `polish` is refitted
    once more, robustly; so is one that lacks up to `margin` of it, less for what nothing supports
    of the outline, and for thin ones, which two lines are near too. The arcs of one with evidence
    `polish` make no other candidate with each other; one with evidence `sure` takes its arcs. With
    `weak_claims` the arcs of any that passes make no other candidate with each other. Two arcs that
    both failed, or gave less evidence than that, `max_tries` times are left alone.
    """
    total = len(points)
    room = min(len(arcs), max_count)
    ellipses = np.empty((room, 5))
    figures = np.empty((room, FIGURES))
    sources = np.empty(room, np.int64)
    offsets = np.zeros(room + 1, np.int64)
    support = np.empty(4 * total + 1, np.int64)
    arc_of = arcs_of_points(order, ends, total)
    links = neighbours_of(points, contours)
    owners = np.empty((len(ends), SLOTS), np.int64)
    counts = np.zeros((4, len(ends)), np.int64)
    owned, taken, tally, tries = counts[0], counts[1], counts[2], counts[3]
    stamp = np.zeros(total, np.int32)
    chosen = np.empty(total + 1, np.int64)
    walk = new_walk(head, limits[MAX_SIZE], total)
    work = np.empty(25)
    sums = np.empty(SUMS)
    ellipse = np.empty(5)
    found = walked = 0
    for at in range(len(arcs)):
        i, j = arcs[at, 0], arcs[at, 1]
        if i >= 0:
            if taken[i] or (j >= 0 and taken[j]) or share_owner(owners, owned, i, j):
                continue
            if min(tries[i], tries[max(i, j)]) >= max_tries:  # arc i alone when j < 0
                continue
        ellipse[:] = candidates[at]
        polarity = int(table[i, 16]) if signed and i >= 0 else 0
        if walked == max_count:
            walked += 1
            break
        walked += 1
        count = improve(
            head, following, points, normals, ellipse, limits, polish, polarity, ellipses, found,
            stamp, 8 * walked, walk, chosen, sums, work,
        )  # fmt: skip
        if count == 0:
            if i >= 0:
                tries[i] += 1
                tries[max(i, j)] += 1 if j > i else 0
            continue
        evidence = describe(
            head, following, points, normals, links, walk, ellipse, sums, chosen, count, stamp,
            8 * walked + 2, limits, polish, figures[found],
        )  # fmt: skip
        share = sums[COVERED] / sums[STEPS]  # of the whole outline, also beyond the image
        if evidence >= polish - margin * share * share * ellipse[3] / ellipse[2]:
            count = polish_support(
                head, following, points, normals, ellipse, limits, polarity, stamp, 8 * walked + 3,
                walk, chosen, count, sums,
            )  # fmt: skip
            if count < LEAST_POINTS or near_copy(ellipses, found, ellipse):
                continue
            describe(
                head, following, points, normals, links, walk, ellipse, sums, chosen, count, stamp,
                8 * walked + 2 + POLISHES, limits, polish, figures[found],
            )  # fmt: skip
        used = offsets[found]
        if used + count > len(support):
            support = np.concatenate((support, np.empty(len(support) + count, np.int64)))
        support[used : used + count] = chosen[:count]
        row = figures[found]
        strong = row[0] >= sure
        if weak_claims or row[0] >= polish:
            note_owner(chosen, count, arc_of, ends, tally, owners, owned, taken, found, strong)
        elif i >= 0:
            tries[i] += 1
            tries[max(i, j)] += 1 if j > i else 0
        ellipses[found] = ellipse
        sources[found] = at
        found += 1
        offsets[found] = used + count
    ellipses, figures, sources = ellipses[:found], figures[:found], sources[:found]
    return ellipses, figures, offsets[: found + 1], support[: offsets[found]], sources, walked
