"""Kernels of the `refined` scheme: the places of an outline that a walk along it comes by."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, Int32Array
from geoprim_core._jit import inner_kernel, kernel

SKETCH = 18  # places of a quarter that serve a first look
SKETCHES = 64  # as many ratios of the semi-axes
GLANCES = (5, 9, SKETCH)  # as many of them make a first glance, half a look, a look


def _sketches() -> FloatArray:
    """Return equally spaced places of a quarter (SKETCHES, 3, SKETCH), every fourth one first.

    The rows are those of `quarter_of`. A part of them from the first on is spread over the
    whole quarter: with mirror images, over the outline.
    """
    t = np.linspace(0.0, 0.5 * np.pi, 1025)
    table = np.empty((SKETCHES, 3, SKETCH))
    order = np.concatenate([np.arange(first, SKETCH, 4) for first in (1, 3, 0, 2)])
    for k in range(SKETCHES):
        ratio = (k + 0.5) / SKETCHES
        pace = np.hypot(np.sin(t), ratio * np.cos(t))
        path = np.concatenate(([0.0], np.cumsum(0.5 * (pace[1:] + pace[:-1]))))
        at = np.interp(np.arange(2 * SKETCH + 1) * path[-1] / (2 * SKETCH), path, t)
        c, s, dt = np.cos(at[1::2]), np.sin(at[1::2]), np.diff(at[::2])
        places = np.stack((c, s, ratio * dt / (s * s + ratio * ratio * c * c)))
        table[k] = places[:, order]
    return table


_SKETCHES = _sketches()


@kernel
def turned(cos: float, sin: float, angle: float) -> tuple[float, float]:
    """Return the cosine and sine of an angle turned on by a small one."""
    half = 0.5 * angle
    grow = 1.0 / (1.0 + half * half)
    cd, sd = (1.0 - half * half) * grow, 2.0 * half * grow
    return cos * cd - sin * sd, sin * cd + cos * sd


@inner_kernel
def quarter_of(a: float, b: float, stride: float, places: FloatArray) -> int:
    """Write places about `stride` pixels apart on the first quarter of an outline, in order.

    Of each: cosine and sine of the parameter, and the turn of the normal over the step that it is
    amidst. Returns how many they are. The way to the next place is half of this step and half of
    the next, which is extrapolated: a root and a division a place are what the walk waits for.
    What it need not wait for is put aside: `turned` without its division makes (c, s) longer, by
    how much is kept.
    """
    count = 0
    last = min(0.5, stride / b)
    c, s = turned(1.0, 0.0, 0.5 * last)
    length = 1.0
    while count < places.shape[1]:
        square = a * a * s * s + b * b * c * c
        dt = min(0.5, stride * length / math.sqrt(square))
        if c <= -0.5 * dt * s:  # the step begins beyond the quarter
            break
        inverse = 1.0 / length
        places[0, count], places[1, count] = c * inverse, s * inverse
        places[2, count] = a * b * dt * length * length / square
        half = 0.75 * dt - 0.25 * last
        c, s = (
            c * (1.0 - half * half) - s * (2.0 * half),
            s * (1.0 - half * half) + c * (2.0 * half),
        )
        length *= 1.0 + half * half
        last = dt
        count += 1
    return count


@inner_kernel
def sketch_of(a: float, b: float, places: FloatArray) -> int:
    """Write `SKETCH` places as `quarter_of` does, in the order of `GLANCES`; return their number.

    They come from a table of ratios: where exactly on the outline the places lie does not matter.
    """
    row = min(SKETCHES - 1, int(SKETCHES * b / a))
    for what in range(3):
        for k in range(SKETCH):
            places[what, k] = _SKETCHES[row, what, k]
    return SKETCH


@inner_kernel
def pixels_of(
    places: FloatArray, first: int, last: int, ellipse: FloatArray, cos: float, sin: float,
    width: int, height: int, spots: Int32Array,
) -> None:  # fmt: skip
    """Write the flat indices of the pixels of the places first .. last - 1, a row a quarter.

    They are mirrored left and right in quarters 1 and 3, up and down in 2 and 3. Outside the
    image, and on its border, where a pixel has no nine around it, the index is 0. The body of the
    loop has no branches, so that it compiles to vector instructions.
    """
    right, bottom = width - 1.0, height - 1.0
    x0, y0 = ellipse[0] + 0.5, ellipse[1] + 0.5
    c, s = places[0, first:last], places[1, first:last]
    for side in range(4):
        a = -ellipse[2] if side % 2 == 1 else ellipse[2]
        b = -ellipse[3] if side >= 2 else ellipse[3]
        row = spots[side]
        for k in range(last - first):
            u, v = a * c[k], b * s[k]
            x, y = x0 + u * cos - v * sin, y0 + u * sin + v * cos
            within = (x >= 1.0) & (y >= 1.0) & (x < right) & (y < bottom)
            row[k] = np.int32(y if within else 0.0) * width + np.int32(x if within else 0.0)


@kernel
def outline_of(a: float, b: float, stride: float) -> FloatArray:
    """Return cosine and sine of the parameters of places about `stride` pixels apart, in order.

    The four quarters mirror each other, so that no direction of the walk is preferred.
    """
    quarter = np.empty((3, int((a + b) / stride) + 8))
    count = quarter_of(a, b, stride, quarter)
    places = np.empty((4 * count, 2))
    for k in range(count):
        c, s = quarter[0, k], quarter[1, k]
        places[k, 0], places[k, 1] = c, s
        places[2 * count - 1 - k, 0], places[2 * count - 1 - k, 1] = -c, s
        places[2 * count + k, 0], places[2 * count + k, 1] = -c, -s
        places[4 * count - 1 - k, 0], places[4 * count - 1 - k, 1] = c, -s
    return places


@inner_kernel
def pixel_at(ellipse: FloatArray, cos: float, sin: float, ct: float, st: float) -> tuple[int, int]:
    """Return the pixel of an outline's place with the cosine and sine of its parameter."""
    u, v = ellipse[2] * ct, ellipse[3] * st
    x, y = ellipse[0] + u * cos - v * sin, ellipse[1] + u * sin + v * cos
    return int(math.floor(x + 0.5)), int(math.floor(y + 0.5))
