"""Kernels that look at the steps of a curve and thin it to an 8-connected one."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray
from geoprim_core._jit import kernel


@kernel
def survey(curve: FloatArray, closed: bool) -> tuple[int, float, bool, bool]:
    """Return the first pixel that is not whole or -1, the longest step and two flags.

    Whether all steps lead to a neighbour; whether all lead along an axis.
    """
    count = len(curve)
    longest, neighbours, axial = 0.0, True, True
    for i in range(count):
        if curve[i, 0] != math.floor(curve[i, 0]) or curve[i, 1] != math.floor(curve[i, 1]):
            return i, longest, neighbours, axial
        if i == 0 and not closed:
            continue
        j = i - 1 if i > 0 else count - 1
        dx, dy = abs(curve[i, 0] - curve[j, 0]), abs(curve[i, 1] - curve[j, 1])
        step = max(dx, dy)
        longest = max(longest, step)
        neighbours = neighbours and step == 1.0
        axial = axial and (dx == 0.0 or dy == 0.0)
    return -1, longest, neighbours, axial


@kernel
def _is_corner(curve: FloatArray, before: int, i: int, behind: int) -> bool:
    """Say whether two steps along the axes make a right angle at the pixel."""
    ax, ay = curve[i, 0] - curve[before, 0], curve[i, 1] - curve[before, 1]
    bx, by = curve[behind, 0] - curve[i, 0], curve[behind, 1] - curve[i, 1]
    return bool(abs(ax) + abs(ay) == 1.0 and abs(bx) + abs(by) == 1.0 and ax * bx == -ay * by)


@kernel
def without_corners(curve: FloatArray, closed: bool) -> BoolArray:
    """Return which pixels stay when right angles are cut, from the first pixel on."""
    count = len(curve)
    kept = np.ones(count, np.bool_)
    for i in range(1, count if closed else count - 1):
        if kept[i - 1]:
            kept[i] = not _is_corner(curve, i - 1, i, i + 1 if i + 1 < count else 0)
    if closed and count > 3 and kept[1] and kept[count - 1]:
        kept[0] = not _is_corner(curve, count - 1, 0, 1)
    return kept
