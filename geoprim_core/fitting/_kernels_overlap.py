"""Kernels for the exact overlap of two ellipses, each a row x, y, semi_major, semi_minor, angle.

One ellipse is mapped to the unit circle. Along it the other one's implicit function is a
trigonometric polynomial of degree two; its at most four roots are the common points of both
outlines. Between neighbouring common points the outline of the intersection is the inner of
the two arcs, and Green's theorem gives its share of the area in closed form. Both arcs start
and end at the same two points, so a root that is badly conditioned (outlines that touch or
coincide) moves the area by no more than the sliver between the outlines.
"""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import inner_kernel, kernel

_SMALLEST_CELL = 1e-7  # half-width in radians below which roots are no longer told apart
_EIGHTH = math.pi / 4
_TINY_ARC = 1e-6  # an arc this short may run backwards by rounding, but is no full turn


@inner_kernel
def overlap_bound(a: FloatArray, b: FloatArray) -> float:
    """Return a quick upper bound of the overlap ratio, 0 when the ellipses are surely apart."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    reach = a[2] + b[2]
    if dx * dx + dy * dy >= reach * reach:
        return 0.0
    first, second = a[2] * a[3], b[2] * b[3]
    return float(min(first, second) / max(first, second))


@inner_kernel
def _value(c: FloatArray, t: float) -> float:
    cos, sin = math.cos(t), math.sin(t)
    even, odd = cos * cos - sin * sin, 2 * cos * sin
    return float(c[0] + c[1] * cos + c[2] * sin + c[3] * even + c[4] * odd)


@inner_kernel
def _slope(c: FloatArray, t: float) -> float:
    cos, sin = math.cos(t), math.sin(t)
    even, odd = cos * cos - sin * sin, 2 * cos * sin
    return float(c[2] * cos - c[1] * sin + 2 * (c[4] * even - c[3] * odd))


@inner_kernel
def _root(c: FloatArray, low: float, high: float) -> float:
    """Return the root in a bracket whose ends have opposite signs (Newton, kept by bisection)."""
    falling = _value(c, low) > 0.0
    t = 0.5 * (low + high)
    for _ in range(60):
        value = _value(c, t)
        if (value > 0.0) == falling:
            low = t
        else:
            high = t
        slope = _slope(c, t)
        following = t - value / slope if slope != 0.0 else low
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - t) < 1e-15:
            break
        t = following
    return t


@kernel
def _roots(c: FloatArray, roots: FloatArray) -> int:
    """Write the simple roots of the polynomial in [0, 2 pi) in rising order; return their number.

    Cells are halved until a Taylor bound shows that one holds no root or is monotonic.
    """
    bend = math.hypot(c[1], c[2]) + 4.0 * math.hypot(c[3], c[4])
    stack = np.empty((64, 2))
    size, count = 0, 0
    for i in range(7, -1, -1):
        stack[size, 0], stack[size, 1] = i * _EIGHTH, (i + 1) * _EIGHTH
        size += 1
    while size > 0 and count < 4:
        size -= 1
        low, high = stack[size, 0], stack[size, 1]
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        value, slope = _value(c, middle), _slope(c, middle)
        if abs(value) > abs(slope) * half + 0.5 * bend * half * half:
            continue
        if abs(slope) > bend * half or half < _SMALLEST_CELL:
            end = high if high < 8 * _EIGHTH else 0.0  # the same sign on both sides of the seam
            if (_value(c, low) > 0.0) != (_value(c, end) > 0.0):
                roots[count] = _root(c, low, high)
                count += 1
            continue
        stack[size, 0], stack[size, 1] = middle, high
        stack[size + 1, 0], stack[size + 1, 1] = low, middle
        size += 2
    return count


@kernel
def intersection_area(a: FloatArray, b: FloatArray) -> float:
    """Return the area in square pixels that two ellipses (5,) share."""
    ca, sa, cb, sb = math.cos(a[4]), math.sin(a[4]), math.cos(b[4]), math.sin(b[4])
    dx, dy = b[0] - a[0], b[1] - a[1]
    # Ellipse b in the frame where a is the unit circle: x0 + p cos u + q sin u.
    x0, y0 = (ca * dx + sa * dy) / a[2], (ca * dy - sa * dx) / a[3]
    turn_cos, turn_sin = ca * cb + sa * sb, ca * sb - sa * cb
    px, py = b[2] * turn_cos / a[2], b[2] * turn_sin / a[3]
    qx, qy = -b[3] * turn_sin / a[2], b[3] * turn_cos / a[3]
    det = px * qy - py * qx
    # The unit circle in the frame where b is one: w + e cos t + f sin t.
    wx, wy = (qx * y0 - qy * x0) / det, (py * x0 - px * y0) / det
    ex, ey, fx, fy = qy / det, -py / det, -qx / det, px / det
    c = np.empty(5)
    ee, ff = ex * ex + ey * ey, fx * fx + fy * fy
    c[0] = wx * wx + wy * wy - 1.0 + 0.5 * (ee + ff)
    c[1], c[2] = 2.0 * (wx * ex + wy * ey), 2.0 * (wx * fx + wy * fy)
    c[3], c[4] = 0.5 * (ee - ff), ex * fx + ey * fy
    roots = np.empty(4)
    rounding = 1e-14 * (1.0 + wx * wx + wy * wy + ee + ff)
    same = abs(c[0]) + abs(c[1]) + abs(c[2]) + abs(c[3]) + abs(c[4]) <= rounding
    count = 0 if same else _roots(c, roots)
    unit = a[2] * a[3]
    if count < 2:
        if c[0] <= 0.0:  # the outline of a is inside b on the mean, so everywhere
            return float(math.pi * unit)
        return math.pi * unit * min(1.0, det) if x0 * x0 + y0 * y0 < 1.0 else 0.0
    twice = 0.0
    for i in range(count):
        start = roots[i]
        stop = roots[i + 1] if i + 1 < count else roots[0] + 2.0 * math.pi
        # Of two places: where the outlines touch, which can be at one of them, the sign is noise.
        one = _value(c, start + (stop - start) / 3.0)
        other = _value(c, stop - (stop - start) / 3.0)
        if (one if abs(one) > abs(other) else other) <= 0.0:
            twice += stop - start
            continue
        x1, y1, x2, y2 = math.cos(start), math.sin(start), math.cos(stop), math.sin(stop)
        u1 = math.atan2(wy + ey * x1 + fy * y1, wx + ex * x1 + fx * y1)
        u2 = math.atan2(wy + ey * x2 + fy * y2, wx + ex * x2 + fx * y2)
        if u2 < u1 - _TINY_ARC or (u2 < u1 and stop - start > _TINY_ARC):
            u2 += 2.0 * math.pi
        elif u2 - u1 > math.pi and stop - start <= _TINY_ARC:
            u2 -= 2.0 * math.pi  # backwards across the seam of atan2, by rounding
        twice += det * (u2 - u1) + x0 * (y2 - y1) - y0 * (x2 - x1)
    return float(0.5 * unit * twice)


@kernel
def overlap_of(a: FloatArray, b: FloatArray) -> float:
    """Return the area Jaccard index of two ellipses (5,), in [0, 1]."""
    if overlap_bound(a, b) == 0.0:
        return 0.0
    common = intersection_area(a, b)
    union = math.pi * (a[2] * a[3] + b[2] * b[3]) - common
    return float(min(1.0, max(0.0, common / union)))


@kernel
def overlap_table(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return the overlap ratio (n, m) of every pair of ellipses (n, 5) and (m, 5)."""
    table = np.empty((len(first), len(second)))
    for i in range(len(first)):
        for j in range(len(second)):
            table[i, j] = overlap_of(first[i], second[j])
    return table
