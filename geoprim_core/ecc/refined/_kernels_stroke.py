"""Kernels of the `refined` scheme, strokes: the two edges of one drawn line."""

from __future__ import annotations

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_mates import DOUBTED, END

ALIKE = 1.0  # pixels between the width of a line here and that of the lines of a drawing
FOLLOWED = 5.0  # points with a mate that a contour is given in an image of lines
OPPOSITE = 0.7  # share of mates on the other side from which it is a line of the opposite sign
FOLLOWING = 0.1  # share of mates from which a contour is a line in an image of lines


@inner_kernel
def count_alike(gaps: FloatArray, width: float) -> int:
    """Count the mates (2, n) that lie about as far as a line of the given signed width is wide."""
    count = 0
    for gap in gaps[1 if width > 0.0 else 0]:
        count += gap != 0.0 and abs(gap - abs(width)) < ALIKE
    return count


@kernel
def own_width(gaps: FloatArray, share: float, reach: float, doubted: float, steady: float) -> float:
    """Return the signed width of the line that a contour is an edge of by its own mates, else 0.

    More than `share` of its points, and of `doubted` further ones without, have their nearer mate
    on one side within `reach`, at one distance to within `steady`.
    """
    least = share * (gaps.shape[1] + doubted)
    for side in range(2):
        own, other = gaps[side], gaps[1 - side]
        near = np.empty(len(own))
        size = 0
        for k in range(len(own)):
            near[size] = own[k]
            size += (0.0 < own[k] < reach) & ((other[k] == 0.0) | (own[k] <= other[k]))
        if size > least:
            width = np.median(near[:size])
            if np.sum(np.abs(near[:size] - width) < steady) > least:
                return float(width if side == 1 else -width)
    return 0.0


@inner_kernel
def followed_width(gaps: FloatArray, common: float, both_inks: bool) -> float:
    """Return the signed width of the line that a contour of a line drawing is an edge of, else 0.

    That of most lines, `common`, unless most of its own points tell of a line of the opposite
    sign (`both_inks`), or it is long enough to tell that it is none: crossings hide mates.
    """
    size = gaps.shape[1]
    alike, opposite = count_alike(gaps, common), count_alike(gaps, -common)
    if both_inks and opposite > max(alike, OPPOSITE * size):
        return -common
    return common if alike + FOLLOWED > FOLLOWING * size else 0.0


@inner_kernel
def without_ends(gaps: FloatArray) -> tuple[int, int]:
    """Return the range of a contour without up to `END` points without a mate at either end.

    Where something hides a line, one edge of it is seen further than the other.
    """
    first, last = 0, gaps.shape[1]
    while first < min(END, last) and gaps[0, first] == 0.0 and gaps[1, first] == 0.0:
        first += 1
    most = max(first, last - END)
    while last > most and gaps[0, last - 1] == 0.0 and gaps[1, last - 1] == 0.0:
        last -= 1
    return first, last


@kernel
def stroke_widths(
    gaps: FloatArray,
    offsets: IntArray,
    closed: BoolArray,
    share: float,
    reach: float,
    steady: float,
    common: float,
    both_inks: bool,
) -> tuple[FloatArray, int]:
    """Return for every point the signed width of the line that its contour is an edge of, else 0.

    And how many points are on lines.

    Each contour is judged by its own mates within `reach` (`own_width`). In an image of lines,
    most of them `common` wide (0: no such image), a contour follows the others.
    """
    widths = np.zeros(gaps.shape[1])
    count = 0
    for c in range(len(offsets) - 1):
        own = gaps[:, offsets[c] : offsets[c + 1]]
        width = followed_width(own, common, both_inks) if common != 0.0 else 0.0
        doubted = 0.0 if closed[c] else DOUBTED
        if width == 0.0 and own.shape[1] > share * (own.shape[1] + doubted):  # else too short
            first, last = (0, own.shape[1]) if closed[c] else without_ends(own)
            width = own_width(own[:, first:last], share, reach, doubted, steady)
        if width != 0.0:
            widths[offsets[c] : offsets[c + 1]] = width
            count += own.shape[1]
    return widths, count
