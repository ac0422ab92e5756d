"""Kernels of the methods that look at a window of 2 Q + 1 pixels about the pixel of interest.

A window holds coordinates relative to its middle pixel, so a shift changes nothing. Sums go over
the pairs of pixels at -q and q, which makes a reversed curve give the same bits.
"""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel

REGRESSION, EXPLICIT, IMPLICIT, INDEPENDENT, GAUSSIAN, MEDIAN = range(6)
PIVOT = 1e-10  # a smaller share of a normal equation's diagonal: too few different abscissae
CROSSWISE = 1e-9  # cosine of a fitted line that runs across the direction of travel


@kernel
def _gather(
    curve: FloatArray, i: int, half: int, x: FloatArray, y: FloatArray
) -> tuple[float, float]:
    """Fill a window, across the seam where needed; return the way of travel, sum of q p(q)."""
    count = len(curve)
    x0, y0 = curve[i, 0], curve[i, 1]
    x[half] = y[half] = tx = ty = 0.0
    for q in range(1, half + 1):
        b, a = i - q, i + q
        if b < 0:
            b += count
        if a >= count:
            a -= count
        x[half - q], y[half - q] = curve[b, 0] - x0, curve[b, 1] - y0
        x[half + q], y[half + q] = curve[a, 0] - x0, curve[a, 1] - y0
        tx += q * (x[half + q] - x[half - q])
        ty += q * (y[half + q] - y[half - q])
    return tx, ty


@kernel
def _solve(moments: FloatArray, right: FloatArray, order: int, lower: FloatArray) -> int:
    """Solve the normal equations of powers 0 .. order in place of `right`, by L D L^T.

    The order that the abscissae fix is returned; coefficients above it are 0.
    """
    fixed = order
    for i in range(order + 1):
        for j in range(i + 1):
            value = moments[i + j]
            for k in range(j):
                value -= lower[i, k] * lower[j, k] * lower[k, k]
            lower[i, j] = value if i == j else value / lower[j, j]
        if lower[i, i] <= PIVOT * moments[2 * i]:
            fixed = i - 1
            break
    for i in range(order + 1):
        if i > fixed:
            right[i] = 0.0
        for k in range(min(i, fixed + 1)):
            if i <= fixed:
                right[i] -= lower[i, k] * right[k]
    for i in range(fixed, -1, -1):
        right[i] /= lower[i, i]
        for k in range(i + 1, fixed + 1):
            right[i] -= lower[k, i] * right[k]
    return fixed


@kernel
def _polynomial(
    x: FloatArray, y: FloatArray, half: int, order: int, cos: float, sin: float, lower: FloatArray
) -> tuple[float, float]:
    """Return v' and v'' at the middle pixel of the polynomial v(u) of least squares.

    u runs along (cos, sin), v along the same direction turned from +x towards +y.
    """
    scale = 0.0
    for i in range(2 * half + 1):
        scale = max(scale, abs(x[i] * cos + y[i] * sin))
    if scale == 0.0:
        return math.nan, math.nan
    moments, right = np.zeros(11), np.zeros(6)
    moments[0] = 1.0
    for q in range(1, half + 1):
        b, a = half - q, half + q
        ub, ua = (x[b] * cos + y[b] * sin) / scale, (x[a] * cos + y[a] * sin) / scale
        vb, va = y[b] * cos - x[b] * sin, y[a] * cos - x[a] * sin
        pb = pa = 1.0
        for k in range(2 * order + 1):
            moments[k] += pb + pa
            if k <= order:
                right[k] += pb * vb + pa * va
            pb *= ub
            pa *= ua
    if _solve(moments, right, order, lower) < 1:
        return math.nan, math.nan
    return right[1] / scale, 2.0 * right[2] / scale**2


@kernel
def _through_middle(
    x: FloatArray, y: FloatArray, half: int, cos: float, sin: float
) -> tuple[float, float]:
    """Return v' and v'' of the parabola v' u + v'' u^2 / 2 of least squares; as `_polynomial`."""
    a = b = c = g = h = 0.0
    for q in range(1, half + 1):
        i, j = half - q, half + q
        ui, uj = x[i] * cos + y[i] * sin, x[j] * cos + y[j] * sin
        vi, vj = y[i] * cos - x[i] * sin, y[j] * cos - x[j] * sin
        a += ui * ui + uj * uj
        b += 0.5 * (ui * ui * ui + uj * uj * uj)
        c += 0.25 * (ui * ui * ui * ui + uj * uj * uj * uj)
        g += ui * vi + uj * vj
        h += 0.5 * (ui * ui * vi + uj * uj * vj)
    if a == 0.0:
        return math.nan, math.nan
    divisor = a * c - b * b
    if divisor <= PIVOT * a * c:
        return g / a, math.nan
    return (c * g - b * h) / divisor, (a * h - b * g) / divisor


