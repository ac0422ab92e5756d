"""Kernels of step 2 of the `refined` scheme: candidates from single arcs and pairs of arcs."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.ecc._kernels_refined_fit import add_shifted, fit_moments, offset_of
from geoprim_core.fitting._kernels_shape import perimeter_of


@kernel
def sees(a: FloatArray, b: FloatArray, slack: float) -> bool:
    """Tell whether arc b lies in the search region of arc a, give or take `slack` pixels.

    An arc that continues the ellipse of `a` lies on the inner side of its tangents at both ends
    and in the middle, and beyond the chord.
    """
    for k in range(3):
        x = b[2 + 2 * k]
        y = b[3 + 2 * k]
        if (x - a[2]) * a[14] + (y - a[3]) * a[15] < -slack:
            return False
        for j in range(3):
            inside = (x - a[2 + 2 * j]) * a[8 + 2 * j] + (y - a[3 + 2 * j]) * a[9 + 2 * j]
            if inside < -slack:
                return False
    return True


@kernel
def arc_rms(
    points: FloatArray,
    order: IntArray,
    low: int,
    high: int,
    ellipse: FloatArray,
    cos: float,
    sin: float,
    normal: FloatArray,
) -> float:
    """Return the root mean square distance of about 12 points of an arc to an ellipse.

    Infinite when the arc bends away from the ellipse: `normal` is its inner normal amidst.
    """
    size = high - low
    count = min(12, size)
    mid = order[low + size // 2]
    d, nx, ny = offset_of(ellipse, cos, sin, points[mid, 0], points[mid, 1])
    if nx * normal[0] + ny * normal[1] > -0.9:
        return math.inf
    total = 0.0
    for k in range(count):
        p = order[low + (k * (size - 1)) // (count - 1)]
        d, nx, ny = offset_of(ellipse, cos, sin, points[p, 0], points[p, 1])
        total += d * d
    return math.sqrt(total / count)


@kernel
def fit_arcs(
    points: FloatArray,
    order: IntArray,
    ends: IntArray,
    table: FloatArray,
    moments: FloatArray,
    i: int,
    j: int,
    max_rms: float,
    max_size: float,
    work: FloatArray,
    ellipse: FloatArray,
) -> float:
    """Fit one arc (j < 0) or two; return the worse rms of both, infinite where they do not fit."""
    x, y = table[i, 0], table[i, 1]
    size = table[i, 19]
    if j >= 0:
        x, y = 0.5 * (x + table[j, 0]), 0.5 * (y + table[j, 1])
        gap = math.hypot(table[i, 0] - x, table[i, 1] - y)
        size = gap + max(size, table[j, 19])
    scale = 1.0 / size
    work[:] = 0.0
    add_shifted(work, moments[i], table[i, 0] - x, table[i, 1] - y, scale)
    if j >= 0:
        add_shifted(work, moments[j], table[j, 0] - x, table[j, 1] - y, scale)
    if not fit_moments(work, x, y, scale, ellipse):
        return math.inf
    if ellipse[2] > max_size or ellipse[3] < 2.0:
        return math.inf
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    rms = arc_rms(points, order, ends[i], ends[i + 1], ellipse, cos, sin, table[i, 10:12])
    if j >= 0 and rms < max_rms:
        other = arc_rms(points, order, ends[j], ends[j + 1], ellipse, cos, sin, table[j, 10:12])
        rms = max(rms, other)
    return rms if rms < max_rms else math.inf


@kernel
def grid_of(
    table: FloatArray, width: float, height: float, cell: float
) -> tuple[int, int, IntArray, IntArray]:
    """Sort arcs into square cells by their middle: arcs by cell, and where each cell starts."""
    columns = int(width // cell) + 1
    rows = int(height // cell) + 1
    count = len(table)
    where = np.empty(count, np.int64)
    starts = np.zeros(columns * rows + 1, np.int64)
    for i in range(count):
        cx = min(columns - 1, max(0, int(table[i, 0] // cell)))
        cy = min(rows - 1, max(0, int(table[i, 1] // cell)))
        where[i] = cy * columns + cx
        starts[where[i] + 1] += 1
    for k in range(columns * rows):
        starts[k + 1] += starts[k]
    members = np.empty(count, np.int64)
    fill = starts[:-1].copy()
    for i in range(count):
        members[fill[where[i]]] = i
        fill[where[i]] += 1
    return columns, rows, starts, members


@kernel
def pair_arcs(
    points: FloatArray,
    order: IntArray,
    ends: IntArray,
    table: FloatArray,
    moments: FloatArray,
    width: float,
    height: float,
    slack: float,
    max_rms: float,
    min_share: float,
    max_size: float,
    signed: bool,
    max_pairs: int,
) -> tuple[IntArray, FloatArray, int]:
    """Return candidates (arc, arc or -1, rank, ellipse) and the number of pairs looked at.

    Two arcs make a candidate when each lies in the other's search region and one ellipse fits
    both. Arcs further apart than an ellipse of which they are a share `min_share` are not looked
    at; arcs come longest first, so that a limit on the pairs drops the shortest.
    """
    count = len(table)
    cell = 48.0
    columns, rows, starts, members = grid_of(table, width, height, cell)
    arcs = np.empty((1024, 2), np.int64)
    values = np.empty((1024, 6))
    found = 0
    work = np.empty(25)
    ellipse = np.empty(5)
    looked = 0
    for i in range(count):
        a = table[i]
        reach = a[18] / min_share
        low_x = max(0, int((a[0] - reach) // cell))
        high_x = min(columns - 1, int((a[0] + reach) // cell))
        low_y = max(0, int((a[1] - reach) // cell))
        high_y = min(rows - 1, int((a[1] + reach) // cell))
        for cy in range(low_y, high_y + 1):
            for at in range(starts[cy * columns + low_x], starts[cy * columns + high_x + 1]):
                j = members[at]
                if j < i:
                    continue
                looked += 1
                if looked > max_pairs:
                    return arcs[:found].copy(), values[:found].copy(), looked
                b = table[j]
                points_of = a[18]
                if j > i:
                    points_of += b[18]
                    if signed and a[16] != b[16]:
                        continue
                    near = 0.5 * points_of / min_share
                    dx, dy = a[0] - b[0], a[1] - b[1]
                    if dx * dx + dy * dy > near * near:
                        continue
                    if not (sees(a, b, slack) and sees(b, a, slack)):
                        continue
                partner = j if j > i else -1
                rms = fit_arcs(
                    points,
                    order,
                    ends,
                    table,
                    moments,
                    i,
                    partner,
                    max_rms,
                    max_size,
                    work,
                    ellipse,
                )
                if not rms < max_rms:
                    continue
                if points_of < min_share * perimeter_of(ellipse[2], ellipse[3]):
                    continue
                if found == len(arcs):
                    arcs = np.concatenate((arcs, np.empty_like(arcs)))
                    values = np.concatenate((values, np.empty_like(values)))
                arcs[found, 0], arcs[found, 1] = i, partner
                values[found, 0] = points_of / (0.15 + rms)
                values[found, 1:] = ellipse
                found += 1
    return arcs[:found].copy(), values[:found].copy(), looked
