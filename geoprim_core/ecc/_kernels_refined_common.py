"""Kernels of step 2 of the `refined` scheme: one ellipse for one arc or two, and how it fits."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.ecc._kernels_refined_fit import add_shifted, fit_moments, offset_of

SAMPLES = 12  # points of an arc that an ellipse is measured by


@kernel
def sample_arcs(points: FloatArray, order: IntArray, ends: IntArray) -> FloatArray:
    """Return about 12 points of each arc (A, 13, 2), the one amidst at the end; NaN fills up."""
    samples = np.full((len(ends) - 1, SAMPLES + 1, 2), np.nan)
    for i in range(len(samples)):
        low, size = ends[i], ends[i + 1] - ends[i]
        count = min(SAMPLES, size)
        middle, other = points[order[low + size // 2]], points[order[low + (size - 1) // 2]]
        samples[i, SAMPLES] = 0.5 * (middle + other)
        for k in range(count):
            # Backwards from the end in the second half: the same points whichever way the arc runs.
            back = count - 1 - k
            at = (min(k, back) * (size - 1)) // (count - 1)
            samples[i, k] = points[order[low + (at if k <= back else size - 1 - at)]]
    return samples


@kernel
def arc_rms(
    samples: FloatArray,
    i: int,
    size: float,
    ellipse: FloatArray,
    cos: float,
    sin: float,
    normal: FloatArray,
    most: float,
) -> float:
    """Return the root mean square distance of samples of arc i, of `size` points, to an ellipse.

    Infinite when the arc bends away from the ellipse: `normal` is its inner normal amidst; and
    above `most`, which is known before all points have been looked at.
    """
    x, y = samples[i, SAMPLES, 0], samples[i, SAMPLES, 1]
    _, nx, ny = offset_of(ellipse, cos, sin, x, y)
    if nx * normal[0] + ny * normal[1] > -0.9:
        return math.inf
    count = min(SAMPLES, int(size))
    limit = count * most * most * (1.0 + 1e-9)
    x0, y0 = ellipse[0], ellipse[1]
    flat, steep = 1.0 / (ellipse[2] * ellipse[2]), 1.0 / (ellipse[3] * ellipse[3])
    total = 0.0
    for k in range(count):  # the square of what `offset_of` returns first
        dx, dy = samples[i, k, 0] - x0, samples[i, k, 1] - y0
        u, v = dx * cos + dy * sin, dy * cos - dx * sin
        gu, gv = u * flat, v * steep
        f = 0.5 * (u * gu + v * gv - 1.0)
        total += f * f / (gu * gu + gv * gv + 1e-300)
        if total > limit:
            return math.inf
    return math.sqrt(total / count)


@kernel
def fit_arcs(
    samples: FloatArray,
    table: FloatArray,
    moments: FloatArray,
    i: int,
    j: int,
    max_rms: float,
    max_size: float,
    most: float,
    work: FloatArray,
    ellipse: FloatArray,
) -> float:
    """Fit one arc (j < 0) or two; return the worse rms of both, infinite where they do not fit.

    An ellipse with an outline that is certainly longer than `most` does not either.
    """
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
    if ellipse[2] > max_size or ellipse[3] < 2.0 or math.pi * (ellipse[2] + ellipse[3]) > most:
        return math.inf
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    rms = 0.0
    for k in (i, j):
        if k >= 0 and rms < max_rms:
            normal, size = table[k, 10:12], table[k, 18]
            rms = max(rms, arc_rms(samples, k, size, ellipse, cos, sin, normal, max_rms))
    return rms if rms < max_rms else math.inf
