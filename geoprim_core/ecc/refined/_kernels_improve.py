"""Kernels of the `refined` scheme: a candidate improved by the support it finds."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_fit import add_point, fit_moments
from geoprim_core.ecc.refined._kernels_outline import (
    COVERED,
    IN_FRAME,
    STEPS,
    Band,
    Walk,
    add_support,
    collect,
)
from geoprim_core.ecc.refined._kernels_places import GLANCES, SKETCH, sketch_of
from geoprim_core.ecc.refined._kernels_points import EdgeIndex
from geoprim_core.ecc.refined._kernels_refit import (
    FAR,
    MAD,
    REFIT_STEPS,
    TUKEY,
    X,
    Y,
    gather_points,
    measure_points,
    refit,
    refit_within,
)
from geoprim_core.ecc.refined._kernels_support import Weights, hopeless
from geoprim_core.fitting._kernels_shape import perimeter_of

LEAST_REACH = 0.7  # pixels
BINS = 24  # of the distances that matter
MEDIAN_SCALE = 256.0  # bins a pixel of a median distance
MEDIAN_BINS = 1024
POLISHES = 2
COPY = 1.0  # pixels between the parameters of ellipses that are the same
ROUNDS = 3  # of the robust refit at most
SETTLED = 0.001  # pixels, by which a settled ellipse moves in a round
LEAST_WIDTH = 0.5  # pixels, of the weights of the robust refit
LEAST_POINTS = 10
STRIDE = 2.0  # pixels between the places of a walk that leaves none out
EARLY_COVERAGE = 0.7  # share of the least coverage that suffices before the last collection
REFIT_WIDTH = 3.0  # of the weights of the second refit, in reaches
REACHES = (1.0, 0.8, 1.0)  # reach of the three collections of support, in shares of the limit
HOPE = (6.0, 1.0)  # evidence that the first and the second refit may still add
GLANCE_HOPE = (10.0, 8.0)  # and the rest of the outline with the refits, after each glance


class Rules(NamedTuple):
    """What an ellipse has to meet, see `RefinedParams`; lengths are in pixels.

    Attributes
    ----------
    reach, reach_growth, reach_spread : float
        How far support may lie: at most so far, more by so much for each pixel of the semi-minor
        axis, and so many medians of the distances.
    min_cosine : float
        Between gradient and normal.
    min_coverage, min_in_frame : float
        Supported share of the outline, and that inside the image.
    max_semi_major, min_semi_minor : float
    end_weight : float
        Of how the supported stretches end.
    weights : Weights
    hope : float
        Evidence that is worth the work: with it, an ellipse is reported.
    refit_margin : float
        Evidence that a whole circle may lack of that to be refitted robustly.
    sure : float
        Evidence with which an ellipse takes its arcs.
    weak_claims : bool
        Whether the arcs of one without hope make no other candidate with each other either.
    signed : bool
        Whether support has the polarity of the arcs.
    max_tries, max_candidates : int
        Failures of two arcs, and candidates that are looked at closely.
    """

    reach: float
    reach_growth: float
    reach_spread: float
    min_cosine: float
    min_coverage: float
    min_in_frame: float
    max_semi_major: float
    min_semi_minor: float
    end_weight: float
    weights: Weights
    hope: float
    refit_margin: float
    sure: float
    weak_claims: bool
    signed: bool
    max_tries: int
    max_candidates: int


@inner_kernel
def growth_of(ellipse: FloatArray, rules: Rules) -> float:
    """Return how many times as far as on a small ellipse edge points may lie from a larger one."""
    return float(1.0 + rules.reach_growth * ellipse[3])


@kernel
def fit_chosen(near: FloatArray, count: int, ellipse: FloatArray) -> bool:
    """Replace an ellipse by the direct fit to some points; False (unchanged) if there is none."""
    room = np.zeros(30)
    moments, out = room[:25], room[25:]
    scale = 1.0 / ellipse[2]
    for k in range(count):
        add_point(moments, (near[X, k] - ellipse[0]) * scale, (near[Y, k] - ellipse[1]) * scale)
    if not fit_moments(moments, ellipse[0], ellipse[1], scale, out):
        return False
    ellipse[:] = out
    return True


@kernel
def reach_of(
    near: FloatArray, count: int, ellipse: FloatArray, spread: float, most: float
) -> float:
    """Return how far support may lie: `spread` times the typical distance, at most `most`.

    Clean edges lie within a fraction of a pixel; what lies further is then not of this outline.
    """
    if not spread > 0.0:
        return most
    measure_points(near, count, ellipse)
    # A histogram finds the median as far as it matters, and faster than a sort.
    tally = np.zeros(BINS + 1, np.int64)
    scale = BINS * spread / most
    for k in range(count):
        tally[min(BINS, int(near[FAR, k] * scale))] += 1
    below = 0
    for k in range(BINS):
        below += tally[k]
        if 2 * below >= count:
            return min(most, max(LEAST_REACH, spread * (k + 1) / scale))
    return most


@inner_kernel
def near_copy(ellipses: FloatArray, count: int, ellipse: FloatArray) -> bool:
    """Tell whether an ellipse is within `COPY` of one of the first `count`."""
    for k in range(count):
        other = ellipses[k]
        if abs(other[0] - ellipse[0]) > COPY or abs(other[1] - ellipse[1]) > COPY:
            continue
        if abs(other[2] - ellipse[2]) > COPY or abs(other[3] - ellipse[3]) > COPY:
            continue
        turn = abs(other[4] - ellipse[4])
        turn = min(turn, math.pi - turn)
        if turn * (ellipse[2] - ellipse[3]) < COPY:
            return True
    return False


@inner_kernel
def look_at(
    edges: EdgeIndex,
    ellipse: FloatArray,
    walk: Walk,
    stride: float,
    band: Band,
    rules: Rules,
    glance: bool,
) -> int:
    """Collect the support at few places of an outline, `stride` pixels apart, enough for a fit.

    To `glance` is to look at a quarter and at half of them first, and to return 0 where these
    leave no hope: most candidates are wrong, and that shows soon.
    """
    walk.sums[:] = 0.0
    count = start = 0
    growth = growth_of(ellipse, rules)
    sketch_of(ellipse[2], ellipse[3], walk.places)
    for k in range(len(GLANCES)):
        end = GLANCES[k]
        count = add_support(edges, ellipse, walk, start, end, band, count)
        if glance and end < SKETCH:
            fewest = LEAST_POINTS * end // (2 * SKETCH)
            each = stride * SKETCH / end
            if count <= fewest:
                return 0
            least = rules.hope - GLANCE_HOPE[k]
            if hopeless(walk.sums, count, each, ellipse, growth, rules.weights, least):
                return 0
        start = end
    return count


@inner_kernel
def improve(
    edges: EdgeIndex, ellipse: FloatArray, walk: Walk, rules: Rules, polarity: int, mark: int,
    known: FloatArray, found: int,
) -> int:  # fmt: skip
    """Collect support and refit, twice, then collect again; return the points, 0 for a failure.

    The first refit is direct, the second robust and orthogonal. The ellipse is changed in place;
    it fails too when it has become a copy of one of the `found` known ones, or when its evidence
    stays far below what makes it worth the work.
    """
    count = 0
    sums = walk.sums
    for step in range(3):
        growth = growth_of(ellipse, rules)
        reach = rules.reach * REACHES[step] * growth
        if step > 0:
            reach = reach_of(walk.gathered, count, ellipse, rules.reach_spread, reach)
        band = Band(reach, rules.min_cosine, polarity, mark + step)
        stride = perimeter_of(ellipse[2], ellipse[3]) / (4.0 * SKETCH)
        if step < 2 and stride > STRIDE:
            count = look_at(edges, ellipse, walk, stride, band, rules, step == 0)
        else:
            stride = STRIDE
            count = collect(edges, ellipse, walk, stride, band)
        least = rules.min_coverage * (1.0 if step == 2 else EARLY_COVERAGE)
        if count < LEAST_POINTS or sums[COVERED] < least * sums[IN_FRAME]:
            return 0
        if sums[IN_FRAME] < rules.min_in_frame * sums[STEPS]:
            return 0
        if step < 2:
            hope_left = rules.hope - HOPE[step]
            if hopeless(sums, count, stride, ellipse, growth, rules.weights, hope_left):
                return 0
        gather_points(edges.points, walk.chosen, count, walk.gathered)
        good = True
        if step == 0:
            good = fit_chosen(walk.gathered, count, ellipse)
        elif step == 1:
            good = refit(walk.gathered, count, ellipse, REFIT_STEPS, REFIT_WIDTH * reach)
            good = good and not near_copy(known, found, ellipse)
        if not good or ellipse[3] < rules.min_semi_minor or ellipse[2] > rules.max_semi_major:
            return 0
    return count


@inner_kernel
def median_offset(near: FloatArray, count: int, ellipse: FloatArray, tally: IntArray) -> float:
    """Return the median distance of points to an ellipse, to a bin of a histogram of `tally`.

    A histogram costs a fraction of a median, and the width of weights need not be exact.
    """
    measure_points(near, count, ellipse)
    tally[:] = 0
    for k in range(count):
        tally[min(MEDIAN_BINS, int(near[FAR, k] * MEDIAN_SCALE))] += 1
    below = 0
    for k in range(MEDIAN_BINS):
        below += tally[k]
        if 2 * below >= count:
            return (k + 0.5) / MEDIAN_SCALE
    return MEDIAN_BINS / MEDIAN_SCALE


@kernel
def refit_robustly(
    near: FloatArray, count: int, ellipse: FloatArray, max_major: float, min_minor: float
) -> float:
    """Refit an ellipse in place with weights from the median distance; return their width.

    A round that leaves the limits of the semi-axes is undone and the last; one that moves the
    ellipse by less than `SETTLED` is the last too.
    """
    tally = np.empty(MEDIAN_BINS + 1, np.int64)
    width = 0.0
    for _ in range(ROUNDS):
        median = median_offset(near, count, ellipse, tally)
        width = max(LEAST_WIDTH, TUKEY * MAD * median)
        if refit_within(near, count, ellipse, width, max_major, min_minor) < SETTLED:
            break
    return width


@inner_kernel
def polish_support(
    edges: EdgeIndex, ellipse: FloatArray, walk: Walk, rules: Rules, polarity: int, mark: int,
    count: int,
) -> int:  # fmt: skip
    """Refit an ellipse robustly and collect its support again; return the number of points."""
    for step in range(POLISHES):
        refit_robustly(walk.gathered, count, ellipse, rules.max_semi_major, rules.min_semi_minor)
        most = rules.reach * growth_of(ellipse, rules)
        reach = reach_of(walk.gathered, count, ellipse, rules.reach_spread, most)
        band = Band(reach, rules.min_cosine, polarity, mark + step)
        count = collect(edges, ellipse, walk, STRIDE, band)
        if count < LEAST_POINTS:
            break
        gather_points(edges.points, walk.chosen, count, walk.gathered)
    return count
