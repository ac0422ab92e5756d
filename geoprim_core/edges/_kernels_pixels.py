"""Kernels that list the edge pixels with their sub-pixel positions."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from geoprim_core._jit import kernel

SUBPIXEL_STEPS = 256.0


@kernel
def edge_pixels(flat: Any, height: Any, width: Any) -> Any:
    """Return x, y (N,) int32 of the pixels at flat indices, and the index image (-1: none)."""
    index = np.full((height, width), -1, np.int32)
    xs = np.empty(len(flat), np.int32)
    ys = np.empty(len(flat), np.int32)
    for k in range(len(flat)):
        y = flat[k] // width
        x = flat[k] - y * width
        xs[k] = x
        ys[k] = y
        index[y, x] = k
    return xs, ys, index


@kernel
def magnitude_at(dx: Any, dy: Any, x: Any, y: Any) -> Any:
    """Return the gradient magnitude at a pixel."""
    gx, gy = np.float64(dx[y, x]), np.float64(dy[y, x])
    return math.sqrt(gx * gx + gy * gy)


@kernel
def locate(xs: Any, ys: Any, dx: Any, dy: Any) -> Any:
    """Return sub-pixel offsets (N, 2) and unit gradients (N, 2), float32, of edge pixels.

    The crest of the magnitude along the row or the column, whichever is nearer to the gradient,
    is the vertex of a parabola through three pixels; the offset leads to the foot on the
    gradient line, in multiples of 1/256 px and within half a pixel in each coordinate. (A
    parabola along the gradient itself would need interpolated magnitudes: that triples the
    error on thin lines.)
    """
    count = len(xs)
    height, width = dx.shape
    offset = np.zeros((count, 2), np.float32)
    normal = np.empty((count, 2), np.float32)
    for k in range(count):
        x, y = xs[k], ys[k]
        gx = np.float64(dx[y, x])
        gy = np.float64(dy[y, x])
        here = math.sqrt(gx * gx + gy * gy)
        if here == 0.0:
            normal[k, 0], normal[k, 1] = 1.0, 0.0
            continue
        normal[k, 0] = gx / here
        normal[k, 1] = gy / here
        if x == 0 or y == 0 or x == width - 1 or y == height - 1:
            continue
        ux = (1 if gx >= 0.0 else -1) if abs(gx) >= abs(gy) else 0
        uy = 0 if ux != 0 else (1 if gy >= 0.0 else -1)
        up = magnitude_at(dx, dy, x + ux, y + uy)
        down = magnitude_at(dx, dy, x - ux, y - uy)
        # The crest may cross the axis nearer to a neighbour: centre the parabola there.
        way = 1 if up > here else (-1 if down > here else 0)
        px, py = x + 2 * way * ux, y + 2 * way * uy
        if way != 0 and 0 <= px < width and 0 <= py < height:
            beyond = magnitude_at(dx, dy, px, py)
            if way == 1:
                down, here, up = here, up, beyond
            else:
                up, here, down = here, down, beyond
        else:
            way = 0
        bend = 2.0 * here - up - down
        if bend <= 0.0:
            continue
        shift = way + min(0.5, max(-0.5, 0.5 * (up - down) / bend))
        # From the axis to the foot on the gradient line.
        shift *= normal[k, 0] * ux + normal[k, 1] * uy
        for c in range(2):
            fine = np.rint(shift * normal[k, c] * SUBPIXEL_STEPS) / SUBPIXEL_STEPS
            offset[k, c] = min(0.5, max(-0.5, fine))
    return offset, normal


@kernel
def find_doubles(xs: Any, ys: Any, index: Any, offset: Any, normal: Any) -> Any:
    """Return (N,) bool: one of two pixels that mark the same edge point.

    They lie side by side across the edge with like gradients; the one nearer to the edge stays.
    """
    height, width = index.shape
    double = np.zeros(len(xs), np.bool_)
    for k in range(len(xs)):
        x, y = xs[k], ys[k]
        nx, ny = normal[k, 0], normal[k, 1]
        for step in range(4):
            if double[k]:
                break
            i = (1, -1, 0, 1)[step]
            j = (0, 1, 1, 1)[step]
            if not (0 <= x + i < width and y + j < height):
                continue
            m = index[y + j, x + i]
            if m < 0 or double[m] or nx * normal[m, 0] + ny * normal[m, 1] < 0.9:
                continue
            ex = i + offset[m, 0] - offset[k, 0]
            ey = j + offset[m, 1] - offset[k, 1]
            if ex * ex + ey * ey > 0.16:
                continue
            far_k = offset[k, 0] * offset[k, 0] + offset[k, 1] * offset[k, 1]
            far_m = offset[m, 0] * offset[m, 0] + offset[m, 1] * offset[m, 1]
            # In a tie the pixel on the brighter side stays, as in the suppression.
            if far_m < far_k or (far_m == far_k and i * nx + j * ny > 0.0):
                double[k] = True
            else:
                double[m] = True
    return double
