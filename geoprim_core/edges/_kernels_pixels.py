"""Kernels that list the edge pixels with their sub-pixel positions."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from geoprim_core._jit import kernel

SUBPIXEL_STEPS = 256.0
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
OX, OY, NX, NY = range(4)  # columns of the edge table: offset, unit gradient


@kernel
def magnitude_at(dx: Any, dy: Any, place: Any) -> Any:
    """Return the gradient magnitude at a flat index."""
    at = np.uint64(place)
    gx, gy = np.float64(dx[at]), np.float64(dy[at])
    return math.sqrt(gx * gx + gy * gy)


@kernel
def rounded(value: Any) -> Any:
    """Return a number within 0.5 as the nearest multiple of 1/256, of two the even one.

    Adding 1.5 x 2^52 leaves no room for a fraction; a call of rint costs ten times as much.
    """
    steps = (value * SUBPIXEL_STEPS + 6755399441055744.0) - 6755399441055744.0
    fine = steps / SUBPIXEL_STEPS
    fine = 0.5 if fine > 0.5 else fine
    return -0.5 if fine < -0.5 else fine


@kernel
def locate(flat: Any, dx: Any, dy: Any, index: Any) -> Any:
    """Return x, y (N,) and the edge table (N, 4) of the pixels at rising flat indices.

    The index image (H + 2, W + 2) uint32 is filled in: it holds the place of a pixel in the list,
    `NONE` where there is no edge; with its margin, flat steps of up to two pixels onwards stay
    inside it and meet no pixel round the border. The table holds sub-pixel offsets and unit
    gradients, float32.

    The crest of the magnitude along the row or the column, whichever is nearer to the gradient,
    is the vertex of a parabola through three pixels; the offset leads to the foot on the
    gradient line, in multiples of 1/256 px and within half a pixel in each coordinate. (A
    parabola along the gradient itself would need interpolated magnitudes: that triples the
    error on thin lines.)
    """
    count = len(flat)
    height, width = dx.shape
    xs = np.empty(count, np.int32)
    ys = np.empty(count, np.int32)
    index[:] = NONE
    table = np.zeros((count, 4), np.float32)
    along_x, along_y, places = dx.ravel(), dy.ravel(), index.ravel()
    y = 0
    for k in range(count):
        place = np.int64(flat[k])
        while place >= (y + 1) * width:
            y += 1
        x = place - y * width
        xs[k] = x
        ys[k] = y
        places[np.uint64(place + y * MARGIN)] = k
        gx, gy = np.float64(along_x[np.uint64(place)]), np.float64(along_y[np.uint64(place)])
        here = math.sqrt(gx * gx + gy * gy)
        if here == 0.0:
            table[k, NX] = 1.0
            continue
        nx, ny = np.float32(gx / here), np.float32(gy / here)
        table[k, NX] = nx
        table[k, NY] = ny
        if x == 0 or y == 0 or x == width - 1 or y == height - 1:
            continue
        level = abs(gx) >= abs(gy)
        step = 1 if level else width
        step = step if (gx if level else gy) >= 0.0 else -step
        up = magnitude_at(along_x, along_y, place + step)
        down = magnitude_at(along_x, along_y, place - step)
        way = 0
        if (up > here) | (down > here):
            # The crest may cross the axis nearer to a neighbour: centre the parabola there.
            ahead = 1 if up > here else -1
            at = (x if level else y) + 2 * (ahead if step > 0 else -ahead)
            if 0 <= at < (width if level else height):
                way = ahead
                beyond = magnitude_at(along_x, along_y, place + 2 * way * step)
                if way == 1:
                    down, here, up = here, up, beyond
                else:
                    up, here, down = here, down, beyond
        bend = 2.0 * here - up - down
        shift = 0.5 * (up - down) / bend
        shift = 0.5 if shift > 0.5 else shift
        shift = -0.5 if shift < -0.5 else shift
        # From the axis to the foot on the gradient line.
        sign = 1.0 if step > 0 else -1.0
        shift = (way + shift) * ((nx if level else ny) * sign) if bend > 0.0 else 0.0
        table[k, OX] = rounded(shift * nx)
        table[k, OY] = rounded(shift * ny)
    return xs, ys, table


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


@kernel
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
