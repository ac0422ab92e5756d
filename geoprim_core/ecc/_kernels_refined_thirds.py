"""Kernels of the `refined` scheme: how well the support of an ellipse predicts its own parts."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc._kernels_refined_order import order_around
from geoprim_core.ecc._kernels_refined_refit import solve5
from geoprim_core.ecc._kernels_refined_support import doubt_of_clutter

MOST_COVERED = 0.9  # share of the outline beyond which hardly anything is extrapolated
LEAST_WIDTH = 0.05  # pixels, of the weights
STIFFNESS = 0.05  # points at a pixel's distance that hold the ellipse where its support does not


@kernel
def write_rows(points: FloatArray, chosen: IntArray, ellipse: FloatArray, rows: FloatArray) -> None:
    """Write of each point the five derivatives of its distance, the distance, and its parameter.

    In the frame where the ellipse is the unit circle the conic has five free coefficients, as in
    `refit`; the distance in pixels is Sampson's.
    """
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    ia, ib = 1.0 / ellipse[2], 1.0 / ellipse[3]
    for k in range(len(chosen)):
        dx, dy = points[chosen[k], 0] - ellipse[0], points[chosen[k], 1] - ellipse[1]
        u, v = (dx * cos + dy * sin) * ia, (dy * cos - dx * sin) * ib
        inverse = 0.5 / math.sqrt(u * u * ia * ia + v * v * ib * ib + 1e-300)
        rows[k, 0], rows[k, 1], rows[k, 2] = u * u * inverse, u * v * inverse, v * v * inverse
        rows[k, 3], rows[k, 4] = u * inverse, v * inverse
        rows[k, 5] = (u * u + v * v - 1.0) * inverse
        rows[k, 6] = math.atan2(v, u)


@inner_kernel
def after_largest_gap(angles: FloatArray, order: IntArray) -> int:
    """Return the place in the order of the angles that follows their largest gap."""
    count = len(order)
    place, widest = 0, angles[order[0]] - angles[order[count - 1]] + 2.0 * math.pi
    for m in range(1, count):
        gap = angles[order[m]] - angles[order[m - 1]]
        if gap > widest:
            place, widest = m, gap
    return place


@inner_kernel
def add_sums(
    rows: FloatArray, start: int, end: int, width: float, normal: FloatArray, right: FloatArray
) -> None:
    """Add points start .. end - 1 to the normal matrix and right side of a weighted linear fit."""
    for k in range(start, end):
        ratio = rows[k, 5] / width
        weight = 1.0 / (1.0 + ratio * ratio)
        for i in range(5):
            right[i] -= weight * rows[k, i] * rows[k, 5]
            for j in range(i + 1):
                normal[i, j] += weight * rows[k, i] * rows[k, j]


@kernel
def prediction_error(points: FloatArray, chosen: IntArray, ellipse: FloatArray) -> float:
    """Return how far a third of the support lies from where the other two thirds put the outline.

    The largest of three medians in pixels. The thirds follow each other along the outline, from
    its largest gap on, so that they do not depend on how the image is turned. The refit without a
    third is one linear step, robust as the scatter asks for.
    """
    count = len(chosen)
    rows = np.empty((count, 7))
    write_rows(points, chosen, ellipse, rows)
    order = order_around(rows[:, 6].copy())
    rows = rows[np.roll(order, -after_largest_gap(rows[:, 6], order))]
    width = 2.0 * np.median(np.abs(rows[:, 5])) + LEAST_WIDTH
    first = (count + 1) // 3
    ends = (0, first, count - first, count)
    normals, rights = np.zeros((3, 5, 5)), np.zeros((3, 5))
    for part in range(3):
        add_sums(rows, ends[part], ends[part + 1], width, normals[part], rights[part])
    worst = 0.0
    for part in range(3):
        third = rows[ends[part] : ends[part + 1]]
        matrix = normals[(part + 1) % 3] + normals[(part + 2) % 3]
        moved = rights[(part + 1) % 3] + rights[(part + 2) % 3]
        for i in range(5):
            matrix[i, i] += 0.25 * STIFFNESS * ellipse[2] * ellipse[3]
        if solve5(matrix, moved):
            distance = third[:, 5].copy()
            for i in range(5):
                distance += third[:, i] * moved[i]
            worst = max(worst, np.median(np.abs(distance)))
    return worst


@kernel
def doubt_predictions(
    points: FloatArray,
    ellipses: FloatArray,
    figures: FloatArray,
    offsets: IntArray,
    support: IntArray,
    growth: float,
    weight: float,
    least: float,
) -> FloatArray:
    """Return the figures with less evidence where the support does not predict itself.

    What is lost is `weight` times the logarithm of `prediction_error` in pixels, that may grow as
    the scatter may, in proportion to the unsupported rest of the outline. An ellipse
    whose evidence is below `least` without any clutter is left as it is.
    """
    result = figures.copy()
    for k in range(len(ellipses)):
        row = result[k]
        share = min(row[1], row[2])
        evidence = row[0] + doubt_of_clutter(share, row[4])
        if evidence >= least and share < MOST_COVERED:
            chosen = support[offsets[k] : offsets[k + 1]]
            error = prediction_error(points, chosen, ellipses[k])
            error /= 1.0 + growth * ellipses[k, 3]
            row[0] -= weight * (1.0 - share) * math.log(max(1.0, error))
    return result
