"""Kernels of the `refined` scheme: a candidate improved by the support it finds."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc._kernels_refined_fit import add_point, fit_moments
from geoprim_core.ecc._kernels_refined_outline import (
    COVERED,
    IN_FRAME,
    STEPS,
    Int32Array,
    Walk,
    add_support,
    collect,
)
from geoprim_core.ecc._kernels_refined_places import GLANCES, SKETCH, sketch_of
from geoprim_core.ecc._kernels_refined_refit import (
    FAR,
    MAD,
    TUKEY,
    X,
    Y,
    gather_points,
    measure_points,
    refit,
)
from geoprim_core.ecc._kernels_refined_support import hopeless
from geoprim_core.fitting._kernels_shape import perimeter_of

LEAST_REACH = 0.7  # pixels
BINS = 24  # of the distances that matter
MEDIAN_SCALE = 256.0  # bins a pixel of a median distance
MEDIAN_BINS = 1024
POLISHES = 2
ROUNDS = 3  # of the robust refit at most
SETTLED = 0.001  # pixels, by which a settled ellipse moves in a round
LEAST_WIDTH = 0.5  # pixels, of the weights of the robust refit
LEAST_POINTS = 10
REFITS = (1.0, 0.8, 1.0)  # reach of the three collections of support, in shares of the limit
HOPE = (6.0, 1.0)  # evidence that the first and the second refit may still add
GLANCE_HOPE = (10.0, 8.0)  # and the rest of the outline with the refits, after each glance

# Entries of the array of limits that `improve` and `verify` take.
REACH, GROWTH, MIN_COSINE, MIN_COVERAGE, MIN_IN_FRAME, MAX_SIZE, MIN_SEMI = range(7)
ENDS, SPREAD, WEIGHTS = range(7, 10)  # from the last on: what `evidence_of` takes


@kernel
def fit_chosen(near: FloatArray, count: int, ellipse: FloatArray, work: FloatArray) -> bool:
    """Replace an ellipse by the direct fit to some points; False (unchanged) if there is none."""
    work[:] = 0.0
    scale = 1.0 / ellipse[2]
    for k in range(count):
        add_point(work, (near[X, k] - ellipse[0]) * scale, (near[Y, k] - ellipse[1]) * scale)
    out = np.empty(5)
    if not fit_moments(work, ellipse[0], ellipse[1], scale, out):
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


@inner_kernel
def look_at(
    head: Int32Array,
    following: Int32Array,
    points: FloatArray,
    normals: FloatArray,
    ellipse: FloatArray,
    stride: float,
    reach: float,
    limits: FloatArray,
    hope: float,
    polarity: int,
    stamp: Int32Array,
    mark: int,
    walk: Walk,
    chosen: IntArray,
    sums: FloatArray,
    glance: bool,
) -> int:
    """Collect the support at few places of an outline, `stride` pixels apart, enough for a fit.

    To `glance` is to look at a quarter and at half of them first, and to return 0 where these
    leave no hope: most candidates are wrong, and that shows soon.
    """
    sums[:] = 0.0
    count = start = 0
    growth = 1.0 + limits[GROWTH] * ellipse[3]
    sketch_of(ellipse[2], ellipse[3], walk.places)
    for k in range(len(GLANCES)):
        end = GLANCES[k]
        count = add_support(
            head, following, points, normals, ellipse, walk, start, end, reach,
            limits[MIN_COSINE], polarity, stamp, mark, chosen, count, sums,
        )  # fmt: skip
        if glance and end < SKETCH:
            fewest = LEAST_POINTS * end // (2 * SKETCH)
            each = stride * SKETCH / end
            if count <= fewest:
                return 0
            least = hope - GLANCE_HOPE[k]
            if hopeless(sums, count, each, ellipse, growth, limits[WEIGHTS:], least):
                return 0
        start = end
    return count


@inner_kernel
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
    stamp: Int32Array,
    mark: int,
    walk: Walk,
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
            reach = reach_of(walk.support, count, ellipse, limits[SPREAD], reach)
        stride = perimeter_of(ellipse[2], ellipse[3]) / (4.0 * SKETCH)
        if step < 2 and stride > 2.0:
            count = look_at(
                head, following, points, normals, ellipse, stride, reach, limits, hope, polarity,
                stamp, mark + step, walk, chosen, sums, step == 0,
            )  # fmt: skip
        else:
            stride = 2.0
            count = collect(
                head, following, points, normals, ellipse, stride, reach, limits[MIN_COSINE],
                polarity, stamp, mark + step, walk, chosen, sums,
            )  # fmt: skip
        least = limits[MIN_COVERAGE] * (1.0 if step == 2 else 0.7)
        if count < LEAST_POINTS or sums[COVERED] < least * sums[IN_FRAME]:
            return 0
        if sums[IN_FRAME] < limits[MIN_IN_FRAME] * sums[STEPS]:
            return 0
        if step < 2:
            hope_left = hope - HOPE[step]
            if hopeless(sums, count, stride, ellipse, growth, limits[WEIGHTS:], hope_left):
                return 0
        gather_points(points, chosen, count, walk.support)
        good = True
        if step == 0:
            good = fit_chosen(walk.support, count, ellipse, work)
        elif step == 1:
            good = refit(walk.support, count, ellipse, 2, 3.0 * reach)
            good = good and not near_copy(known, found, ellipse)
        if not good or ellipse[3] < limits[MIN_SEMI] or ellipse[2] > limits[MAX_SIZE]:
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
    near: FloatArray, count: int, ellipse: FloatArray, max_size: float, min_size: float
) -> float:
    """Refit an ellipse in place with weights from the median distance; return their width.

    A round that leaves the limits of the semi-axes is undone and the last; one that moves the
    ellipse by less than `SETTLED` is the last too.
    """
    tally = np.empty(MEDIAN_BINS + 1, np.int64)
    row = ellipse.copy()
    width = 0.0
    for _ in range(ROUNDS):
        median = median_offset(near, count, row, tally)
        width = max(LEAST_WIDTH, TUKEY * MAD * median)
        if not refit(near, count, row, 2, width):
            break
        if row[2] > max_size or row[3] < min_size:
            break
        moved = 0.0
        for k in range(4):
            moved = max(moved, abs(row[k] - ellipse[k]))
        ellipse[:] = row
        if moved < SETTLED:
            break
    return width


@inner_kernel
def polish_support(
    head: Int32Array,
    following: Int32Array,
    points: FloatArray,
    normals: FloatArray,
    ellipse: FloatArray,
    limits: FloatArray,
    polarity: int,
    stamp: Int32Array,
    mark: int,
    walk: Walk,
    chosen: IntArray,
    count: int,
    sums: FloatArray,
) -> int:
    """Refit an ellipse robustly and collect its support again; return the number of points."""
    for step in range(POLISHES):
        refit_robustly(walk.support, count, ellipse, limits[MAX_SIZE], limits[MIN_SEMI])
        most = limits[REACH] * (1.0 + limits[GROWTH] * ellipse[3])
        count = collect(
            head,
            following,
            points,
            normals,
            ellipse,
            2.0,
            reach_of(walk.support, count, ellipse, limits[SPREAD], most),
            limits[MIN_COSINE],
            polarity,
            stamp,
            mark + step,
            walk,
            chosen,
            sums,
        )
        if count < LEAST_POINTS:
            break
        gather_points(points, chosen, count, walk.support)
    return count
