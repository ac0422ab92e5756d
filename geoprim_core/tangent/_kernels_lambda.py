"""Kernel of the lambda maximal segment tangents."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel


@kernel
def pencil_sums(
    start: IntArray, end: IntArray, a: IntArray, b: IntArray, count: int, floor: float,
    sigma: float,
) -> FloatArray:  # fmt: skip
    """Return (count, 3): the weighted sum of the segments' unit vectors at a pixel, the weights.

    The weight is that of the pixel's eccentricity in the segment: floor + triangle, or a Gaussian
    where sigma is positive.
    """
    sums = np.zeros((count, 3))
    for k in range(len(start)):
        length = math.hypot(float(a[k]), float(b[k]))
        if length == 0.0:
            continue
        cos, sin = b[k] / length, a[k] / length
        pixels = end[k] - start[k] + 1
        at = start[k]
        share = 1.0 / pixels
        for j in range(pixels):
            off = abs((2.0 * j + 1.0) * share - 1.0)  # 0 in the middle, 1 at both ends
            if sigma > 0.0:
                weight = math.exp(-0.125 * (off / sigma) ** 2)
            else:
                weight = floor + 1.0 - off
            if at >= count:
                at -= count
            sums[at, 0] += weight * cos
            sums[at, 1] += weight * sin
            sums[at, 2] += weight
            at += 1
    return sums
