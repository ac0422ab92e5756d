"""Kernels of the `refined` scheme: the places of an outline that a walk along it comes by."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import inner_kernel, kernel

SKETCH = 18  # places of a quarter that serve a first look
SKETCHES = 64  # as many ratios of the semi-axes
GLANCES = (5, 9, SKETCH)  # as many of them make a first glance, half a look, a look


def _sketches() -> FloatArray:
    """Return equally spaced places of a quarter (SKETCHES, SKETCH, 3), every fourth one first.

    The columns are those of `quarter_of`. A part of them from the first on is spread over the
    whole quarter: with mirror images, over the outline.
    """
    t = np.linspace(0.0, 0.5 * np.pi, 1025)
    table = np.empty((SKETCHES, SKETCH, 3))
    order = np.concatenate([np.arange(first, SKETCH, 4) for first in (1, 3, 0, 2)])
    for k in range(SKETCHES):
        ratio = (k + 0.5) / SKETCHES
        pace = np.hypot(np.sin(t), ratio * np.cos(t))
        path = np.concatenate(([0.0], np.cumsum(0.5 * (pace[1:] + pace[:-1]))))
        at = np.interp(np.arange(2 * SKETCH + 1) * path[-1] / (2 * SKETCH), path, t)
        c, s, dt = np.cos(at[1::2]), np.sin(at[1::2]), np.diff(at[::2])
        places = np.stack((c, s, ratio * dt / (s * s + ratio * ratio * c * c)), axis=1)
        table[k] = places[order]
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
    """
    count = 0
    last = min(0.5, stride / b)
    c, s = turned(1.0, 0.0, 0.5 * last)
    while count < len(places):
        inverse = 1.0 / (a * a * s * s + b * b * c * c)
        dt = min(0.5, stride * math.sqrt(inverse))
        if c <= -0.5 * dt * s:  # the step begins beyond the quarter
            break
        places[count, 0], places[count, 1] = c, s
        places[count, 2] = a * b * dt * inverse
        c, s = turned(c, s, dt + 0.5 * (dt - last))
        last = dt
        count += 1
    return count


@inner_kernel
def sketch_of(a: float, b: float, places: FloatArray) -> int:
    """Write `SKETCH` places as `quarter_of` does, in the order of `GLANCES`; return their number.

    They come from a table of ratios: where exactly on the outline the places lie does not matter.
    """
    row = min(SKETCHES - 1, int(SKETCHES * b / a))
    for k in range(SKETCH):
        for column in range(3):
            places[k, column] = _SKETCHES[row, k, column]
    return SKETCH


@kernel
def outline_of(a: float, b: float, stride: float) -> FloatArray:
    """Return cosine and sine of the parameters of places about `stride` pixels apart, in order.

    The four quarters mirror each other, so that no direction of the walk is preferred.
    """
    quarter = np.empty((int((a + b) / stride) + 8, 3))
    count = quarter_of(a, b, stride, quarter)
    places = np.empty((4 * count, 2))
    for k in range(count):
        c, s = quarter[k, 0], quarter[k, 1]
        places[k, 0], places[k, 1] = c, s
        places[2 * count - 1 - k, 0], places[2 * count - 1 - k, 1] = -c, s
        places[2 * count + k, 0], places[2 * count + k, 1] = -c, -s
        places[4 * count - 1 - k, 0], places[4 * count - 1 - k, 1] = c, -s
    return places
