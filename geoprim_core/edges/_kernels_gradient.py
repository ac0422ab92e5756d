"""Kernel of the gradient: blur, Sobel, strongest channel, row by row through the cache."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from geoprim_core._jit import inner_kernel, kernel


@inner_kernel
def load_row(octets: Any, levels: Any, y: Any, width: Any, channels: Any, line: Any) -> None:
    """Write row y of an image to `line`, channel after channel, its ends repeated outwards.

    The image is `octets` or, where that is empty, `levels`: (H, W * S), S values a pixel, of
    which the first `channels` count. `line` is (channels, W + 2 R).
    """
    reach = (line.shape[1] - width) // 2
    if octets.shape[0] > 0:
        row = octets[y]
        step = len(row) // width
        for c in range(channels):
            plane = line[c, reach:]
            if step == 1:
                for x in range(width):
                    plane[x] = row[x]
            elif step == 3:
                part = row[c:]
                for x in range(width):
                    plane[x] = part[3 * x]
            else:
                for x in range(width):
                    plane[x] = row[step * x + c]
    else:
        step = levels.shape[1] // width
        for c in range(channels):
            for x in range(width):
                line[c, reach + x] = levels[y, step * x + c]
    for c in range(channels):
        for x in range(reach):
            line[c, x] = line[c, reach]
            line[c, reach + width + x] = line[c, reach + width - 1]


@inner_kernel
def blur_along(line: Any, half: Any, out: Any) -> None:
    """Blur a padded line of one channel; `half` holds the weights from the middle outwards."""
    reach = len(half) - 1
    middle = line[reach:]
    weight = half[0]
    for x in range(len(out)):
        out[x] = weight * middle[x]
    for t in range(1, reach + 1):
        weight = half[t]
        left, right = line[reach - t :], line[reach + t :]
        for x in range(len(out)):
            out[x] += weight * (left[x] + right[x])


@inner_kernel
def blur_across(ring: Any, y: Any, height: Any, half: Any, out: Any) -> None:
    """Blur rows of one channel across; row j of the image is row j modulo len(ring) of the ring."""
    rows = len(ring)
    middle = ring[y % rows]
    weight = half[0]
    for x in range(len(out)):
        out[x] = weight * middle[x]
    for t in range(1, len(half)):
        weight = half[t]
        upper, lower = ring[max(y - t, 0) % rows], ring[min(y + t, height - 1) % rows]
        for x in range(len(out)):
            out[x] += weight * (upper[x] + lower[x])


@inner_kernel
def sobel(above: Any, level: Any, below: Any, scale: Any, sums: Any, dx: Any, dy: Any) -> None:
    """Write the Sobel gradient of one row of a channel; `sums` is scratch (2, W + 2)."""
    width = len(dx)
    along, across = sums[0, 1:], sums[1, 1:]
    for x in range(width):
        along[x] = above[x] + (level[x] + level[x]) + below[x]
        across[x] = below[x] - above[x]
    for c in range(2):
        sums[c, 0] = sums[c, 1]
        sums[c, width + 1] = sums[c, width]
    left, right = sums[0], sums[0, 2:]
    for x in range(width):
        dx[x] = (right[x] - left[x]) * scale
    left, middle, right = sums[1], sums[1, 1:], sums[1, 2:]
    for x in range(width):
        dy[x] = (left[x] + (middle[x] + middle[x]) + right[x]) * scale


@inner_kernel
def keep_stronger(best_x: Any, best_y: Any, dx: Any, dy: Any) -> None:
    """Replace, in place, the gradients of a row by others where those are larger.

    The body has no branches, so that it compiles to vector instructions.
    """
    for x in range(len(dx)):
        larger = dx[x] * dx[x] + dy[x] * dy[x] > best_x[x] * best_x[x] + best_y[x] * best_y[x]
        best_x[x] = dx[x] if larger else best_x[x]
        best_y[x] = dy[x] if larger else best_y[x]


@inner_kernel
def write_rows(
    octets: Any, levels: Any, half: Any, scale: Any, line: Any, ring: Any, smooth: Any, sums: Any,
    other: Any, dx: Any, dy: Any, values: Any,
) -> None:  # fmt: skip
    """Do what `gradient` does, with room for a few rows of each channel."""
    height, width = values.shape
    channels, rows = ring.shape[0], ring.shape[1]
    read = 0
    blurred = 0
    for y in range(height):
        while blurred < min(y + 2, height):
            while read < min(blurred + len(half), height):
                load_row(octets, levels, read, width, channels, line)
                for c in range(channels):
                    blur_along(line[c], half, ring[c, read % rows])
                read += 1
            for c in range(channels):
                blur_across(ring[c], blurred, height, half, smooth[c, blurred % 3])
            blurred += 1
        above, below = max(y - 1, 0) % 3, min(y + 1, height - 1) % 3
        along_x, along_y, row = dx[y], dy[y], values[y]
        for c in range(channels):
            part = smooth[c]
            if c == 0:
                sobel(part[above], part[y % 3], part[below], scale, sums, along_x, along_y)
            else:
                sobel(part[above], part[y % 3], part[below], scale, sums, other[0], other[1])
                keep_stronger(along_x, along_y, other[0], other[1])
        for x in range(width):
            row[x] = math.sqrt(along_x[x] * along_x[x] + along_y[x] * along_y[x])


@kernel
def gradient(
    octets: Any, levels: Any, channels: Any, half: Any, scale: Any, dx: Any, dy: Any, values: Any
) -> None:
    """Write dx, dy and their magnitude, (H, W) float32, of the strongest channel of an image.

    The image is `octets` or, where that is empty, `levels`, as in `load_row`; `half` holds the
    weights of the blur from the middle outwards; the border is repeated, before the blur and
    again after it. Only a few rows are in work at a time, so they stay in the cache.
    """
    width = values.shape[1]
    reach = len(half) - 1
    line = np.empty((channels, width + 2 * reach), np.float32)
    ring = np.empty((channels, 2 * reach + 1, width), np.float32)
    smooth = np.empty((channels, 3, width), np.float32)
    sums = np.empty((2, width + 2), np.float32)
    other = np.empty((2, width), np.float32)
    write_rows(octets, levels, half, scale, line, ring, smooth, sums, other, dx, dy, values)
