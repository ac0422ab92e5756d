"""Kernels of the `refined` scheme: candidates verified against all edge points of the image."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, Int32Array, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_ends import (
    continuing_share,
    neighbours_of,
    unexplained_share,
)
from geoprim_core.ecc.refined._kernels_improve import (
    LEAST_POINTS,
    POLISHES,
    REACHES,
    STRIDE,
    Rules,
    growth_of,
    improve,
    near_copy,
    polish_support,
)
from geoprim_core.ecc.refined._kernels_outline import (
    COVERED,
    CROSSING,
    IN_FRAME,
    SQUARES,
    STEPS,
    TURN,
    TURN_COVERED,
    Walk,
    new_walk,
)
from geoprim_core.ecc.refined._kernels_owners import (
    is_settled,
    no_owners,
    note_failure,
    note_owner,
)
from geoprim_core.ecc.refined._kernels_points import EdgeIndex
from geoprim_core.ecc.refined._kernels_support import (
    ACROSS_EACH,
    COVERAGE,
    EVIDENCE,
    FEW_PIXELS,
    FIGURES,
    GOING_ON,
    LENGTH,
    RMS,
    TURN_COVERAGE,
    UNEXPLAINED,
    Supported,
    doubt_of_clutter,
    doubt_of_ends,
    doubt_of_small,
    support_evidence,
    typical_slant,
)

MARKS = 8  # of each candidate: a walk has one of its own


@inner_kernel
def describe(
    edges: EdgeIndex, ellipse: FloatArray, walk: Walk, rules: Rules, links: Int32Array, mark: int,
    count: int, row: FloatArray,
) -> float:  # fmt: skip
    """Write the figures of an ellipse to a row (see `Supported`); return evidence but for clutter.

    What costs time is left out, and those figures 0, where an ellipse is too weak already.
    """
    sums = walk.sums
    row[COVERAGE] = sums[COVERED] / sums[IN_FRAME]
    row[TURN_COVERAGE] = sums[TURN_COVERED] / sums[TURN]
    row[RMS] = math.sqrt(sums[SQUARES] / count)
    row[ACROSS_EACH] = sums[CROSSING] / count
    row[LENGTH] = STRIDE * sums[COVERED]
    row[GOING_ON] = row[UNEXPLAINED] = 0.0
    share = min(row[COVERAGE], row[TURN_COVERAGE])
    growth = growth_of(ellipse, rules)
    evidence = support_evidence(sums, count, row[LENGTH], ellipse, growth, rules.weights)
    outline = row[LENGTH] / share
    if evidence >= rules.hope and rules.weights.small > 0.0 and outline < FEW_PIXELS[1]:
        slant = typical_slant(edges.points, edges.normals, ellipse, walk.chosen, count)
        evidence -= doubt_of_small(slant, outline, rules.weights.small)
    if rules.end_weight > 0.0 and evidence >= rules.hope:
        row[GOING_ON] = continuing_share(links, walk.stamp, mark, walk.chosen, count)
        if evidence - rules.end_weight * doubt_of_ends(share, row[GOING_ON], 0.0) >= rules.hope:
            row[UNEXPLAINED] = unexplained_share(edges, ellipse, walk)
        evidence -= rules.end_weight * doubt_of_ends(share, row[GOING_ON], row[UNEXPLAINED])
    row[EVIDENCE] = evidence - doubt_of_clutter(share, row[ACROSS_EACH])
    return float(evidence)


@kernel
def verify(
    edges: EdgeIndex,
    contours: IntArray,
    order: IntArray,
    ends: IntArray,
    polarities: FloatArray,
    arcs: IntArray,
    candidates: FloatArray,
    rules: Rules,
) -> tuple[Supported, IntArray, int]:
    """Verify candidates in the given order against all edge points.

    `contours` are the offsets of the edge points on them, `order`, `ends` and `polarities` those
    of the smooth arcs, `arcs` those that each candidate is made of, -1 for none. Returns the
    ellipses that pass, the candidate each came from, and the number of candidates looked at
    closely, one more than allowed where that left a candidate out.

    An ellipse with hope (see `Rules`) is refitted once more, robustly; so is one that lacks some of
    that, up to `refit_margin`, less for what nothing supports of the outline, and for thin ones,
    which two lines are near too. The arcs of one with hope make no other candidate with each
    other; a sure one takes its arcs. Two arcs that both failed, or gave less evidence than that,
    `max_tries` times are left alone.
    """
    total = len(edges.points)
    room = min(len(arcs), rules.max_candidates)
    ellipses = np.empty((room, 5))
    figures = np.empty((room, FIGURES))
    sources = np.empty(room, np.int64)
    offsets = np.zeros(room + 1, np.int64)
    support = np.empty(4 * total + 1, np.int64)
    owners = no_owners(order, ends, total)
    links = neighbours_of(edges.points, contours)
    walk = new_walk(edges, rules.max_semi_major)
    ellipse = np.empty(5)
    found = walked = 0
    for at in range(len(arcs)):
        i, j = arcs[at, 0], arcs[at, 1]
        if i >= 0 and is_settled(owners, i, j, rules.max_tries):
            continue
        ellipse[:] = candidates[at]
        polarity = int(polarities[i]) if rules.signed and i >= 0 else 0
        walked += 1
        if walked > rules.max_candidates:
            break
        mark = MARKS * walked
        count = improve(edges, ellipse, walk, rules, polarity, mark, ellipses, found)
        if count == 0:
            note_failure(owners, i, j)
            continue
        row = figures[found]
        mark += len(REACHES) - 1  # of the last walk
        evidence = describe(edges, ellipse, walk, rules, links, mark, count, row)
        share = walk.sums[COVERED] / walk.sums[STEPS]  # of the whole outline, also out of the image
        margin = rules.refit_margin * share * share * ellipse[3] / ellipse[2]
        if evidence >= rules.hope - margin:
            count = polish_support(edges, ellipse, walk, rules, polarity, mark + 1, count)
            if count < LEAST_POINTS or near_copy(ellipses, found, ellipse):
                continue
            describe(edges, ellipse, walk, rules, links, mark + POLISHES, count, row)
        used = offsets[found]
        if used + count > len(support):
            support = np.concatenate((support, np.empty(len(support) + count, np.int64)))
        support[used : used + count] = walk.chosen[:count]
        if rules.weak_claims or row[EVIDENCE] >= rules.hope:
            note_owner(owners, walk.chosen, count, found, row[EVIDENCE] >= rules.sure)
        else:
            note_failure(owners, i, j)
        ellipses[found] = ellipse
        sources[found] = at
        found += 1
        offsets[found] = used + count
    verified = Supported(
        ellipses[:found], figures[:found], offsets[: found + 1], support[: offsets[found]]
    )
    return verified, sources[:found], walked
