"""Kernels that list the edge pixels with their sub-pixel positions."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from geoprim_core._jit import inner_kernel, kernel

SUBPIXEL_STEPS = 256.0
ROUNDING = 1.5 * 2.0**52  # a sum of this size has no room for a fraction
MARGIN = 2  # columns to the right of the index image and rows below it that hold no edge
NONE = 0xFFFFFFFF
"""No pixel. Indices are unsigned: numba then does not ask at each use whether they count from
the end, which is a third of the time of a kernel that follows links."""
TAN_22_5 = math.sqrt(2.0) - 1.0
# Chebyshev interpolation of atan(z) / z in z^2, lowest power first.
ATAN = (
    0.999999999978,
    -0.333333320976,
    0.199998838568,
    -0.14281588777,
    0.110404892653,
    -0.0845619304357,
    0.0470734838305,
)
CHUNK = 512  # pixels
OX, OY, NX, NY = range(4)  # columns of the edge table: offset, unit gradient


@inner_kernel
def rounded(value: Any) -> Any:
    """Return a number within 0.5 as the nearest multiple of 1/256, of two the even one.

    A call of rint costs ten times as much.
    """
    fine = (value * SUBPIXEL_STEPS + ROUNDING - ROUNDING) / SUBPIXEL_STEPS
    fine = 0.5 if fine > 0.5 else fine
    return -0.5 if fine < -0.5 else fine


@kernel
def look_around(
    flat: Any, first: Any, last: Any, dx: Any, dy: Any, xs: Any, ys: Any, around: Any
) -> None:
    """Write x, y of some pixels and, to `around` (6, n), three gradients of each.

    They are its own and those one step up and one step down the row or the column, whichever is
    nearer to the gradient, or the diagonal where that is the gradient's direction; at the border
    its own three times.
    """
    height, width = dx.shape
    along_x, along_y = dx.ravel(), dy.ravel()
    y = flat[first] // width
    end = np.int64((y + 1) * width)
    for k in range(first, last):
        place = np.int64(flat[k])
        while place >= end:
            y += 1
            end += width
        x = place - end + width
        xs[k] = x
        ys[k] = y
        gx, gy = along_x[np.uint64(place)], along_y[np.uint64(place)]
        along = 1 if gx >= 0.0 else -1
        across = width if gy >= 0.0 else -width
        step = (along if abs(gx) >= abs(gy) else 0) + (across if abs(gy) >= abs(gx) else 0)
        inside = (x > 0) & (y > 0) & (x < width - 1) & (y < height - 1)
        step = step if inside else 0
        up, down = np.uint64(place + step), np.uint64(place - step)
        c = k - first
        around[0, c], around[1, c] = gx, gy
        around[2, c], around[3, c] = along_x[up], along_y[up]
        around[4, c], around[5, c] = along_x[down], along_y[down]


@inner_kernel
def length(gx: Any, gy: Any) -> Any:
    """Return the length of a vector of single precision in double precision."""
    x, y = np.float64(gx), np.float64(gy)
    return math.sqrt(x * x + y * y)


@inner_kernel
def crests(around: Any, rows: Any, lengths: Any, centred: Any) -> None:
    """Write offset and unit gradient to `rows` (4, n), and whether the pixel is the largest.

    The three magnitudes are written to `lengths` (3, n).

    The body has no branches and no calls, so that it compiles to vector instructions.
    """
    own_x, own_y, up_x, up_y, down_x, down_y = (
        around[0], around[1], around[2], around[3], around[4], around[5],
    )  # fmt: skip
    heres, ups, downs = lengths[0], lengths[1], lengths[2]
    for c in range(len(centred)):
        gx, gy = np.float64(own_x[c]), np.float64(own_y[c])
        here = math.sqrt(gx * gx + gy * gy)
        x, y = np.float64(up_x[c]), np.float64(up_y[c])
        up = math.sqrt(x * x + y * y)
        x, y = np.float64(down_x[c]), np.float64(down_y[c])
        down = math.sqrt(x * x + y * y)
        scale = here if here > 0.0 else 1.0
        nx = np.float32((gx if here > 0.0 else 1.0) / scale)
        ny = np.float32(gy / scale)
        bend = 2.0 * here - up - down
        shift = 0.5 * (up - down) / bend
        shift = 0.5 if shift > 0.5 else shift
        shift = -0.5 if shift < -0.5 else shift
        # From the axis to the foot on the gradient line.
        foot = np.float64(abs(nx) if abs(gx) >= abs(gy) else abs(ny))
        shift = shift * (foot + foot if abs(gx) == abs(gy) else foot)
        shift = shift if bend > 0.0 else 0.0
        rows[OX, c] = (shift * nx * SUBPIXEL_STEPS + ROUNDING - ROUNDING) / SUBPIXEL_STEPS
        rows[OY, c] = (shift * ny * SUBPIXEL_STEPS + ROUNDING - ROUNDING) / SUBPIXEL_STEPS
        rows[NX, c] = nx
        rows[NY, c] = ny
        heres[c] = here
        ups[c] = up
        downs[c] = down
        centred[c] = (up <= here) & (down <= here)


@kernel
def recentre(
    around: Any,
    lengths: Any,
    centred: Any,
    first: Any,
    xs: Any,
    ys: Any,
    dx: Any,
    dy: Any,
    rows: Any,
) -> None:
    """Write the offsets where the crest crosses the axis nearer to a neighbour of the pixel."""
    height, width = dx.shape
    along_x, along_y = dx.ravel(), dy.ravel()
    waiting = np.empty(len(centred), np.uint32)
    size = np.uint64(0)
    for c in range(len(centred)):
        waiting[size] = c
        size += np.uint64(not centred[c])
    for c in waiting[:size]:
        gx, gy = around[0, c], around[1, c]
        here, up, down = lengths[0, c], lengths[1, c], lengths[2, c]
        way = 1 if up > here else -1
        level, steep = abs(gx) >= abs(gy), abs(gy) >= abs(gx)
        x = np.int64(xs[first + c]) + (2 * (way if gx >= 0.0 else -way) if level else 0)
        y = np.int64(ys[first + c]) + (2 * (way if gy >= 0.0 else -way) if steep else 0)
        if (x < 0) | (y < 0) | (x >= width) | (y >= height):
            continue
        far = np.uint64(y * width + x)
        beyond = length(along_x[far], along_y[far])
        middle = up if way == 1 else down
        after = beyond if way == 1 else here
        before = here if way == 1 else beyond
        bend = 2.0 * middle - after - before
        shift = 0.5 * (after - before) / bend
        shift = 0.5 if shift > 0.5 else shift
        shift = -0.5 if shift < -0.5 else shift
        nx, ny = rows[NX, c], rows[NY, c]
        shift = (way + shift) * ((abs(nx) if level else 0.0) + (abs(ny) if steep else 0.0))
        shift = shift if bend > 0.0 else 0.0
        rows[OX, c] = rounded(shift * nx)
        rows[OY, c] = rounded(shift * ny)


@kernel
def locate(flat: Any, dx: Any, dy: Any, index: Any) -> Any:
    """Return x, y (N,), the edge table (N, 4) and magnitudes (N,) of pixels at rising flat indices.

    The index image (H + 2, W + 2) uint32 is filled in: it holds the place of a pixel in the list,
    `NONE` where there is no edge; with its margin, flat steps of up to two pixels onwards stay
    inside it and meet no pixel round the border. The table holds sub-pixel offsets and unit
    gradients, float32.

    The crest of the magnitude along the row or the column, whichever is nearer to the gradient
    (between both the diagonal, so that a turned image has the turned table), is the vertex of a
    parabola through three pixels; the offset leads to the foot on the gradient line, in multiples
    of 1/256 px and within half a pixel in each coordinate. (A parabola along the gradient itself
    would need interpolated magnitudes: that triples the error on thin lines.)
    """
    count = len(flat)
    xs = np.empty(count, np.int32)
    ys = np.empty(count, np.int32)
    table = np.empty((count, 4), np.float32)
    magnitudes = np.empty(count, np.float32)
    around = np.empty((6, CHUNK), np.float32)
    rows = np.empty((4, CHUNK), np.float32)
    lengths = np.empty((3, CHUNK))
    centred = np.empty(CHUNK, np.bool_)
    places = index.ravel()
    index[:] = NONE
    for first in range(0, count, CHUNK):  # so few that they stay in the cache
        last = min(first + CHUNK, count)
        look_around(flat, first, last, dx, dy, xs, ys, around)
        crests(around, rows, lengths, centred[: last - first])
        recentre(around, lengths, centred[: last - first], first, xs, ys, dx, dy, rows)
        for k in range(first, last):
            places[np.uint64(np.int64(flat[k]) + ys[k] * MARGIN)] = k
            for column in range(4):
                table[k, column] = rows[column, k - first]
            magnitudes[k] = lengths[0, k - first]
    return xs, ys, table, magnitudes


@kernel
def magnitudes_at(points: Any, index: Any, magnitudes: Any) -> Any:
    """Return the magnitude of the gradient at every point (N,) float64.

    A pixel that was put in between two edge pixels has that of the higher one beside it.
    """
    result = np.empty(len(points))
    for k in range(len(points)):
        x, y = np.int64(points[k, 0]), np.int64(points[k, 1])
        place = index[y, x]
        if place != NONE:
            result[k] = magnitudes[place]
            continue
        result[k] = 0.0
        for step in range(9):
            j, i = max(0, y - 1 + step // 3), max(0, x - 1 + step % 3)
            if index[j, i] != NONE:
                result[k] = max(result[k], magnitudes[index[j, i]])
    return result


@kernel
def directions(table: Any) -> Any:
    """Return the gradient angle of every pixel (N,) float32.

    The arc tangent of the smaller part over the larger one: on [0, tan 22.5 deg] a polynomial
    that is within 1e-11 of it, beyond that by the addition theorem. Without a branch and without
    a call it takes a tenth of the time of atan2.
    """
    angle = np.empty(len(table), np.float32)
    for k in range(len(table)):
        angle[k] = direction(table[k, NX], table[k, NY])
    return angle


@inner_kernel
def direction(nx: Any, ny: Any) -> Any:
    """Return the angle of a vector that is not zero."""
    along, across = abs(np.float64(nx)), abs(np.float64(ny))
    steep = across > along
    large, small = (across, along) if steep else (along, across)
    beyond = small > TAN_22_5 * large
    z = (small - large if beyond else small) / (large + small if beyond else large)
    t = z * z
    series = ATAN[6]
    for power in (5, 4, 3, 2, 1, 0):
        series = series * t + ATAN[power]
    angle = z * series + (0.25 * math.pi if beyond else 0.0)
    angle = 0.5 * math.pi - angle if steep else angle
    angle = math.pi - angle if nx < 0.0 else angle
    return -angle if ny < 0.0 else angle