@kernel
def _principal_axis(x: FloatArray, y: FloatArray, half: int) -> tuple[float, float]:
    """Return the unit vector along which the window spreads most, or zeros for none."""
    count = 2 * half + 1
    mx, my = np.sum(x[:count]) / count, np.sum(y[:count]) / count
    xx = xy = yy = 0.0
    for q in range(half + 1):
        b, a = half - q, half + q
        weight = 0.5 if q == 0 else 1.0
        xx += weight * ((x[b] - mx) ** 2 + (x[a] - mx) ** 2)
        xy += weight * ((x[b] - mx) * (y[b] - my) + (x[a] - mx) * (y[a] - my))
        yy += weight * ((y[b] - my) ** 2 + (y[a] - my) ** 2)
    spread = math.hypot(xx - yy, 2.0 * xy)
    if spread <= CROSSWISE * (xx + yy):
        return 0.0, 0.0
    dx, dy = (xx - yy) + spread, 2.0 * xy
    if xx < yy:
        dx, dy = 2.0 * xy, (yy - xx) + spread
    length = math.hypot(dx, dy)
    return dx / length, dy / length


@kernel
def _fit(
    x: FloatArray, y: FloatArray, half: int, order: int, tx: float, ty: float, cos: float,
    sin: float, lower: FloatArray,
) -> tuple[float, float, float]:  # fmt: skip
    """Return the direction and curvature of a fit v(u), u being the axis in the way of travel.

    Order 0 stands for the parabola through the middle pixel.
    """
    along = cos * tx + sin * ty
    if abs(along) <= CROSSWISE * math.hypot(tx, ty):
        return math.nan, math.nan, math.nan
    if along < 0.0:
        cos, sin = -cos, -sin
    if order == 0:
        first, second = _through_middle(x, y, half, cos, sin)
    else:
        first, second = _polynomial(x, y, half, order, cos, sin, lower)
        if order == 1:
            second = math.nan
    norm = math.sqrt(1.0 + first * first)
    return (cos - first * sin) / norm, (sin + first * cos) / norm, second / norm**3


@kernel
def _on_longer_axis(
    x: FloatArray, y: FloatArray, half: int, order: int, tx: float, ty: float, lower: FloatArray
) -> tuple[float, float, float]:
    """Return `_fit` of y(x) or x(y), whichever axis the window extends on; of both on a tie."""
    count = 2 * half + 1
    wide = np.max(x[:count]) - np.min(x[:count])
    high = np.max(y[:count]) - np.min(y[:count])
    if wide > high:
        return _fit(x, y, half, order, tx, ty, 1.0, 0.0, lower)
    if wide < high:
        return _fit(x, y, half, order, tx, ty, 0.0, 1.0, lower)
    ax, ay, a = _fit(x, y, half, order, tx, ty, 1.0, 0.0, lower)
    bx, by, b = _fit(x, y, half, order, tx, ty, 0.0, 1.0, lower)
    if math.isnan(ax) or math.isnan(bx):
        return (bx, by, b) if math.isnan(ax) else (ax, ay, a)
    if math.hypot(ax + bx, ay + by) <= CROSSWISE:
        return math.nan, math.nan, math.nan
    return ax + bx, ay + by, 0.5 * (a + b)


@kernel
def _by_index(x: FloatArray, y: FloatArray, half: int, sigma: float) -> tuple[float, float, float]:
    """Return direction and curvature from x(q) and y(q), each on its own; odd sums of q vanish.

    sigma 0: parabolas of least squares through the middle pixel. Otherwise the first two
    derivatives of the curve smoothed by a Gaussian, scaled so that they are exact on parabolas.
    """
    x0 = y0 = x1 = y1 = x2 = y2 = m2 = m4 = 0.0
    m0 = 1.0
    for q in range(1, half + 1):
        weight = 1.0 if sigma == 0.0 else math.exp(-0.5 * (q / sigma) ** 2)
        b, a = half - q, half + q
        x0 += weight * (x[a] + x[b])
        y0 += weight * (y[a] + y[b])
        x1 += weight * q * (x[a] - x[b])
        y1 += weight * q * (y[a] - y[b])
        x2 += weight * q * q * (x[a] + x[b])
        y2 += weight * q * q * (y[a] + y[b])
        m0 += 2.0 * weight
        m2 += 2.0 * weight * q * q
        m4 += 2.0 * weight * q**4
    mean = 0.0 if sigma == 0.0 else m2 / m0
    divisor = 0.5 * (m4 - mean * m2)
    x1, y1, x2, y2 = x1 / m2, y1 / m2, (x2 - mean * x0) / divisor, (y2 - mean * y0) / divisor
    speed = math.hypot(x1, y1)
    if speed == 0.0:
        return math.nan, math.nan, math.nan
    return x1, y1, (x1 * y2 - y1 * x2) / speed**3


