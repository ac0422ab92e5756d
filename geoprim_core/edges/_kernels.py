"""Kernels of the Canny edge map: gradient magnitude, non-maximum suppression, hysteresis."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from geoprim_core._jit import kernel

HISTOGRAM_BINS = 4096


@kernel
def magnitude(dx: Any, dy: Any) -> Any:
    """Return the gradient magnitude (H, W) float32."""
    height, width = dx.shape
    values = np.empty((height, width), np.float32)
    for y in range(height):
        along_x, along_y, row = dx[y], dy[y], values[y]
        for x in range(width):
            row[x] = math.sqrt(along_x[x] * along_x[x] + along_y[x] * along_y[x])
    return values


@kernel
def keep_stronger(best_x: Any, best_y: Any, dx: Any, dy: Any) -> None:
    """Replace, in place, the gradients (H, W) by others where those are larger.

    The body has no branches, so that it compiles to vector instructions.
    """
    height, width = best_x.shape
    for y in range(height):
        bx, by, nx, ny = best_x[y], best_y[y], dx[y], dy[y]
        for x in range(width):
            larger = nx[x] * nx[x] + ny[x] * ny[x] > bx[x] * bx[x] + by[x] * by[x]
            bx[x] = nx[x] if larger else bx[x]
            by[x] = ny[x] if larger else by[x]


@kernel
def median_magnitude(values: Any, largest: Any) -> Any:
    """Return the median of magnitudes in [0, largest] from a histogram with root-spaced bins."""
    counts = np.zeros(HISTOGRAM_BINS, np.int64)
    scale = np.float32((HISTOGRAM_BINS - 1) / math.sqrt(largest))
    height, width = values.shape
    for y in range(height):
        for x in range(width):
            counts[int(math.sqrt(values[y, x]) * scale)] += 1
    below = 0
    for k in range(HISTOGRAM_BINS):
        below += counts[k]
        if 2 * below >= values.size:
            return ((k + 0.5) / scale) ** 2 if k else 0.0
    return largest


@kernel
def suppress(values: Any, dx: Any, dy: Any, low: Any, high: Any) -> Any:
    """Return (H, W) uint8: 0 nothing, 1 a local maximum above `low`, 2 one above `high`.

    A maximum exceeds the magnitude one step up the gradient and is not below that one step
    down: of two equal neighbours the brighter side wins, whichever way the image is turned or
    mirrored. The outermost pixels have no such neighbours and stay 0. The body has no
    branches, so that it compiles to vector instructions.
    """
    height, width = values.shape
    low = np.float32(low)
    high = np.float32(high)
    zero = np.float32(0.0)
    state = np.zeros((height, width), np.uint8)
    for y in range(1, height - 1):
        above, level, below = values[y - 1], values[y], values[y + 1]
        along_x, along_y = dx[y, 1:], dy[y, 1:]
        row = state[y, 1:]
        for x in range(width - 2):
            gx = along_x[x]
            gy = along_y[x]
            here = level[x + 1]
            flat = abs(gx) >= abs(gy)
            major = abs(gx) if flat else abs(gy)
            minor = abs(gy) if flat else abs(gx)
            lead = gx if flat else gy
            same = (gx >= zero) == (gy >= zero)
            side_1 = level[x + 2] if flat else below[x + 1]
            side_2 = level[x] if flat else above[x + 1]
            corner_1 = below[x + 2] if same else (above[x + 2] if flat else below[x])
            corner_2 = above[x] if same else (below[x] if flat else above[x + 2])
            # Differences first: equal neighbours then give an exact zero.
            rise_1 = (major - minor) * (here - side_1) + minor * (here - corner_1)
            rise_2 = (major - minor) * (here - side_2) + minor * (here - corner_2)
            up = rise_1 if lead > zero else rise_2
            down = rise_2 if lead > zero else rise_1
            peak = (up > zero) & (down >= zero)
            row[x] = (peak & (here > low)) + (peak & (here > high))
    return state


@kernel
def spread(state: Any, seeds: Any) -> Any:
    """Raise to 2, in place, every 1 that is 8-connected to the 2s at the flat indices `seeds`."""
    width = state.shape[1]
    flat = state.ravel()
    stack = np.empty(2 * len(seeds) + 16, np.int64)
    stack[: len(seeds)] = seeds
    top = len(seeds)
    while top > 0:
        top -= 1
        middle = stack[top]
        if top + 8 > stack.size:
            stack = np.concatenate((stack, np.empty(stack.size, np.int64)))
        for row in (middle - width, middle, middle + width):
            for place in range(row - 1, row + 2):
                if flat[place] == 1:
                    flat[place] = 2
                    stack[top] = place
                    top += 1
