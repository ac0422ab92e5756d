"""Kernels of the `refined` scheme: last refit, trimming and saliency of the chosen ellipses."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_covariance import (
    POINTS_PER_WAVE,
    covariance_of,
    radius_at,
)
from geoprim_core.ecc.refined._kernels_fit import offset_of
from geoprim_core.ecc.refined._kernels_order import order_around
from geoprim_core.ecc.refined._kernels_points import arcs_of_points
from geoprim_core.ecc.refined._kernels_refit import (
    FAR,
    MAD,
    TUKEY,
    X,
    Y,
    measure_points,
    refit_within,
)
from geoprim_core.ecc.refined._kernels_support import Supported

GAP = 4.0  # pixels along the outline without support that end an arc
NOISE_GAP = 12.0  # and that noise may leave
TRIM = 2.5  # pixels next to a gap where what hides the outline also bends its edge
LEAST_KEPT = 0.6  # share of the points that the trimming leaves
LEAST_POINTS = 10
LEAST_WIDTH = 0.25  # pixels, of the weights of the last refit
MOST_SHRINKAGE = 0.25  # deviations of the blur; beyond, it is as wide as the curve
ROUNDS = 6  # of the last refit at most
ROUGH_WAVES = 10.0  # half-waves along a rough outline that tell how it scatters
SETTLED = 0.002  # pixels, by which a settled ellipse moves in a round
ALIGNED = 2.0  # d_0 of thesis (5-11)


@inner_kernel
def step_after(parameter: FloatArray, k: int, ellipse: FloatArray, least: float) -> float:
    """Return the way in pixels from a support to the next, or a bound of it below `least`.

    On a circle about the ellipse the way is longer. Few steps are gaps: for others that will do,
    without functions of the angle.
    """
    last = k + 1 == len(parameter)
    turn = parameter[0 if last else k + 1] - parameter[k] + (2.0 * math.pi if last else 0.0)
    if turn * ellipse[2] <= least:
        return float(turn * ellipse[2])
    mid = parameter[k] + 0.5 * turn
    return float(turn * math.hypot(ellipse[2] * math.sin(mid), ellipse[3] * math.cos(mid)))


@kernel
def support_inside(parameter: FloatArray, ellipse: FloatArray, gap: float) -> IntArray:
    """Return the indices of supports, at sorted parameters, that do not end an arc.

    Beside a gap of more than `gap` pixels another edge has drawn the points to its side. All are
    returned when too few would be left.
    """
    count = len(parameter)
    inner = np.ones(count, np.bool_)
    for k in range(count):
        if step_after(parameter, k, ellipse, gap) <= gap:
            continue
        path = 0.0
        at = (k + 1) % count
        while path < TRIM:
            inner[at] = False
            path += step_after(parameter, at, ellipse, 0.0)
            at = (at + 1) % count
        path = 0.0
        at = k
        while path < TRIM:
            inner[at] = False
            at = (at - 1) % count
            path += step_after(parameter, at, ellipse, 0.0)
    kept = np.flatnonzero(inner)
    if len(kept) < max(LEAST_KEPT * count, LEAST_POINTS):
        return np.arange(count)
    return kept


@kernel
def parameters_of(points: FloatArray, ellipse: FloatArray) -> FloatArray:
    """Return the parameter (eccentric anomaly) of each point in (-pi, pi]."""
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    parameter = np.empty(len(points))
    for k in range(len(points)):
        dx, dy = points[k, 0] - ellipse[0], points[k, 1] - ellipse[1]
        u, v = dx * cos + dy * sin, dy * cos - dx * sin
        parameter[k] = math.atan2(v / ellipse[3], u / ellipse[2])
    return parameter


@kernel
def refit_tightly(
    points: FloatArray, ellipse: FloatArray, max_major: float, min_minor: float
) -> float:
    """Refit an ellipse in place with weights as narrow as the scatter allows; return the width.

    Reason for the narrow weights: what crosses or touches an outline at a small angle lies nearer
    to it than the widest scatter of an edge.
    """
    count = len(points)
    near = np.empty((3, count))
    near[X], near[Y] = points[:, 0], points[:, 1]
    width = LEAST_WIDTH
    for _ in range(ROUNDS):
        measure_points(near, count, ellipse)
        width = max(LEAST_WIDTH, TUKEY * MAD * np.median(near[FAR]))
        if refit_within(near, count, ellipse, width, max_major, min_minor) < SETTLED:
            break
    return width


@inner_kernel
def gap_figures(parameter: FloatArray, ellipse: FloatArray) -> tuple[float, float]:
    """Return the angular circumference and continuity ratios of supports at sorted parameters."""
    a, b = ellipse[2], ellipse[3]
    count = len(parameter)
    open_angle = turns = widest = 0.0
    gaps = 0
    for k in range(count):
        t0, t1 = parameter[k], parameter[(k + 1) % count]
        if step_after(parameter, k, ellipse, GAP) <= GAP:
            continue
        if k + 1 == count:
            t1 += 2.0 * math.pi
        seen = math.atan2(b * math.sin(t1), a * math.cos(t1))
        seen -= math.atan2(b * math.sin(t0), a * math.cos(t0))
        turn = math.atan2(a * math.sin(t1), b * math.cos(t1))
        turn -= math.atan2(a * math.sin(t0), b * math.cos(t0))
        seen, turn = seen % (2.0 * math.pi), turn % (2.0 * math.pi)
        open_angle += seen
        turns += min(turn, math.pi)
        widest = max(widest, min(turn, math.pi))
        gaps += 1
    continuity = 1.0
    if gaps > 1:
        continuity = 1.0 - (turns - widest) / ((gaps - 1) * math.pi)
    return max(0.0, 1.0 - open_angle / (2.0 * math.pi)), continuity


@inner_kernel
def alignment_of(
    points: FloatArray,
    order: IntArray,
    ends: IntArray,
    arc_of: IntArray,
    chosen: IntArray,
    ellipse: FloatArray,
    tally: IntArray,
) -> float:
    """Return the share of aligned points of the arcs of which half or more support an ellipse."""
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    aligned = total = 0
    for k in range(len(chosen)):
        if arc_of[chosen[k]] >= 0:
            tally[arc_of[chosen[k]]] += 1
    for k in range(len(chosen)):
        arc = arc_of[chosen[k]]
        if arc < 0 or tally[arc] == 0:
            continue
        if 2 * tally[arc] >= ends[arc + 1] - ends[arc]:
            for m in range(ends[arc], ends[arc + 1]):
                x, y = points[order[m], 0], points[order[m], 1]
                d, _, _ = offset_of(ellipse, cos, sin, x, y)
                total += 1
                aligned += 1 if abs(d) < ALIGNED else 0
        tally[arc] = 0
    return aligned / total if total > 0 else 1.0


@kernel
def unshrunk(
    points: FloatArray, chosen: IntArray, ellipse: FloatArray, spread: float
) -> FloatArray:
    """Return the supporting points moved outwards by what a blur has drawn them inwards.

    The steepest place of a blurred edge moves towards the centre of curvature by half the
    variance of the blur (`spread`) over the radius of curvature.
    """
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    a, b = ellipse[2], ellipse[3]
    moved = np.empty((len(chosen), 2))
    most = MOST_SHRINKAGE * math.sqrt(spread)
    for k in range(len(chosen)):
        x, y = points[chosen[k], 0], points[chosen[k], 1]
        _, nx, ny = offset_of(ellipse, cos, sin, x, y)
        nu, nv = nx * cos + ny * sin, ny * cos - nx * sin
        shift = min(most, 0.5 * spread / radius_at(nu, nv, a, b))
        moved[k, 0], moved[k, 1] = x + shift * nx, y + shift * ny
    return moved


@inner_kernel
def are_sound(rows: FloatArray, saliency: FloatArray, score: FloatArray) -> bool:
    """Tell whether `EllipseDetections` would accept ellipses, their criteria and scores.

    Comparisons with what is not a number are false.
    """
    sound = True
    for k in range(rows.shape[1]):
        sound &= (rows[2, k] >= rows[3, k]) & (rows[3, k] > 0.0) & (rows[2, k] < math.inf)
        sound &= (abs(rows[0, k]) < math.inf) & (abs(rows[1, k]) < math.inf)
        sound &= (rows[4, k] >= 0.0) & (rows[4, k] < math.pi)
        sound &= (score[k] >= 0.0) & (score[k] <= 1.0)
        for criterion in range(3):
            sound &= (saliency[criterion, k] >= 0.0) & (saliency[criterion, k] <= 1.0)
    return sound


@kernel
def finish(
    points: FloatArray,
    order: IntArray,
    ends: IntArray,
    verified: Supported,
    selected: IntArray,
    score: FloatArray,
    max_major: float,
    min_minor: float,
    spread: float,
    gap: float,
    rough: int,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, bool]:
    """Return the selected ellipses (5, n) refitted, saliency criteria (3, n), covariances, scores.

    They stand by falling score. Last comes whether the checks of the detections would pass.

    `spread` is the variance of the blur that is undone, points beside gaps longer than `gap`
    are left out. From ellipse `rough` on the outlines are rough: what scatters there is their
    shape, in a few long waves.
    """
    arc_of = arcs_of_points(order, ends, len(points))
    tally = np.zeros(len(ends), np.int64)
    best = np.argsort(-score, kind="mergesort")
    count = len(selected)
    smoothing = math.sqrt(spread) if spread > 0.0 else 1.0
    rows = np.empty((5, count))
    covariances = np.empty((count, 5, 5))
    saliency = np.empty((3, count))
    for s in range(count):
        k = selected[best[s]]
        chosen = verified.support[verified.offsets[k] : verified.offsets[k + 1]]
        ellipse = verified.ellipses[k].copy()
        moved = unshrunk(points, chosen, ellipse, spread)
        parameter = parameters_of(moved, ellipse)
        sorting = order_around(parameter)
        parameter, moved = parameter[sorting], moved[sorting]
        kept = support_inside(parameter, ellipse, gap)
        inner = moved[kept]
        width = refit_tightly(inner, ellipse, max_major, min_minor)
        rows[:, s] = ellipse
        alike = len(inner) / (POINTS_PER_WAVE * ROUGH_WAVES) if k >= rough else 0.0
        covariances[s] = covariance_of(inner, ellipse, width, max(smoothing, alike))
        saliency[0, s], saliency[2, s] = gap_figures(parameter, ellipse)
        saliency[1, s] = alignment_of(points, order, ends, arc_of, chosen, ellipse, tally)
    score = score[best]
    return rows, saliency, covariances, score, are_sound(rows, saliency, score)
