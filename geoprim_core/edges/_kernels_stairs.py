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


@kernel
def hard_share(
    flat: Any, values: Any, dx: Any, dy: Any, least: Any, octets: Any, levels: Any, channel: Any
) -> Any:
    """Return the share of oblique edge pixels at which all of the height is one step.

    Of those whose gradient is `least` or more, each with the square of its step: texture and noise
    are low. The image is `octets` or, where that is empty, `levels`: (H, W * S), S values a pixel,
    of which one `channel` is looked at. Of two axes or steps as good both are taken, whichever way
    the image is turned.
    """
    height, width = dx.shape
    magnitudes = values.ravel()
    strong = np.empty(len(flat), np.uint32)
    size = np.uint64(0)
    for place in flat:  # without a branch: whether an edge is strong is a coin toss
        strong[size] = place
        size += np.uint64(magnitudes[np.uint64(place)] >= least)
    whole = octets.shape[0] > 0
    stride = (octets.shape[1] if whole else levels.shape[1]) // width
    line, step = np.empty(5), np.empty(4)
    total = hard = 0.0
    for place in strong[:size]:
        y = np.int64(place) // width
        x = np.int64(place) - y * width
        gx, gy = abs(dx[y, x]), abs(dy[y, x])
        if min(gx, gy) < OBLIQUE * max(gx, gy):
            continue
        if x < 2 or y < 2 or x >= width - 2 or y >= height - 2:
            continue
        for axis in range(2):
            if (gx < gy) if axis == 0 else (gy < gx):
                continue
            for k in range(5):
                row = y + (k - 2 if axis == 1 else 0)
                at_x = (x + (k - 2 if axis == 0 else 0)) * stride + channel
                line[k] = octets[row, at_x] if whole else levels[row, at_x]
            for k in range(4):
                step[k] = line[k + 1] - line[k]
            first, second = abs(step[1]) >= abs(step[2]), abs(step[2]) >= abs(step[1])
            sharp = not first or is_hard(step[1], step[0], step[2])
            sharp &= not second or is_hard(step[2], step[1], step[3])
            weight = max(abs(step[1]), abs(step[2])) ** 2
            total += weight
            hard += weight if sharp else 0.0
    return hard / total if total > 0.0 else 0.0
