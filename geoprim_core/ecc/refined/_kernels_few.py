"""Kernels of the `refined` scheme, pairs: which arcs lie in the search regions of others."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from geoprim_core._check import FloatArray, Int8Array, IntArray
from geoprim_core._jit import inner_kernel
from geoprim_core.ecc.refined._kernels_arcs import CHORD, INWARDS, MIDDLE, PLACES, POLARITY, SIZE


class PairRules(NamedTuple):
    """Which arcs make a candidate, see `RefinedParams`; lengths are in pixels.

    Attributes
    ----------
    slack : float
        How far an arc may reach out of the search region of another.
    max_rms : float
        Of either arc to the common ellipse.
    min_share : float
        Share of the outline that the arcs make up.
    max_semi_major : float
    signed : bool
        Whether both arcs have to have one polarity.
    max_pairs : int
        As many are looked at.
    """

    slack: float
    max_rms: float
    min_share: float
    max_semi_major: float
    signed: bool
    max_pairs: int


@inner_kernel
def sees(a: FloatArray, b: FloatArray, slack: float) -> bool:
    """Tell whether arc b lies in the search region of arc a, give or take `slack` pixels.

    An arc that continues the ellipse of `a` lies on the inner side of its tangents at both ends
    and in the middle, and beyond the chord.
    """
    for k in range(3):
        x, y = b[PLACES + 2 * k], b[PLACES + 2 * k + 1]
        beyond = (x - a[PLACES]) * a[CHORD] + (y - a[PLACES + 1]) * a[CHORD + 1]
        if beyond < -slack:
            return False
        for j in range(3):
            place, normal = PLACES + 2 * j, INWARDS + 2 * j
            inside = (x - a[place]) * a[normal] + (y - a[place + 1]) * a[normal + 1]
            if inside < -slack:
                return False
    return True


@inner_kernel
def mark_seen(
    columns: FloatArray, i: int, share: float, rules: PairRules, marks: Int8Array
) -> None:
    """Mark the arcs after arc i that are near enough with 1, those of them that it `sees` with 2.

    `columns` is the table of arcs, a row a figure. No branches: vector instructions.
    """
    own = columns[:, i]
    slack, signed = rules.slack, rules.signed
    x, y, size, polarity = own[MIDDLE], own[MIDDLE + 1], own[SIZE], own[POLARITY]
    x1, y1, u1, v1 = own[PLACES], own[PLACES + 1], own[INWARDS], own[INWARDS + 1]
    x2, y2, u2, v2 = own[PLACES + 2], own[PLACES + 3], own[INWARDS + 2], own[INWARDS + 3]
    x3, y3, u3, v3 = own[PLACES + 4], own[PLACES + 5], own[INWARDS + 4], own[INWARDS + 5]
    u4, v4 = own[CHORD], own[CHORD + 1]
    first = i + 1
    xs, ys = columns[MIDDLE, first:], columns[MIDDLE + 1, first:]
    sizes, polarities = columns[SIZE, first:], columns[POLARITY, first:]
    for j in range(len(marks)):
        dx, dy = x - xs[j], y - ys[j]
        near = 0.5 * (size + sizes[j]) / share
        far = (dx * dx + dy * dy > near * near) | (signed & (polarity != polarities[j]))
        marks[j] = 0 if far else 2
    for k in range(3):
        along, down = columns[PLACES + 2 * k, first:], columns[PLACES + 2 * k + 1, first:]
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
    rules: PairRules,
    marks: Int8Array,
    partners: IntArray,
) -> tuple[int, int]:
    """Do what `find_partners` does, without cells: of few arcs a cell holds next to none."""
    rest = marks[i + 1 :]
    mark_seen(columns, i, share, rules, rest)
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
        count += sees(table[j], table[i], rules.slack)
    return count, looked
