"""Kernels of the optimal polygon's reduction: paths that pay a price for every segment.

With a price p on every segment the number of segments need not be counted, so one pass over the
table finds the best path. Its potentials bound from below every polygon of N segments that uses a
given segment; what exceeds the bound is struck from the table before any layer is run.
"""

from __future__ import annotations

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel


@kernel
def priced_path(
    first: IntArray, table: FloatArray, low: int, span: int, price: float
) -> tuple[FloatArray, IntArray]:
    """Return the least priced errors from node `low` to the next `span`, and the best path."""
    count = len(first) - 1
    least, parent = np.full(span + 1, np.inf), np.zeros(span + 1, np.int32)
    least[0] = 0.0
    for i in range(span):
        value = least[i] + price
        if value == np.inf:
            continue
        row = (low + i) % count
        begin = first[row]
        for k in range(min(first[row + 1] - begin, span - i)):
            total = value + table[begin + k]
            if total < least[i + 1 + k]:
                least[i + 1 + k] = total
                parent[i + 1 + k] = i
    links, node = 0, span
    while node > 0 and least[span] < np.inf:
        node = parent[node]
        links += 1
    path = np.empty(links + 1, np.int64)
    node = span
    for n in range(links, -1, -1):
        path[n] = low + node
        node = parent[node]
    return least, path


@kernel
def reduced_table(
    first: IntArray,
    table: FloatArray,
    low: int,
    closed: bool,
    potential: FloatArray,
    price: float,
    spare: float,
) -> tuple[IntArray, FloatArray]:
    """Return the table without the segments whose reduced error exceeds what may be spared.

    `potential` holds one value a pixel (any values are sound), in the order low, low + 1 ... of a
    closed curve. The reduced error of a segment i -> j is its error + price +
    potential[i] - potential[j]; the rise Z of the potential over a round is the largest that
    leaves all of them at least zero, and the segments of a polygon sum up to Z plus their reduced
    errors. A segment
    goes when Z + its reduced error > `spare`.
    """
    count = len(first) - 1
    rise = np.inf if closed else potential[count - 1] - potential[0]
    for i in range(count if closed else 0):
        row = (low + i) % count
        for k in range(max(count - i - 1, 0), first[row + 1] - first[row]):
            error = table[first[row] + k] + price + potential[i] - potential[i + 1 + k - count]
            rise = min(rise, error)
    rows, size = np.zeros(count + 1, np.int64), 0
    kept = table.copy()
    for row in range(count):
        i = (row - low) % count
        used = size
        for k in range(first[row + 1] - first[row]):
            j = i + 1 + k
            ahead = potential[j] if j < count else potential[j - count] + rise
            value = table[first[row] + k]
            reduced = value + price + potential[i] - ahead
            kept[size] = value if rise + reduced <= spare else np.inf
            size += 1
            if kept[size - 1] < np.inf:
                used = size
        size = used
        rows[row + 1] = size
    return rows, kept[:size].copy()
