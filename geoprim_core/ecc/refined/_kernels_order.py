"""Kernels of the `refined` scheme: the order of points around an ellipse, that of candidates."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, Int32Array, IntArray, UInt32Array
from geoprim_core._jit import inner_kernel, kernel

DIGIT = 11  # bits of a number that are sorted by together
DIGITS = 3  # of 32 bits


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


@inner_kernel
def sort_digits(keys: UInt32Array, order: Int32Array, other: Int32Array, starts: IntArray) -> None:
    """Write the order of rising 32-bit keys, of equal ones that in which they stand.

    By counting, lowest digit first: comparisons of numbers at random cost several times as much.
    `other` and `starts` are room.
    """
    starts[:] = 0
    for key in keys:
        for digit in range(DIGITS):
            starts[digit, (key >> np.uint32(DIGIT * digit)) & np.uint32(2**DIGIT - 1)] += 1
    for digit in range(DIGITS):
        total = 0
        for value in range(2**DIGIT):
            count = starts[digit, value]
            starts[digit, value] = total
            total += count
    for k in range(len(keys)):
        order[k] = k
    for digit in range(DIGITS):
        for k in order:
            value = (keys[k] >> np.uint32(DIGIT * digit)) & np.uint32(2**DIGIT - 1)
            other[starts[digit, value]] = k
            starts[digit, value] += 1
        for k in range(len(order)):
            order[k] = other[k]


@inner_kernel
def comes_before(arcs: IntArray, values: FloatArray, k: int, m: int) -> bool:
    """Tell whether candidate k has a higher rank than m or, of the same rank, earlier arcs."""
    if values[k, 0] != values[m, 0]:
        return bool(values[k, 0] > values[m, 0])
    if arcs[k, 0] != arcs[m, 0]:
        return bool(arcs[k, 0] < arcs[m, 0])
    return bool(arcs[k, 1] < arcs[m, 1])


@kernel
def best_first(arcs: IntArray, values: FloatArray) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return the arcs, ranks and ellipses of candidates by falling rank, then by their arcs.

    `values` (C, 6) are rank, which is not negative, and ellipse. The ranks in single precision are
    sorted first; that leaves next to nothing to put right.
    """
    count = len(arcs)
    single = np.empty(count, np.float32)
    single[:] = values[:, 0]
    keys = ~single.view(np.uint32)
    order, other = np.empty(count, np.int32), np.empty(count, np.int32)
    sort_digits(keys, order, other, np.empty((DIGITS, 2**DIGIT), np.int64))
    for m in range(1, count):
        k, at = order[m], m
        while at > 0 and comes_before(arcs, values, k, order[at - 1]):
            order[at] = order[at - 1]
            at -= 1
        order[at] = k
    pairs = np.empty((count, 2), np.int64)
    ranks = np.empty(count)
    ellipses = np.empty((count, 5))
    for k in range(count):
        own = np.uint64(order[k])
        pairs[k, 0], pairs[k, 1] = arcs[own, 0], arcs[own, 1]
        ranks[k] = values[own, 0]
        for column in range(5):
            ellipses[k, column] = values[own, column + 1]
    return pairs, ranks, ellipses
