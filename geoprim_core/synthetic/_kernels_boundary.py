"""Kernels of silhouettes: filling of outlines, largest component, tracing of its border."""

from __future__ import annotations

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel


@kernel
def fill_outline(outline: FloatArray, width: int, height: int) -> BoolArray:
    """Return (height, width): the pixels whose centres lie inside an outline (even-odd rule)."""
    inside = np.zeros((height, width), np.bool_)
    count = len(outline)
    for k in range(count):
        x0, y0 = outline[k]
        x1, y1 = outline[(k + 1) % count]
        if y0 > y1:
            x0, y0, x1, y1 = x1, y1, x0, y0
        for row in range(max(int(np.ceil(y0)), 0), min(int(np.ceil(y1)), height)):
            left = x0 + (x1 - x0) * (row - y0) / (y1 - y0)
            for column in range(max(int(np.ceil(left)), 0), width):
                inside[row, column] = not inside[row, column]
    return inside


@kernel
def flood(free: BoolArray, row: int, column: int, eight: bool) -> BoolArray:
    """Return the connected part of `free` that holds a pixel."""
    height, width = free.shape
    seen = np.zeros((height, width), np.bool_)
    stack = np.empty((height * width + 1, 2), np.int64)
    stack[0, 0], stack[0, 1] = row, column
    seen[row, column] = True
    size = 1
    while size > 0:
        size -= 1
        r, c = stack[size, 0], stack[size, 1]
        for dr in range(-1, 2):
            for dc in range(-1, 2):
                if not eight and dr != 0 and dc != 0:
                    continue
                i, j = r + dr, c + dc
                inside = 0 <= i < height and 0 <= j < width
                if inside and free[i, j] and not seen[i, j]:
                    seen[i, j] = True
                    stack[size, 0], stack[size, 1] = i, j
                    size += 1
    return seen


@kernel
def largest_part(mask: BoolArray) -> BoolArray:
    """Return the largest 8-connected part of a mask, the first of equals."""
    left = mask.copy()
    best = np.zeros(mask.shape, np.bool_)
    most = 0
    for row in range(mask.shape[0]):
        for column in range(mask.shape[1]):
            if left[row, column]:
                part = flood(left, row, column, True)
                size = part.sum()
                left &= ~part
                if size > most:
                    best, most = part, size
    return best


@kernel
def trace_border(mask: BoolArray) -> IntArray:
    """Return the outer border (n, 2) of a part as (x, y), 8-connected, by Moore's tracing.

    The border starts at the first pixel in reading order, with the ground to its left.
    """
    height, width = mask.shape
    dx = np.array([1, 1, 0, -1, -1, -1, 0, 1])
    dy = np.array([0, 1, 1, 1, 0, -1, -1, -1])
    border = np.empty((8 * height * width + 8, 2), np.int64)
    place = np.argmax(mask.ravel())
    x, y = place % width, place // width
    if not mask[y, x]:
        return border[:0].copy()
    start_x, start_y, first = x, y, -1
    came, size = 4, 0  # the direction in which the ground lies
    while True:
        step = -1
        for turn in range(1, 9):
            k = (came + turn) % 8
            i, j = y + dy[k], x + dx[k]
            if 0 <= i < height and 0 <= j < width and mask[i, j]:
                step = k
                break
        if step < 0:
            border[0, 0], border[0, 1] = x, y
            return border[:1].copy()
        if x == start_x and y == start_y:
            if first == step:
                return border[:size].copy()
            if first < 0:
                first = step
        border[size, 0], border[size, 1] = x, y
        size += 1
        x, y = x + dx[step], y + dy[step]
        # the last ground pixel that was looked at, seen from the new one
        came = (step + 6) % 8 if step % 2 == 0 else (step + 5) % 8