@kernel
def _put_in_place(values: FloatArray, count: int, rank: int) -> None:
    """Move values so that the one of a rank is at its place and no larger one is before it."""
    low, high = 0, count - 1
    while low < high:
        pivot = values[(low + high) // 2]
        i, j = low, high
        while i <= j:
            while values[i] < pivot:
                i += 1
            while values[j] > pivot:
                j -= 1
            if i <= j:
                values[i], values[j] = values[j], values[i]
                i += 1
                j -= 1
        if rank <= j:
            high = j
        elif rank >= i:
            low = i
        else:
            return


@kernel
def _median(
    x: FloatArray, y: FloatArray, half: int, tx: float, ty: float, turns: FloatArray
) -> tuple[float, float, float]:
    """Return the median direction from the pixels before to the middle and on to those behind.

    Directions are compared by c / (|c| + |s|) with c, s across and along the way of travel,
    unfolded to -2 .. 2: it grows with the angle. One that points straight back has no side.
    """
    length = math.hypot(tx, ty)
    ux, uy = tx / length, ty / length
    for q in range(1, half + 1):
        for side in range(2):
            sign = -1.0 if side == 0 else 1.0
            k = half - q if side == 0 else half + q
            dx, dy = sign * x[k], sign * y[k]
            s, c = ux * dx + uy * dy, ux * dy - uy * dx
            total = abs(s) + abs(c)
            turn = 0.0
            if s >= 0.0 and total > 0.0:
                turn = c / total
            elif abs(c) > CROSSWISE * total:
                turn = math.copysign(2.0, c) - c / total
            turns[2 * q - 2 + side] = turn
    _put_in_place(turns, 2 * half, half - 1)
    dx = dy = 0.0
    for turn in (turns[half - 1], np.min(turns[half : 2 * half])):
        c, s = turn, 1.0 - abs(turn)
        if abs(turn) > 1.0:
            c = math.copysign(2.0, turn) - turn
        norm = math.hypot(c, s)
        dx += (ux * s - uy * c) / norm
        dy += (uy * s + ux * c) / norm
    if math.hypot(dx, dy) <= CROSSWISE:
        return math.nan, math.nan, math.nan
    return dx, dy, math.nan


@kernel
def window_tangents(
    points: FloatArray, offsets: IntArray, closed: BoolArray, halves: IntArray, method: int,
    order: int,
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Return the direction of travel and the curvature at every pixel, NaN where undefined."""
    angle, curvature = np.full(len(points), np.nan), np.full(len(points), np.nan)
    most = np.max(halves) if len(halves) else 0
    x, y = np.empty(2 * most + 1), np.empty(2 * most + 1)
    turns, lower = np.empty(2 * most), np.empty((6, 6))
    for k in range(len(offsets) - 1):
        curve = points[offsets[k] : offsets[k + 1]]
        count = len(curve)
        for i in range(count):
            half = halves[offsets[k] + i]
            outside = 2 * half >= count if closed[k] else (i < half or i + half >= count)
            if half < 1 or outside:
                continue
            tx, ty = _gather(curve, i, half, x, y)
            if tx == 0.0 and ty == 0.0:
                continue
            if method == REGRESSION:
                cos, sin = _principal_axis(x, y, half)
                dx, dy, bend = _fit(x, y, half, order, tx, ty, cos, sin, lower)
            elif method == EXPLICIT or method == IMPLICIT:
                dx, dy, bend = _on_longer_axis(x, y, half, order, tx, ty, lower)
            elif method == MEDIAN:
                dx, dy, bend = _median(x, y, half, tx, ty, turns)
            else:
                sigma = half / 3.0 if method == GAUSSIAN else 0.0
                dx, dy, bend = _by_index(x, y, half, sigma)
            if not math.isnan(dx):
                found = math.atan2(dy, dx)
                angle[offsets[k] + i] = found if found > -math.pi else math.pi
                curvature[offsets[k] + i] = bend
    return angle, curvature
