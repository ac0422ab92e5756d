"""Kernel that tells edges drawn as stairs from those with grey levels in between."""

from __future__ import annotations

from typing import Any

import numpy as np

from geoprim_core._jit import inner_kernel, kernel

OBLIQUE = 0.25  # least ratio of the parts of a gradient; along an axis any edge may be one step
HARD = 0.1  # largest share of what is left of an edge's height beside its largest step


@inner_kernel
def is_hard(step: Any, before: Any, after: Any) -> Any:
    """Tell whether a step between two pixels has next to nothing of its edge beside it."""
    sign = 1.0 if step >= 0.0 else -1.0
    beside = max(0.0, sign * before) + max(0.0, sign * after)
    return beside <= HARD * abs(step)


@inner_kernel
def hardness(levels: Any, place: Any, hop: Any) -> Any:
    """Return the square of the largest step at a place of an image, and whether it is hard.

    The steps are those between neighbours `hop` apart. Of two as large both are looked at,
    whichever way the image is turned.
    """
    before, left = np.float64(levels[place - hop - hop]), np.float64(levels[place - hop])
    here = np.float64(levels[place])
    right, after = np.float64(levels[place + hop]), np.float64(levels[place + hop + hop])
    down, up = here - left, right - here
    hard = abs(down) < abs(up) or is_hard(down, left - before, up)
    hard &= abs(up) < abs(down) or is_hard(up, down, after - right)
    largest = max(abs(down), abs(up))
    return largest * largest, hard


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
    magnitudes, along, across = values.ravel(), dx.ravel(), dy.ravel()
    strong = np.empty(len(flat), np.uint32)
    size = np.uint64(0)
    for place in flat:  # without a branch: whether an edge is strong is a coin toss
        strong[size] = place
        size += np.uint64(magnitudes[np.uint64(place)] >= least)
    whole = octets.shape[0] > 0
    whole_levels, real_levels = octets.ravel(), levels.ravel()
    stride = np.uint64((octets.shape[1] if whole else levels.shape[1]) // width)
    first, last = np.uint64(2 * width), np.uint64(max(height - 2, 0) * width)
    row = np.uint64(0)  # where the row of a pixel begins: they rise
    total = hard = 0.0
    for rising in strong[:size]:
        place = np.uint64(rising)
        gx, gy = abs(along[place]), abs(across[place])
        if min(gx, gy) < OBLIQUE * max(gx, gy) or place < first or place >= last:
            continue
        while row + np.uint64(width) <= place:
            row += np.uint64(width)
        if place - row < 2 or place - row >= width - 2:
            continue
        at = place * stride + np.uint64(channel)
        for hop in (stride, stride * np.uint64(width)):
            if (gx < gy) if hop == stride else (gy < gx):
                continue
            if whole:
                weight, sharp = hardness(whole_levels, at, hop)
            else:
                weight, sharp = hardness(real_levels, at, hop)
            total += weight
            hard += weight if sharp else 0.0
    return hard / total if total > 0.0 else 0.0
