"""Kernels of the Canny edge map: noise, non-maximum suppression, hysteresis."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from geoprim_core._jit import inner_kernel, kernel, summing_kernel

HISTOGRAM_BINS = 4096
BLOCK = 128  # pixels of a row
WEAK, STRONG = 1, 2


@summing_kernel
def exceeds(values: Any, limit: Any) -> Any:
    """Return how many values of a row exceed a limit, in single precision as the values."""
    one, none = np.float32(1.0), np.float32(0.0)
    count = none
    for x in range(len(values)):
        count += one if values[x] > limit else none
    return count


@kernel
def median_magnitude(values: Any, largest: Any, least: Any) -> Any:
    """Return the median of magnitudes in [0, largest], or 0 where it is below `least`.

    It is the middle of a bin of a histogram with root-spaced bins. Counting what lies below the
    bin of `least` is a fraction of the work, and mostly enough.
    """
    height, width = values.shape
    scale = np.float32((HISTOGRAM_BINS - 1) / math.sqrt(largest))
    edge = np.float32((math.floor(math.sqrt(min(least, largest)) * scale) / scale) ** 2 * 0.99999)
    above = np.int64(0)
    for y in range(height):
        above += np.int64(exceeds(values[y], edge))
        if 2 * (above + (height - 1 - y) * width) <= values.size:  # whatever is in the rest
            return 0.0
        if 2 * above > values.size:
            break
    counts = np.zeros((2, HISTOGRAM_BINS), np.int32)
    bins = np.empty(width, np.int32)
    for y in range(height):
        row = values[y]
        for x in range(width):
            bins[x] = np.int32(math.sqrt(row[x]) * scale)
        for x in range(width):  # two tables: neighbours often fall in the same bin
            counts[np.uint64(x & 1), np.uint64(bins[x])] += 1
    below = 0
    for k in range(HISTOGRAM_BINS):
        below += counts[0, k] + counts[1, k]
        if 2 * below >= values.size:
            return ((k + 0.5) / scale) ** 2 if k else 0.0
    return largest


@inner_kernel
def suppress_run(
    values: Any, dx: Any, dy: Any, y: Any, first: Any, last: Any, low: Any, high: Any, state: Any
) -> None:
    """Do what `suppress` does with the pixels first .. last - 1 of row y.

    The body has no branches, so that it compiles to vector instructions; all neighbours are read
    before one is chosen, or some are read one by one.
    """
    zero = np.float32(0.0)
    above, level, below = (
        values[y - 1, first - 1 :],
        values[y, first - 1 :],
        values[y + 1, first - 1 :],
    )
    along_x, along_y = dx[y, first:], dy[y, first:]
    row = state[y, first:]
    for x in range(last - first):
        gx = along_x[x]
        gy = along_y[x]
        left, here, right = level[x], level[x + 1], level[x + 2]
        upper_left, upper, upper_right = above[x], above[x + 1], above[x + 2]
        lower_left, lower, lower_right = below[x], below[x + 1], below[x + 2]
        wide, tall = abs(gx), abs(gy)
        flat = wide >= tall
        major = wide if wide > tall else tall
        minor = wide if wide < tall else tall
        lead = gx if flat else gy
        same = (gx >= zero) == (gy >= zero)
        east, west, south, north = here - right, here - left, here - lower, here - upper
        side_1 = east if flat else south
        side_2 = west if flat else north
        eastern = lower_right if same else upper_right
        western = upper_left if same else lower_left
        corner_1 = eastern if flat | same else western
        corner_2 = western if flat | same else eastern
        # Differences first: equal neighbours then give an exact zero.
        rise_1 = (major - minor) * side_1 + minor * (here - corner_1)
        rise_2 = (major - minor) * side_2 + minor * (here - corner_2)
        up = rise_1 if lead > zero else rise_2
        down = rise_2 if lead > zero else rise_1
        peak = (up > zero) & (down >= zero)
        row[x] = (peak & (here > low)) + (peak & (here > high))


@kernel
def suppress(values: Any, dx: Any, dy: Any, low: Any, high: Any, state: Any) -> Any:
    """Set the zeros of `state` (H, W) to 1 at maxima above `low`, 2 above `high`; return where.

    A maximum exceeds the magnitude one step up the gradient and is not below that one step
    down: of two equal neighbours the brighter side wins, whichever way the image is turned or
    mirrored. The outermost pixels have no such neighbours and stay 0. The places are flat
    indices, rising.
    """
    height, width = values.shape
    low = np.float32(low)
    high = np.float32(high)
    peaks = np.empty(values.size // 8 + width, np.uint32)
    size = np.uint64(0)
    for y in range(1, height - 1):
        if np.int64(size) + width > len(peaks):
            peaks = np.concatenate((peaks, np.empty(len(peaks), np.uint32)))
        for first in range(1, width - 1, BLOCK):
            last = min(first + BLOCK, width - 1)
            if not exceeds(values[y, first:last], low):  # flat ground: half of a photograph
                continue
            suppress_run(values, dx, dy, y, first, last, low, high, state)
            row = state[y, first:last]
            start = y * width + first
            for x in range(len(row)):
                peaks[size] = start + x
                size += np.uint64(row[x] != 0)
    return peaks[:size]


@inner_kernel
def around(flat: Any, place: Any, width: Any) -> Any:
    """Return the eight neighbours' states, or-ed."""
    states = flat[np.uint64(place - 1)] | flat[np.uint64(place + 1)]
    for start in (place - width - 1, place + width - 1):
        for neighbour in (start, start + 1, start + 2):
            states |= flat[np.uint64(neighbour)]
    return states


@kernel
def hysteresis(state: Any, peaks: Any) -> Any:
    """Return the flat indices (N,) uint32 of the strong peaks and the weak ones joined to them.

    Weak ones that are 8-connected to a strong one, if only through others, become strong, in
    place.
    """
    width = state.shape[1]
    flat = state.ravel()
    weak = np.empty(len(peaks), np.uint32)
    size = np.uint64(0)
    for peak in peaks:
        weak[size] = peak
        size += np.uint64(flat[peak] == WEAK)
    # Onwards and back without branches: that settles most of them.
    kept = np.uint64(0)
    for peak in weak[:size]:
        flat[peak] |= around(flat, np.int64(peak), width) & STRONG
        weak[kept] = peak
        kept += np.uint64(flat[peak] == WEAK)
    last = np.int64(kept)
    first = last
    for k in range(last - 1, -1, -1):
        peak = weak[np.uint64(k)]
        flat[peak] |= around(flat, np.int64(peak), width) & STRONG
        weak[np.uint64(first - 1)] = peak
        first -= np.int64(flat[peak] == WEAK)
    stack = np.empty(1024, np.int32)
    for peak in weak[first:last]:
        if flat[peak] != WEAK or around(flat, np.int64(peak), width) & STRONG == 0:
            continue
        flat[peak] = STRONG
        stack[0] = peak
        top = 1
        while top > 0:
            top -= 1
            middle = np.int64(stack[top])
            if top + 8 > stack.size:
                stack = np.concatenate((stack, np.empty(stack.size, np.int32)))
            for row in (middle - width, middle, middle + width):
                for place in range(row - 1, row + 2):
                    if flat[place] == WEAK:
                        flat[place] = STRONG
                        stack[top] = place
                        top += 1
    size = np.uint64(0)
    for peak in peaks:
        weak[size] = peak
        size += np.uint64(flat[peak] >= STRONG)
    return weak[:size]
