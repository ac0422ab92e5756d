"""Kernels of the `refined` scheme: what is known of each smooth arc."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import inlined_kernel, kernel
from geoprim_core.ecc.refined._kernels_fit import add_point

ROUNDING = 1.5 * 2.0**52  # a sum of this size has no room for a fraction
HALF_PI = (1.5707963267341256, 6.077100506506192e-11)  # a multiple of the first is exact
# Columns of the table of arcs, see `describe_arcs`: x, of points and normals y in the next.
MIDDLE, PLACES, INWARDS, CHORD, POLARITY, SAGITTA, SIZE, FIGURES = 0, 2, 8, 14, 16, 17, 18, 19
END_POINTS = 5  # of an arc that make its start, middle and end, at most

FAR = 1000.0  # radians, beyond which multiples of it are left to the library
# Chebyshev interpolation of sin(x) / x and cos(x) in x^2 on [0, pi / 4], within 4e-18.
SINE = (
    1.0,
    -0.16666666666666616,
    0.008333333333320233,
    -0.00019841269828549182,
    2.755731334131087e-06,
    -2.505071141796208e-08,
    1.58944094588123e-10,
)
COSINE = (
    1.0,
    -0.5,
    0.04166666666666645,
    -0.0013888888888860815,
    2.4801587283739277e-05,
    -2.755731306102868e-07,
    2.087557769018038e-09,
    -1.1353145914285752e-11,
)


@inlined_kernel
def turned_east(angle: float) -> tuple[float, float]:
    """Return cosine and sine of an angle within `FAR`, without a branch and without a call."""
    quarters = angle * (2.0 / math.pi) + ROUNDING - ROUNDING
    x = angle - quarters * HALF_PI[0] - quarters * HALF_PI[1]
    z = x * x
    s = SINE[3] + z * (SINE[4] + z * (SINE[5] + z * SINE[6]))
    s = x * (SINE[0] + z * (SINE[1] + z * (SINE[2] + z * s)))
    c = COSINE[4] + z * (COSINE[5] + z * (COSINE[6] + z * COSINE[7]))
    c = COSINE[0] + z * (COSINE[1] + z * (COSINE[2] + z * (COSINE[3] + z * c)))
    part = quarters - 4.0 * (0.25 * quarters + ROUNDING - ROUNDING)  # -2 .. 2
    odd = abs(part) == 1.0
    cos, sin = s if odd else c, c if odd else s
    cos = -cos if (part == 1.0) | (abs(part) == 2.0) else cos
    sin = -sin if (part == -1.0) | (abs(part) == 2.0) else sin
    return cos, sin


@kernel
def unit_vectors(angle: FloatArray) -> FloatArray:
    """Return the unit vectors (N, 2) at angles from +x."""
    vectors = np.empty((len(angle), 2))
    for k in range(len(angle)):
        vectors[k, 0], vectors[k, 1] = turned_east(angle[k])
    for k in range(len(angle)):
        if abs(angle[k]) > FAR:
            vectors[k, 0], vectors[k, 1] = math.cos(angle[k]), math.sin(angle[k])
    return vectors


@kernel
def describe_arcs(
    points: FloatArray,
    normals: FloatArray,
    order: IntArray,
    ends: IntArray,
) -> tuple[FloatArray, FloatArray]:
    """Return a table of arcs and their moments about their own middle point.

    Columns: `MIDDLE`; `PLACES`, the start, middle and end of the arc, each the mean of a few
    points; `INWARDS`, the inner normals there; `CHORD`, the normal of the chord, away from the
    arc; `POLARITY`, +1 where the gradient points inwards; `SAGITTA`, the height over the chord;
    `SIZE`, the number of points. The chord of a ring is the tangent at its start.
    """
    count = len(ends) - 1
    table = np.zeros((count, FIGURES))
    moments = np.zeros((count, 25))
    for i in range(count):
        low, high = ends[i], ends[i + 1]
        size = high - low
        start, end = order[low], order[high - 1]
        # Of an even number of points the middle is between two: the arc run backwards is the same.
        mid, other = order[low + size // 2], order[low + (size - 1) // 2]
        row = table[i]
        row[MIDDLE] = 0.5 * (points[mid, 0] + points[other, 0])
        row[MIDDLE + 1] = 0.5 * (points[mid, 1] + points[other, 1])
        for part in range(3):
            reach = min(END_POINTS, size // 3)
            if part == 1:
                reach += (size - reach) % 2
            at = (low, low + (size - reach) // 2, high - reach)[part]
            x = y = nx = ny = 0.0
            for k in range(at, at + reach):
                x += points[order[k], 0]
                y += points[order[k], 1]
                nx += normals[order[k], 0]
                ny += normals[order[k], 1]
            norm = math.hypot(nx, ny) + 1e-300
            place, inwards = PLACES + 2 * part, INWARDS + 2 * part
            row[place], row[place + 1] = x / reach, y / reach
            row[inwards], row[inwards + 1] = nx / norm, ny / norm
        cx = 0.5 * (points[start, 0] + points[end, 0]) - row[MIDDLE]
        cy = 0.5 * (points[start, 1] + points[end, 1]) - row[MIDDLE + 1]
        side = 1.0 if cx * row[INWARDS + 2] + cy * row[INWARDS + 3] > 0.0 else -1.0
        for k in range(INWARDS, INWARDS + 6):
            row[k] *= side
        row[POLARITY] = side
        dx = points[end, 0] - points[start, 0]
        dy = points[end, 1] - points[start, 1]
        length = math.hypot(dx, dy)
        if length > 1e-9:
            nx, ny = -dy / length, dx / length
            if nx * cx + ny * cy < 0.0:
                nx, ny = -nx, -ny
            row[CHORD], row[CHORD + 1] = nx, ny
            row[SAGITTA] = nx * cx + ny * cy
        else:
            row[SAGITTA] = math.hypot(cx, cy)
            row[CHORD], row[CHORD + 1] = cx / (row[SAGITTA] + 1e-300), cy / (row[SAGITTA] + 1e-300)
        row[SIZE] = size
        for k in range(low, high):
            add_point(
                moments[i], points[order[k], 0] - row[MIDDLE], points[order[k], 1] - row[MIDDLE + 1]
            )
    return table, moments


@kernel
def longest_first(table: FloatArray, min_sagitta: float) -> IntArray:
    """Return the arcs that are high enough: longest first, of those as long the highest first.

    Of those as high that which comes first in the table.
    """
    kept = np.flatnonzero(table[:, SAGITTA] >= min_sagitta)
    kept = kept[np.argsort(-table[kept, SAGITTA], kind="mergesort")]
    lengths = table[kept, SIZE].astype(np.int64)
    starts = np.zeros(lengths.max() + 2 if len(kept) > 0 else 2, np.int64)
    for length in lengths:
        starts[length] += 1
    for length in range(len(starts) - 2, -1, -1):
        starts[length] += starts[length + 1]
    order = np.empty_like(kept)
    for k in range(len(kept)):
        at = starts[lengths[k] + 1]
        order[at] = kept[k]
        starts[lengths[k] + 1] += 1
    return order


@kernel
def gather(
    indices: IntArray, ends: IntArray, table: FloatArray, moments: FloatArray, chosen: IntArray
) -> tuple[IntArray, IntArray, FloatArray, FloatArray]:
    """Return the indices of the chosen arcs, their offsets, table and moments."""
    offsets = np.zeros(len(chosen) + 1, np.int64)
    for k in range(len(chosen)):
        offsets[k + 1] = offsets[k] + ends[chosen[k] + 1] - ends[chosen[k]]
    result = np.empty(offsets[-1], np.int64)
    for k in range(len(chosen)):
        result[offsets[k] : offsets[k + 1]] = indices[ends[chosen[k]] : ends[chosen[k] + 1]]
    return result, offsets, table[chosen], moments[chosen]


@kernel
def chain_normals(points: FloatArray, offsets: IntArray, closed: BoolArray) -> FloatArray:
    """Return unit normals (N, 2) of contours from the points two before and after each."""
    normals = np.zeros((len(points), 2))
    for c in range(len(offsets) - 1):
        low, high = offsets[c], offsets[c + 1]
        size = high - low
        for k in range(low, high):
            i, j = max(low, k - 2), min(high - 1, k + 2)
            if closed[c]:
                i, j = low + (k - low - 2) % size, low + (k - low + 2) % size
            dx, dy = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
            length = math.hypot(dx, dy)
            if length > 0.0:
                normals[k, 0], normals[k, 1] = -dy / length, dx / length
            else:
                normals[k, 0] = 1.0
    return normals
