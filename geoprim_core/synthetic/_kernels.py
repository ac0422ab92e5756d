"""Distances to ellipses, painting with anti-aliased borders, and what stays visible.

An ellipse is a row x, y, semi_major, semi_minor, angle.
"""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray
from geoprim_core._jit import kernel


@kernel
def signed_distance(u: float, v: float, a: float, b: float) -> float:
    """Return the distance of (u, v) from the ellipse u^2/a^2 + v^2/b^2 = 1, negative inside.

    The foot of the perpendicular is (a^2 u / (t + a^2), b^2 v / (t + b^2)); its t is the root of
    a convex falling function, which Newton's steps approach from below without overshooting.
    """
    u = abs(u)
    v = max(abs(v), 1e-9 * b)
    inside = (u / a) ** 2 + (v / b) ** 2 < 1.0
    t = max(b * v - b * b, a * u - a * a)
    for _ in range(100):
        p = a * u / (t + a * a)
        q = b * v / (t + b * b)
        rest = p * p + q * q - 1.0
        slope = p * p / (t + a * a) + q * q / (t + b * b)
        step = rest / (2.0 * slope)
        t += step
        if step <= 1e-12 * (b * b + abs(t)):
            break
    distance = math.hypot(u - a * a * u / (t + a * a), v - b * b * v / (t + b * b))
    return -distance if inside else distance


@kernel
def distance_map(
    width: int, height: int, row: FloatArray, low: float, high: float, result: FloatArray
) -> None:
    """Write each pixel's distance from the outline, clipped to [low, high], into `result`."""
    x, y, a, b = row[0], row[1], row[2], row[3]
    cosine, sine = math.cos(row[4]), math.sin(row[4])
    result[:] = high
    half_width = math.hypot(a * cosine, b * sine) + high
    half_height = math.hypot(a * sine, b * cosine) + high
    for i in range(max(0, int(y - half_height)), min(height, int(y + half_height) + 2)):
        for j in range(max(0, int(x - half_width)), min(width, int(x + half_width) + 2)):
            u = (j - x) * cosine + (i - y) * sine
            v = (i - y) * cosine - (j - x) * sine
            # b |rho - 1| never exceeds the distance: far pixels need no Newton steps
            bound = b * (math.sqrt((u / a) ** 2 + (v / b) ** 2) - 1.0)
            if low < bound < high:
                result[i, j] = min(max(signed_distance(u, v, a, b), low), high)
            else:
                result[i, j] = low if bound <= low else high


@kernel
def paint_filled(image: FloatArray, rows: FloatArray, levels: FloatArray) -> None:
    """Paint ellipses over one another in their order."""
    height, width = image.shape
    distance = np.empty((height, width))
    for k in range(len(rows)):
        distance_map(width, height, rows[k], -0.5, 0.5, distance)
        for i in range(height):
            for j in range(width):
                if distance[i, j] < 0.5:
                    image[i, j] += (0.5 - distance[i, j]) * (levels[k] - image[i, j])


@kernel
def paint_added(image: FloatArray, rows: FloatArray, steps: FloatArray) -> None:
    """Add each ellipse's grey-level step to the pixels that it covers."""
    height, width = image.shape
    distance = np.empty((height, width))
    for k in range(len(rows)):
        distance_map(width, height, rows[k], -0.5, 0.5, distance)
        for i in range(height):
            for j in range(width):
                image[i, j] += (0.5 - distance[i, j]) * steps[k]


@kernel
def paint_parity(image: FloatArray, rows: FloatArray) -> None:
    """Turn an image of zeros into the even-odd cover of the ellipses, in [0, 1]."""
    height, width = image.shape
    distance = np.empty((height, width))
    for k in range(len(rows)):
        distance_map(width, height, rows[k], -0.5, 0.5, distance)
        for i in range(height):
            for j in range(width):
                cover = 0.5 - distance[i, j]
                image[i, j] += cover * (1.0 - 2.0 * image[i, j])


@kernel
def paint_outlines(
    image: FloatArray, rows: FloatArray, levels: FloatArray, paper: float, stroke: float, hide: bool
) -> None:
    """Draw the outlines as lines of a given width; with `hide` an ellipse covers earlier ones."""
    height, width = image.shape
    distance = np.empty((height, width))
    reach = 0.5 * stroke + 0.5
    for k in range(len(rows)):
        distance_map(width, height, rows[k], -reach, reach, distance)
        for i in range(height):
            for j in range(width):
                d = distance[i, j]
                if hide and d < 0.5:
                    image[i, j] += min(0.5 - d, 1.0) * (paper - image[i, j])
                if abs(d) < reach:
                    cover = min(reach - abs(d), 1.0, stroke)
                    image[i, j] += cover * (levels[k] - image[i, j])


@kernel
def visible_shares(
    rows: FloatArray, hide: bool, width: int, height: int, samples: int
) -> FloatArray:
    """Return which share of each outline lies in the frame and, with `hide`, below no later one."""
    count = len(rows)
    shares = np.zeros(count)
    for k in range(count):
        x, y, a, b = rows[k, 0], rows[k, 1], rows[k, 2], rows[k, 3]
        cosine, sine = math.cos(rows[k, 4]), math.sin(rows[k, 4])
        total = 0.0
        for s in range(samples):
            t = 2.0 * math.pi * (s + 0.5) / samples
            length = math.hypot(a * math.sin(t), b * math.cos(t))
            px = x + a * math.cos(t) * cosine - b * math.sin(t) * sine
            py = y + a * math.cos(t) * sine + b * math.sin(t) * cosine
            total += length
            seen = -0.5 <= px <= width - 0.5 and -0.5 <= py <= height - 0.5
            if seen and hide:
                for m in range(k + 1, count):
                    if contains(rows[m], px, py):
                        seen = False
                        break
            if seen:
                shares[k] += length
        shares[k] /= total
    return shares


@kernel
def contains(row: FloatArray, px: float, py: float) -> bool:
    """Say whether a point lies inside an ellipse."""
    cosine, sine = math.cos(row[4]), math.sin(row[4])
    u = (px - row[0]) * cosine + (py - row[1]) * sine
    v = (py - row[1]) * cosine - (px - row[0]) * sine
    return bool((u / row[2]) ** 2 + (v / row[3]) ** 2 < 1.0 - 1e-9)


@kernel
def overlaps(first: FloatArray, second: FloatArray, samples: int) -> bool:
    """Say whether two ellipses have an area in common, judged at points of both outlines."""
    for swap in range(2):
        outline, other = (second, first) if swap else (first, second)
        cosine, sine = math.cos(outline[4]), math.sin(outline[4])
        for s in range(samples):
            t = 2.0 * math.pi * s / samples
            u, v = outline[2] * math.cos(t), outline[3] * math.sin(t)
            px, py = outline[0] + u * cosine - v * sine, outline[1] + u * sine + v * cosine
            if contains(other, px, py):
                return True
    return False


@kernel
def overlap_flags(rows: FloatArray, row: FloatArray) -> BoolArray:
    """Say which rows have an area in common with one further ellipse."""
    flags = np.zeros(len(rows), np.bool_)
    for k in range(len(rows)):
        flags[k] = overlaps(rows[k], row, 256)
    return flags


@kernel
def grey_bytes(image: FloatArray) -> np.ndarray:
    """Round grey levels to bytes."""
    height, width = image.shape
    result = np.empty((height, width), np.uint8)
    for i in range(height):
        for j in range(width):
            result[i, j] = np.uint8(min(max(image[i, j], 0.0), 255.0) + 0.5)
    return result
