"""Kernel of the polygon metrics: distances of the pixels of every segment."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.polygon._kernels import farthest_pair_of


@kernel
def segment_distances(
    points: FloatArray, indices: IntArray, closed: bool, any_pair: bool
) -> FloatArray:
    """Return (J, 5): pixels, largest distance, sum of squares, sum and s_max of every segment.

    The pixels of a segment include both its ends; s_max is the largest distance between any two
    of them, or from the first.
    """
    count, size = len(points), len(indices)
    segments = size if closed else size - 1
    rows = np.zeros((max(segments, 0), 5))
    for t in range(segments):
        i = indices[t]
        j = indices[t + 1] if t + 1 < size else indices[0] + count
        piece = np.empty((j - i + 1, 2))
        for k in range(i, j + 1):
            piece[k - i] = points[k % count]
        dx, dy = piece[-1, 0] - piece[0, 0], piece[-1, 1] - piece[0, 1]
        length = math.sqrt(dx * dx + dy * dy)
        rows[t, 0] = len(piece)
        for k in range(len(piece)):
            x, y = piece[k, 0] - piece[0, 0], piece[k, 1] - piece[0, 1]
            far = math.sqrt(x * x + y * y)
            d = abs(dx * y - dy * x) / length if length > 0.0 else far
            rows[t, 1] = max(rows[t, 1], d)
            rows[t, 2] += d * d
            rows[t, 3] += d
            rows[t, 4] = max(rows[t, 4], far)
        if any_pair:
            a, b = farthest_pair_of(piece)
            rows[t, 4] = math.hypot(piece[a, 0] - piece[b, 0], piece[a, 1] - piece[b, 1])
    return rows
