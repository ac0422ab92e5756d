"""Kernels of the `refined` scheme: last refit, covariance and saliency of the chosen ellipses."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.ecc._kernels_refined_fit import offset_of, refit_robustly, solve5
from geoprim_core.ecc._kernels_refined_support import arcs_of_points

GAP = 4.0  # pixels along the outline without support that end an arc
MOST_SHRINKAGE = 0.25  # pixels; beyond, the blur is wider than the curve
ALIGNED = 2.0  # d_0 of thesis (5-11)
ANGLE_PRIOR = 12.0 / math.pi**2  # inverse variance of an angle of which nothing is known


@kernel
def covariance_of(
    points: FloatArray, chosen: IntArray, parameter: FloatArray, ellipse: FloatArray
) -> FloatArray:
    """Return the covariance (5, 5) of an ellipse from the distances of its points, in order.

    Neighbouring edge points err alike; the lag-one correlation of the distances widens the
    covariance accordingly. NaN when the points do not determine the ellipse.
    """
    count = len(chosen)
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    a, b = ellipse[2], ellipse[3]
    normal = np.zeros((5, 5))
    row = np.empty(5)
    square = lagged = before = 0.0
    for k in range(count):
        p = chosen[k]
        d, nx, ny = offset_of(ellipse, cos, sin, points[p, 0], points[p, 1])
        ct, st = math.cos(parameter[k]), math.sin(parameter[k])
        nu, nv = nx * cos + ny * sin, ny * cos - nx * sin
        row[0], row[1], row[2], row[3] = nx, ny, ct * nu, st * nv
        row[4] = a * ct * nv - b * st * nu
        for i in range(5):
            for j in range(i + 1):
                normal[i, j] += row[i] * row[j]
        square += d * d
        lagged += d * before
        before = d
    variance = square / max(1, count - 5)
    likeness = min(0.9, max(0.0, lagged / square)) if square > 0.0 else 0.0
    variance = max(variance * (1.0 + likeness) / (1.0 - likeness), 1e-12)
    for i in range(5):
        for j in range(i + 1):
            normal[i, j] /= variance
            normal[j, i] = normal[i, j]
    normal[4, 4] += ANGLE_PRIOR
    result = np.zeros((5, 5))
    for i in range(5):
        result[i, i] = 1.0
        if not solve5(normal.copy(), result[i]):
            result[:] = np.nan
            break
    return 0.5 * (result + result.T)


@kernel
def gap_figures(parameter: FloatArray, ellipse: FloatArray) -> tuple[float, float]:
    """Return the angular circumference and continuity ratios of supports at sorted parameters."""
    a, b = ellipse[2], ellipse[3]
    count = len(parameter)
    open_angle = turns = widest = 0.0
    gaps = 0
    for k in range(count):
        t0, t1 = parameter[k], parameter[(k + 1) % count]
        if k + 1 == count:
            t1 += 2.0 * math.pi
        mid = 0.5 * (t0 + t1)
        if (t1 - t0) * math.hypot(a * math.sin(mid), b * math.cos(mid)) <= GAP:
            continue
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


@kernel
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
    for k in range(len(chosen)):
        x, y = points[chosen[k], 0], points[chosen[k], 1]
        _, nx, ny = offset_of(ellipse, cos, sin, x, y)
        nu, nv = nx * cos + ny * sin, ny * cos - nx * sin
        # The radius of curvature where the normal is (nu, nv).
        radius = a * a * b * b / (a * a * nu * nu + b * b * nv * nv) ** 1.5
        shift = min(MOST_SHRINKAGE, 0.5 * spread / radius)
        moved[k, 0], moved[k, 1] = x + shift * nx, y + shift * ny
    return moved


@kernel
def finish(
    points: FloatArray,
    order: IntArray,
    ends: IntArray,
    ellipses: FloatArray,
    offsets: IntArray,
    support: IntArray,
    selected: IntArray,
    max_size: float,
    min_size: float,
    spread: float,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the selected ellipses refitted, their covariances and their saliency criteria."""
    arc_of = arcs_of_points(order, ends, len(points))
    tally = np.zeros(len(ends), np.int64)
    count = len(selected)
    rows = np.empty((count, 5))
    covariances = np.empty((count, 5, 5))
    saliency = np.empty((count, 3))
    for s in range(count):
        k = selected[s]
        chosen = support[offsets[k] : offsets[k + 1]]
        ellipse = ellipses[k].copy()
        moved = unshrunk(points, chosen, ellipse, spread)
        refit_robustly(moved, np.arange(len(chosen)), ellipse, max_size, min_size)
        cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
        parameter = np.empty(len(chosen))
        for m in range(len(chosen)):
            dx, dy = moved[m, 0] - ellipse[0], moved[m, 1] - ellipse[1]
            u, v = dx * cos + dy * sin, dy * cos - dx * sin
            parameter[m] = math.atan2(v / ellipse[3], u / ellipse[2])
        sorting = np.argsort(parameter, kind="mergesort")
        rows[s] = ellipse
        parameter = parameter[sorting]
        covariances[s] = covariance_of(moved, sorting, parameter, ellipse)
        saliency[s, 0], saliency[s, 2] = gap_figures(parameter, ellipse)
        saliency[s, 1] = alignment_of(points, order, ends, arc_of, chosen, ellipse, tally)
    return rows, covariances, saliency
