"""Kernels of step 2 of the `refined` scheme: which arcs lie in the search regions of others."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import inner_kernel

Int8Array = npt.NDArray[np.int8]


@inner_kernel
def sees(a: FloatArray, b: FloatArray, slack: float) -> bool:
    """Tell whether arc b lies in the search region of arc a, give or take `slack` pixels.

    An arc that continues the ellipse of `a` lies on the inner side of its tangents at both ends
    and in the middle, and beyond the chord.
    """
    for k in range(3):
        x = b[2 + 2 * k]
        y = b[3 + 2 * k]
        if (x - a[2]) * a[14] + (y - a[3]) * a[15] < -slack:
            return False
        for j in range(3):
            inside = (x - a[2 + 2 * j]) * a[8 + 2 * j] + (y - a[3 + 2 * j]) * a[9 + 2 * j]
            if inside < -slack:
                return False
    return True


@inner_kernel
def mark_seen(
    columns: FloatArray, i: int, share: float, slack: float, signed: bool, marks: Int8Array
) -> None:
    """Mark the arcs after arc i that are near enough with 1, those of them that it `sees` with 2.

    `columns` is the table of arcs, a row a figure. No branches: vector instructions.
    """
    x, y, size, polarity = columns[0, i], columns[1, i], columns[18, i], columns[16, i]
    x1, y1, u1, v1 = columns[2, i], columns[3, i], columns[8, i], columns[9, i]
    x2, y2, u2, v2 = columns[4, i], columns[5, i], columns[10, i], columns[11, i]
    x3, y3, u3, v3 = columns[6, i], columns[7, i], columns[12, i], columns[13, i]
    u4, v4 = columns[14, i], columns[15, i]
    first = i + 1
    xs, ys, sizes, polarities = (
        columns[0, first:], columns[1, first:], columns[18, first:], columns[16, first:],
    )  # fmt: skip
    for j in range(len(marks)):
        dx, dy = x - xs[j], y - ys[j]
        near = 0.5 * (size + sizes[j]) / share
        far = (dx * dx + dy * dy > near * near) | (signed & (polarity != polarities[j]))
        marks[j] = 0 if far else 2
    for k in range(3):
        along, down = columns[2 + 2 * k, first:], columns[3 + 2 * k, first:]
        for j in range(len(marks)):
            bx, by = along[j], down[j]
            outside = (bx - x1) * u4 + (by - y1) * v4 < -slack
            outside |= (bx - x1) * u1 + (by - y1) * v1 < -slack
            outside |= (bx - x2) * u2 + (by - y2) * v2 < -slack
            outside |= (bx - x3) * u3 + (by - y3) * v3 < -slack
            marks[j] = min(marks[j], 1) if outside else marks[j]


@inner_kernel
def partners_of_few(
    table: FloatArray,
    columns: FloatArray,
    i: int,
    share: float,
    slack: float,
    signed: bool,
    marks: Int8Array,
    partners: IntArray,
) -> tuple[int, int]:
    """Do what `find_partners` does, without cells: of few arcs a cell holds next to none."""
    rest = marks[i + 1 :]
    mark_seen(columns, i, share, slack, signed, rest)
    seen = np.uint64(0)
    looked = 0
    for k in range(len(rest)):
        partners[seen] = i + 1 + k
        seen += np.uint64(rest[k] == 2)
        looked += rest[k] > 0
    count = 0
    for k in range(seen):
        j = partners[k]
        partners[count] = j
        count += sees(table[j], table[i], slack)
    return count, looked
