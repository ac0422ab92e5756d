"""Kernels that read an image row by row through the cache: its gradient, its second differences."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from geoprim_core._jit import inlined_kernel, inner_kernel, kernel, summing_kernel


@inlined_kernel
def repeat_ends(line: Any, reach: Any) -> None:
    """Repeat the first and the last of the values that lie `reach` from the ends of a line."""
    last = len(line) - 1 - reach
    for x in range(reach):
        line[x] = line[reach]
        line[last + 1 + x] = line[last]


@inner_kernel
def load_octets(row: Any, lines: Any, reach: Any) -> None:
    """Write a row (W * S,) of an 8-bit image to lines (C, W + 2 R), its ends repeated outwards.

    A pixel has S values, of which the first C count.
    """
    channels = len(lines)
    width = np.uint64(lines.shape[1] - 2 * reach)
    step = np.uint64(len(row)) // width
    if channels == 3:
        blue, green, red = lines[0, reach:], lines[1, reach:], lines[2, reach:]
        if step == 3:  # with the step known, the compiler shuffles whole vectors
            for x in range(width):
                place = np.uint64(3) * x
                blue[x] = row[place]
                green[x] = row[place + np.uint64(1)]
                red[x] = row[place + np.uint64(2)]
        else:
            for x in range(width):
                place = step * x
                blue[x] = row[place]
                green[x] = row[place + np.uint64(1)]
                red[x] = row[place + np.uint64(2)]
    else:
        line = lines[0, reach:]
        for x in range(width):
            line[x] = row[x]
    for c in range(channels):
        repeat_ends(lines[c], reach)


@inner_kernel
def blur_octets(line: Any, half: Any, short: Any, out: Any) -> None:
    """Do what `blur_levels` does with 8-bit values; `short` is scratch (W,) int16.

    The weights sum to 128, so the sums stay below 2**15: twice as many fit a vector as numbers
    in single precision.
    """
    reach = len(half) - 1
    first, second, third = np.int16(half[0]), np.int16(half[1]), np.int16(half[2])
    left_2, left_1, middle = line[reach - 2 :], line[reach - 1 :], line[reach:]
    right_1, right_2 = line[reach + 1 :], line[reach + 2 :]
    for x in range(len(out)):
        value = first * np.int64(middle[x])
        value += second * (np.int64(left_1[x]) + np.int64(right_1[x]))
        short[x] = value + third * (np.int64(left_2[x]) + np.int64(right_2[x]))
    for t in range(3, reach + 1):
        weight = np.int16(half[t])
        left, right = line[reach - t :], line[reach + t :]
        for x in range(len(out)):
            short[x] += weight * (np.int64(left[x]) + np.int64(right[x]))
    for x in range(len(out)):
        out[x] = short[x]


@inner_kernel
def blur_levels(row: Any, channel: Any, line: Any, half: Any, out: Any) -> None:
    """Blur a channel of a row (W * S,) along; `half` holds the weights from the middle outwards.

    There are at least three of them. `line` is scratch (W + 2 R,).
    """
    reach = len(half) - 1
    step = len(row) // len(out)
    middle = line[reach:]
    for x in range(len(out)):
        middle[x] = row[step * x + channel]
    repeat_ends(line, reach)
    for x in range(len(out)):
        out[x] = half[0] * middle[x]
    for t in range(1, reach + 1):
        weight = half[t]
        left, right = line[reach - t :], line[reach + t :]
        for x in range(len(out)):
            out[x] += weight * (left[x] + right[x])


@inner_kernel
def blur_across(ring: Any, y: Any, height: Any, half: Any, out: Any) -> None:
    """Blur rows of one channel across; row j of the image is row j modulo len(ring) of the ring.

    `out` is (W + 2,), its ends repeated outwards.
    """
    rows = len(ring)
    width = len(out) - 2
    first, second, third = half[0], half[1], half[2]
    middle, inner = ring[y % rows], out[1:]
    upper_1, lower_1 = ring[max(y - 1, 0) % rows], ring[min(y + 1, height - 1) % rows]
    upper_2, lower_2 = ring[max(y - 2, 0) % rows], ring[min(y + 2, height - 1) % rows]
    for x in range(width):
        value = first * middle[x] + second * (upper_1[x] + lower_1[x])
        inner[x] = value + third * (upper_2[x] + lower_2[x])
    for t in range(3, len(half)):
        weight = half[t]
        upper, lower = ring[max(y - t, 0) % rows], ring[min(y + t, height - 1) % rows]
        for x in range(width):
            inner[x] += weight * (upper[x] + lower[x])
    repeat_ends(out, 1)


@inlined_kernel
def sobel(above: Any, level: Any, below: Any, x: Any) -> Any:
    """Return the Sobel sums of a pixel; the rows begin one pixel further left."""
    middle, right = x + np.uint64(1), x + np.uint64(2)
    gx = above[right] + (level[right] + level[right]) + below[right]
    gx = gx - (above[x] + (level[x] + level[x]) + below[x])
    centre = below[middle] - above[middle]
    gy = (below[x] - above[x]) + (centre + centre) + (below[right] - above[right])
    return gx, gy


@inner_kernel
def write_one(
    smooth: Any, above: Any, level: Any, below: Any, scale: Any, dx: Any, dy: Any, values: Any
) -> None:
    """Write a row of the gradient and its magnitude; above, level and below are rows of smooth."""
    up, here, down = smooth[0, above], smooth[0, level], smooth[0, below]
    for x in range(np.uint64(len(dx))):
        gx, gy = sobel(up, here, down, x)
        gx, gy = gx * scale, gy * scale
        dx[x] = gx
        dy[x] = gy
        values[x] = math.sqrt(gx * gx + gy * gy)


@inner_kernel
def write_strongest(
    smooth: Any, above: Any, level: Any, below: Any, scale: Any, dx: Any, dy: Any, values: Any
) -> None:
    """Do what `write_one` does with the channel of three where the gradient is largest.

    One loop without branches: vector instructions, and no channel is written and read again.
    """
    up_0, here_0, down_0 = smooth[0, above], smooth[0, level], smooth[0, below]
    up_1, here_1, down_1 = smooth[1, above], smooth[1, level], smooth[1, below]
    up_2, here_2, down_2 = smooth[2, above], smooth[2, level], smooth[2, below]
    for x in range(np.uint64(len(dx))):
        gx, gy = sobel(up_0, here_0, down_0, x)
        most = gx * gx + gy * gy
        other_x, other_y = sobel(up_1, here_1, down_1, x)
        size = other_x * other_x + other_y * other_y
        larger = size > most
        gx = other_x if larger else gx
        gy = other_y if larger else gy
        most = size if larger else most
        other_x, other_y = sobel(up_2, here_2, down_2, x)
        larger = other_x * other_x + other_y * other_y > most
        gx = (other_x if larger else gx) * scale
        gy = (other_y if larger else gy) * scale
        dx[x] = gx
        dy[x] = gy
        values[x] = math.sqrt(gx * gx + gy * gy)


@summing_kernel
def row_sums(row: Any) -> Any:
    """Return the sum of the magnitudes of a row and that of their squares."""
    total = squares = 0.0
    for x in range(len(row)):
        value = np.float64(row[x])
        total += value
        squares += value * value
    return total, squares


class RowRoom(NamedTuple):
    """Room for the few rows of an image that `gradient` works on: W columns, C channels.

    Attributes
    ----------
    lines : (C, W + 2 R) uint8
        A row of an 8-bit image, its ends repeated, for a blur that reaches R pixels.
    short : (W,) int16
    line : (W + 2 R,) float32
        A row of one channel of another image.
    ring : (C, 2 R + 1, W) float32
        Rows blurred along.
    smooth : (C, 3, W + 2) float32
        Rows blurred both ways.
    crest : (W,) float32
        The largest magnitude of each column.
    """

    lines: Any
    short: Any
    line: Any
    ring: Any
    smooth: Any
    crest: Any


@inner_kernel
def write_rows(
    octets: Any, levels: Any, half: Any, scale: Any, room: Any, dx: Any, dy: Any, values: Any
) -> Any:
    """Do what `gradient` does, with room for a few rows of each channel."""
    lines, short, line, ring, smooth, crest = room
    height, width = values.shape
    channels, rows = ring.shape[0], ring.shape[1]
    read = 0
    blurred = np.int64(0)  # a constant would make a second specialisation
    total = squares = 0.0
    for y in range(height):
        while blurred < min(y + 2, height):
            while read < min(blurred + len(half), height):
                if octets.shape[0] > 0:
                    load_octets(octets[read], lines, len(half) - 1)
                for c in range(channels):
                    if octets.shape[0] > 0:
                        blur_octets(lines[c], half, short, ring[c, read % rows])
                    else:
                        blur_levels(levels[read], c, line, half, ring[c, read % rows])
                read += 1
            for c in range(channels):
                blur_across(ring[c], blurred, height, half, smooth[c, blurred % 3])
            blurred += 1
        above, level, below = max(y - 1, 0) % 3, y % 3, min(y + 1, height - 1) % 3
        if channels == 1:
            write_one(smooth, above, level, below, scale, dx[y], dy[y], values[y])
        else:
            write_strongest(smooth, above, level, below, scale, dx[y], dy[y], values[y])
        row = values[y]  # still in the cache
        for x in range(width):
            crest[x] = row[x] if row[x] > crest[x] else crest[x]
        plain, square = row_sums(row)
        total += plain
        squares += square
    return total, squares


@kernel
def gradient(
    octets: Any, levels: Any, channels: Any, half: Any, scale: Any, dx: Any, dy: Any, values: Any
) -> Any:
    """Write dx, dy and their magnitude, (H, W) float32, of the strongest channel of an image.

    The image is `octets` or, where that is empty, `levels`: (H, W * S), S values a pixel, of
    which the first `channels`, 1 or 3, count. `half` holds three or more weights of the blur from
    the middle outwards; the border is repeated, before the blur and again after it. Only a few
    rows are in work at a time, so they stay in the cache. The largest magnitude is returned, the
    sum of all and that of their squares.
    """
    width = values.shape[1]
    reach = len(half) - 1
    room = RowRoom(
        np.empty((channels, width + 2 * reach), np.uint8),
        np.empty(width, np.int16),
        np.empty(width + 2 * reach, np.float32),
        np.empty((channels, 2 * reach + 1, width), np.float32),
        np.empty((channels, 3, width + 2), np.float32),
        np.zeros(width, np.float32),
    )
    total, squares = write_rows(octets, levels, half, scale, room, dx, dy, values)
    return room.crest.max(), total, squares


@inner_kernel
def write_checkers(
    octets: Any, levels: Any, middle: Any, lines: Any, ring: Any, crest: Any, out: Any
) -> None:
    """Do what `checkers` does, with room for a few rows, and write the largest of each column."""
    height, width = len(out) + 2, ring.shape[1]
    for y in range(height):
        line = ring[y % 3]
        if octets.shape[0] > 0:
            load_octets(octets[y], lines, lines.shape[1] - width)
            octet = lines[middle]
            for x in range(width):
                line[x] = octet[x]
        else:
            step = levels.shape[1] // width
            for x in range(width):
                line[x] = levels[y, step * x + middle]
        if y < 2:
            continue
        above, level, below, row = ring[(y - 2) % 3], ring[(y - 1) % 3], line, out[y - 2]
        for x in range(len(row)):
            corners = (above[x] + above[x + 2]) + (below[x] + below[x + 2])
            sides = (above[x + 1] + below[x + 1]) + (level[x] + level[x + 2])
            value = abs(corners - (sides + sides) + np.float32(4.0) * level[x + 1])
            row[x] = value
            crest[x] = value if value > crest[x] else crest[x]


@kernel
def checkers(octets: Any, levels: Any, channels: Any, out: Any) -> Any:
    """Write the magnitude of second differences along and across (H - 2, W - 2) of an image.

    Straight edges along either axis and smooth shading give zero, noise does not. The image is
    that of `gradient`; of three channels the second counts. The largest difference is returned.
    """
    width = out.shape[1] + 2
    lines = np.empty((channels, width), np.uint8)
    ring = np.empty((3, width), np.float32)
    crest = np.zeros(width - 2, np.float32)
    write_checkers(octets, levels, channels // 2, lines, ring, crest, out)
    return crest.max()
