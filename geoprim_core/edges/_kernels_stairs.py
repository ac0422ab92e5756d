"""Kernel that tells edges drawn as stairs from those with grey levels in between."""

from __future__ import annotations

from typing import Any

import numpy as np

from geoprim_core._jit import inlined_kernel, inner_kernel, kernel

OBLIQUE = 0.25  # least ratio of the parts of a gradient; along an axis any edge may be one step
HARD = 0.1  # largest share of what is left of an edge's height beside its largest step


@inlined_kernel
def is_hard(step: Any, before: Any, after: Any) -> Any:
    """Tell whether a step between two pixels has next to nothing of its edge beside it."""
    sign = 1.0 if step >= 0.0 else -1.0
    beside = max(0.0, sign * before) + max(0.0, sign * after)
    return beside <= HARD * abs(step)


@inlined_kernel
def hardness(levels: Any, place: Any, hop: Any) -> Any:
    """Return the square of the largest step at a place of an image, and whether it is hard.

    The steps are those between neighbours `hop` apart. Of two as large both are looked at,
    whichever way the image is turned.
    """
    before, left = np.float64(levels[place - hop - hop]), np.float64(levels[place - hop])
    here = np.float64(levels[place])
    right, after = np.float64(levels[place + hop]), np.float64(levels[place + hop + hop])
    down, up = here - left, right - here
    hard = (abs(down) < abs(up)) | is_hard(down, left - before, up)
    hard &= (abs(up) < abs(down)) | is_hard(up, down, after - right)
    largest = max(abs(down), abs(up))
    return largest * largest, hard


@inner_kernel
def pick_oblique(
    flat: Any, values: Any, dx: Any, dy: Any, least: Any, height: Any, width: Any, chosen: Any
) -> Any:
    """Write those of the edge pixels that are strong and oblique; return how many they are.

    None is within two pixels of the border. They are kept or not without a branch: whether an edge
    is strong is a coin toss.
    """
    size = np.uint64(0)
    for place in flat:
        chosen[size] = place
        size += np.uint64(values[np.uint64(place)] >= least)
    strong, size = size, np.uint64(0)
    first, last = 2 * width, max(height - 2, 0) * width
    row = 0  # where the row of a pixel begins: they rise
    for k in range(strong):
        place = np.int64(chosen[k])
        while row + width <= place:
            row += width
        gx, gy = abs(dx[np.uint64(place)]), abs(dy[np.uint64(place)])
        oblique = min(gx, gy) >= OBLIQUE * max(gx, gy)
        inside = (place >= first) & (place < last) & (place >= row + 2) & (place < row + width - 2)
        chosen[size] = place
        size += np.uint64(oblique & inside)
    return size


@inner_kernel
def add_steps(
    levels: Any, places: Any, dx: Any, dy: Any, stride: Any, width: Any, channel: Any
) -> Any:
    """Return the sum of the squares of the largest steps at places, and that of the hard ones."""
    total = hard = 0.0
    for rising in places:
        place = np.uint64(rising)
        gx, gy = abs(dx[place]), abs(dy[place])
        at = place * stride + channel
        weight, sharp = hardness(levels, at, stride if gx >= gy else stride * width)
        total += weight
        hard += weight if sharp else 0.0
        if gx == gy:
            weight, sharp = hardness(levels, at, stride * width)
            total += weight
            hard += weight if sharp else 0.0
    return total, hard


@kernel
def hard_share(
    flat: Any, values: Any, dx: Any, dy: Any, least: Any, octets: Any, levels: Any, channel: Any
) -> Any:
    """Return the share of oblique edge pixels at which all of the height is one step.

    Of those whose gradient is `least` or more, each with the square of its step: texture and noise
    are low. The image is `octets` or, where that is empty, `levels`: (H, W * S), S values a pixel,
    of which one `channel` is looked at. Of two axes as good both are taken.
    """
    height, width = dx.shape
    along, across = dx.ravel(), dy.ravel()
    chosen = np.empty(len(flat) + 1, np.uint32)
    size = pick_oblique(flat, values.ravel(), along, across, least, height, width, chosen)
    row, one = np.uint64(width), np.uint64(channel)
    if octets.shape[0] > 0:
        stride = np.uint64(octets.shape[1] // width)
        sums = add_steps(octets.ravel(), chosen[:size], along, across, stride, row, one)
    else:
        stride = np.uint64(levels.shape[1] // width)
        sums = add_steps(levels.ravel(), chosen[:size], along, across, stride, row, one)
    return sums[1] / sums[0] if sums[0] > 0.0 else 0.0
