"""Kernels of the `refined` scheme: how well the support of an ellipse predicts its own parts."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_order import order_around
from geoprim_core.ecc.refined._kernels_refit import solve5
from geoprim_core.ecc.refined._kernels_support import (
    ACROSS_EACH,
    COVERAGE,
    EVIDENCE,
    TURN_COVERAGE,
    Supported,
    doubt_of_clutter,
)

MOST_COVERED = 0.9  # share of the outline beyond which hardly anything is extrapolated
LEAST_WIDTH = 0.05  # pixels, of the weights
STIFFNESS = 0.05  # points at a pixel's distance that hold the ellipse where its support does not


@inner_kernel
def write_frame(
    points: FloatArray, chosen: IntArray, ellipse: FloatArray, frame: FloatArray
) -> None:
    """Write of each point its position where the ellipse is the unit circle, and its turn.

    The turn stands for the angle from the major axis: it rises with it from -pi to pi, is the same
    at multiples of pi/2, and takes no arc tangent.
    """
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    ia, ib = 1.0 / ellipse[2], 1.0 / ellipse[3]
    for k in range(len(chosen)):
        at = np.uint64(chosen[k])
        dx, dy = points[at, 0] - ellipse[0], points[at, 1] - ellipse[1]
        u, v = (dx * cos + dy * sin) * ia, (dy * cos - dx * sin) * ib
        frame[0, k], frame[1, k] = u, v
        part = v / (abs(u) + abs(v) + 1e-300)
        beyond = 2.0 - part if v >= 0.0 else -2.0 - part
        frame[2, k] = 0.5 * math.pi * (part if u >= 0.0 else beyond)


@inner_kernel
def after_largest_gap(frame: FloatArray, order: IntArray) -> int:
    """Return the place in the order of the points that follows the largest gap of their angles.

    Gaps are compared by what rises with them from -1 to 3: their cosine turned about.
    """
    count = len(order)
    place, widest = 0, -math.inf
    for m in range(count):
        i, j = order[m - 1 if m > 0 else count - 1], order[m]
        dot = frame[0, i] * frame[0, j] + frame[1, i] * frame[1, j]
        lengths = (frame[0, i] * frame[0, i] + frame[1, i] * frame[1, i]) * (
            frame[0, j] * frame[0, j] + frame[1, j] * frame[1, j]
        )
        cosine = dot / math.sqrt(lengths + 1e-300)
        turn = frame[2, j] - frame[2, i] + (2.0 * math.pi if m == 0 else 0.0)
        gap = 2.0 + cosine if turn > math.pi else -cosine
        if gap > widest:
            place, widest = m, gap
    return place


@inner_kernel
def write_rows(
    frame: FloatArray, order: IntArray, start: int, ellipse: FloatArray, rows: FloatArray
) -> None:
    """Write of each point the five derivatives of its distance, and the distance.

    In the given order from `start` on, all around. In the frame where the ellipse is the unit
    circle the conic has five free coefficients, as in `refit`; the distance in pixels is Sampson's.
    """
    ia, ib = 1.0 / ellipse[2], 1.0 / ellipse[3]
    count = len(order)
    for m in range(count):
        k = np.uint64(order[m + start if m + start < count else m + start - count])
        u, v = frame[0, k], frame[1, k]
        inverse = 0.5 / math.sqrt(u * u * ia * ia + v * v * ib * ib + 1e-300)
        rows[m, 0], rows[m, 1], rows[m, 2] = u * u * inverse, u * v * inverse, v * v * inverse
        rows[m, 3], rows[m, 4] = u * inverse, v * inverse
        rows[m, 5] = (u * u + v * v - 1.0) * inverse


@inner_kernel
def write_sums(
    rows: FloatArray, start: int, end: int, width: float, normal: FloatArray, right: FloatArray
) -> None:
    """Write the normal matrix and right side of a weighted linear fit to a part of the points."""
    n00 = n10 = n11 = n20 = n21 = n22 = n30 = n31 = n32 = n33 = 0.0
    n40 = n41 = n42 = n43 = n44 = r0 = r1 = r2 = r3 = r4 = 0.0
    for k in range(start, end):  # scalars: an array is read and written for each point
        a, b, c, d, e, f = (
            rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3], rows[k, 4], rows[k, 5],
        )  # fmt: skip
        ratio = f / width
        weight = 1.0 / (1.0 + ratio * ratio)
        wa, wb, wc, wd, we = weight * a, weight * b, weight * c, weight * d, weight * e
        n00, n10, n11 = n00 + wa * a, n10 + wb * a, n11 + wb * b
        n20, n21, n22 = n20 + wc * a, n21 + wc * b, n22 + wc * c
        n30, n31, n32, n33 = n30 + wd * a, n31 + wd * b, n32 + wd * c, n33 + wd * d
        n40, n41, n42, n43 = n40 + we * a, n41 + we * b, n42 + we * c, n43 + we * d
        n44 += we * e
        r0, r1, r2, r3, r4 = r0 - wa * f, r1 - wb * f, r2 - wc * f, r3 - wd * f, r4 - we * f
    normal[0, 0], normal[1, 0], normal[1, 1] = n00, n10, n11
    normal[2, 0], normal[2, 1], normal[2, 2] = n20, n21, n22
    normal[3, 0], normal[3, 1], normal[3, 2], normal[3, 3] = n30, n31, n32, n33
    normal[4, 0], normal[4, 1], normal[4, 2], normal[4, 3] = n40, n41, n42, n43
    normal[4, 4] = n44
    right[0], right[1], right[2], right[3], right[4] = r0, r1, r2, r3, r4


@kernel
def prediction_error(points: FloatArray, chosen: IntArray, ellipse: FloatArray) -> float:
    """Return how far a third of the support lies from where the other two thirds put the outline.

    The largest of three medians in pixels. The thirds follow each other along the outline, from
    its largest gap on, so that they do not depend on how the image is turned. The refit without a
    third is one linear step, robust as the scatter asks for.
    """
    count = len(chosen)
    frame, rows = np.empty((3, count)), np.empty((count, 6))
    write_frame(points, chosen, ellipse, frame)
    order = order_around(frame[2])
    write_rows(frame, order, after_largest_gap(frame, order), ellipse, rows)
    width = 2.0 * np.median(np.abs(rows[:, 5])) + LEAST_WIDTH
    first = (count + 1) // 3
    ends = (0, first, count - first, count)
    normals, rights = np.zeros((3, 5, 5)), np.zeros((3, 5))
    for part in range(3):
        write_sums(rows, ends[part], ends[part + 1], width, normals[part], rights[part])
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
    found: Supported,
    growth: float,
    weight: float,
    least: float,
) -> FloatArray:
    """Return the figures with less evidence where the support does not predict itself.

    What is lost is `weight` times the logarithm of `prediction_error` in pixels, that may grow as
    the scatter may, in proportion to the unsupported rest of the outline. An ellipse
    whose evidence is below `least` without any clutter is left as it is.
    """
    result = found.figures.copy()
    for k in range(len(result)):
        row = result[k]
        share = min(row[COVERAGE], row[TURN_COVERAGE])
        evidence = row[EVIDENCE] + doubt_of_clutter(share, row[ACROSS_EACH])
        if evidence >= least and share < MOST_COVERED:
            chosen = found.support[found.offsets[k] : found.offsets[k + 1]]
            error = prediction_error(points, chosen, found.ellipses[k])
            error /= 1.0 + growth * found.ellipses[k, 3]
            row[EVIDENCE] -= weight * (1.0 - share) * math.log(max(1.0, error))
    return result
