"""Painting of a belt with shaded objects on it.

An object is a row of numbers: x, y, semi_major, semi_minor, angle and sweep (length of a body
that follows from the outline along the minor axis, signed, 0 for flat objects) in pixels, the
colour (blue, green, red), kind, and the offset of its texture. Colours are in [0, 1], linear.
"""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core._jit import kernel
from geoprim_core.synthetic._kernels import signed_distance

LID, COIN, FRUIT, STONE = 0, 1, 2, 3
BLUE, KIND, TEXTURE_U, TEXTURE_V, GLOSS = 6, 9, 10, 11, 12
_LIGHT_X, _LIGHT_Y, _LIGHT_Z = -0.42, -0.50, 0.757


@kernel
def tile_at(tile: FloatArray, u: float, v: float) -> float:
    """Return a periodic texture at (u, v), interpolated; its size is a power of two."""
    last = len(tile) - 1
    i, j = int(math.floor(v)), int(math.floor(u))
    fv, fu = v - i, u - j
    i2, j2 = (i + 1) & last, (j + 1) & last
    i, j = i & last, j & last
    upper = tile[i, j] + fu * (tile[i, j2] - tile[i, j])
    lower = tile[i2, j] + fu * (tile[i2, j2] - tile[i2, j])
    return float(upper + fv * (lower - upper))


@kernel
def paint_belt(
    image: FloatArray, tile: FloatArray, colour: FloatArray, grain: float, seam: float, shift: float
) -> None:
    """Fill the image with a belt that has moved by `shift` pixels; seams lie `seam` apart."""
    height, width = image.shape[:2]
    size = len(tile)
    for j in range(width):
        u = j - shift
        left = math.floor(u)
        part = u - left
        left, right = left % size, (left + 1) % size
        gap = abs(u - seam * math.floor(u / seam + 0.5))
        dark = 0.72 if gap < 1.0 else min(1.0, 1.0 - 0.14 * (3.0 - gap))
        for i in range(height):
            line = tile[i % size]
            tone = dark * (1.0 + grain * ((1.0 - part) * line[left] + part * line[right]))
            for c in range(3):
                image[i, j, c] = colour[c] * tone


@kernel
def swept_distance(row: FloatArray, u: float, v: float) -> float:
    """Return the distance from the border of an outline swept along its minor axis.

    It is exact within half a pixel of the border and elsewhere at most the true one.
    """
    a, b, sweep = row[2], row[3], row[5]
    beside = v - min(max(v, min(sweep, 0.0)), max(sweep, 0.0))
    bound = b * (math.sqrt((u / a) ** 2 + (beside / b) ** 2) - 1.0)
    if bound >= 0.5 or bound <= -0.5:
        return float(bound)
    if sweep != 0.0 and beside == 0.0:
        return float(abs(u) - a)
    return signed_distance(u, beside, a, b)


@kernel
def swept_contains(row: FloatArray, u: float, v: float) -> bool:
    """Say whether a point lies inside an outline swept along its minor axis."""
    v -= min(max(v, min(row[5], 0.0)), max(row[5], 0.0))
    return bool((u / row[2]) ** 2 + (v / row[3]) ** 2 < 1.0 - 1e-9)


@kernel
def paint_shadow(image: FloatArray, row: FloatArray, reach: float, depth: float) -> None:
    """Darken what lies below an object, away from the light, with a soft border."""
    height, width = image.shape[:2]
    cosine, sine = math.cos(row[4]), math.sin(row[4])
    x, y = row[0] + 0.55 * reach, row[1] + 0.65 * reach
    around = row[2] + abs(row[5]) + reach * row[2] / row[3] + 1.0
    per_a, per_b, farthest = 1.0 / row[2], 1.0 / row[3], (1.0 + reach / row[3]) ** 2
    for i in range(max(0, int(y - around)), min(height, int(y + around) + 2)):
        for j in range(max(0, int(x - around)), min(width, int(x + around) + 2)):
            u = (j - x) * cosine + (i - y) * sine
            v = (i - y) * cosine - (j - x) * sine
            v -= min(max(v, min(row[5], 0.0)), max(row[5], 0.0))
            square = (u * per_a) ** 2 + (v * per_b) ** 2
            if square < farthest:
                d = row[3] * (math.sqrt(square) - 1.0)
                part = min(0.5 - 0.5 * d / reach, 1.0)
                tone = 1.0 - depth * part * part * (3.0 - 2.0 * part)
                for c in range(3):
                    image[i, j, c] *= tone


@kernel
def shaded_side(nu: float, nv: float, cosine: float, sine: float) -> float:
    """Return how far a direction of the outline points away from the light, in [-1, 1]."""
    return 0.62 * (nu * cosine - nv * sine) + 0.78 * (nu * sine + nv * cosine)


@kernel
def _lid(
    row: FloatArray, tile: FloatArray, u: float, v: float, rho: float, cosine: float, sine: float
) -> tuple[float, float]:
    """Return brightness and gloss of a can's lid: a rolled rim, a panel with a bead, a tab."""
    a, b = row[2], row[3]
    noise = tile_at(tile, row[TEXTURE_U] + 0.15 * u, row[TEXTURE_V] + 3.0 * v)  # brushed metal
    side = shaded_side(u / a, v / b, cosine, sine) / max(rho, 1e-6)
    if rho > 0.86:
        across = (rho - 0.93) / 0.07
        return 0.95 - 0.12 * across * across - 0.12 * side * across, 0.10 * (1 - across * across)
    bright = 0.74 + 0.05 * noise + 0.13 * side * rho
    if rho > 0.80:
        bright -= 0.34 * (0.5 - 0.5 * side) * (rho - 0.80) / 0.06
    tab = (u / (0.17 * a)) ** 4 + ((v - 0.28 * b) / (0.34 * b)) ** 4  # no ellipse
    if tab < 1.0:
        bright += 0.12 if tab < 0.5 else -0.16
    return bright, 0.05


@kernel
def _coin(
    row: FloatArray, tile: FloatArray, u: float, v: float, rho: float, cosine: float, sine: float
) -> tuple[float, float]:
    """Return brightness and gloss of a coin: a raised rim and an embossed picture."""
    a = row[2]
    turn = row[TEXTURE_U]
    p, q = 26.0 * u / a + 7.0 * turn, 26.0 * v / a + row[TEXTURE_V]
    emboss = tile_at(tile, p + 1.3, q + 1.3) - tile_at(tile, p - 1.3, q - 1.3)
    wear = tile_at(tile, 60.0 * u / a + turn, 60.0 * v / a)
    side = shaded_side(u / a, v / a, cosine, sine) / max(rho, 1e-6)
    if rho > 0.90:
        return 0.98 - 0.22 * side * (rho - 0.95) / 0.05 + 0.03 * wear, 0.10
    if rho > 0.86:
        return 0.74 + 0.12 * side, 0.0
    bright = 0.84 + 0.04 * wear
    if rho > 0.70:
        letters = math.sin(34.0 * math.atan2(v, u) + turn)
        return bright + (0.09 * letters if rho < 0.82 else 0.0), 0.05
    return bright + 0.13 * emboss, 0.06


@kernel
def _fruit(
    row: FloatArray, tile: FloatArray, u: float, v: float, rho: float, cosine: float, sine: float
) -> tuple[float, float]:
    """Return brightness and gloss of a fruit: an ellipsoid with pores and a glossy spot."""
    a, b = row[2], row[3]
    nz = math.sqrt(max(1.0 - rho * rho, 0.0))
    nu, nv = u / a, v / b
    nx = nu * cosine - nv * sine
    ny = nu * sine + nv * cosine
    pores = tile_at(tile, row[TEXTURE_U] + 0.9 * u, row[TEXTURE_V] + 0.9 * v)
    blotch = tile_at(tile, row[TEXTURE_U] + 0.12 * u, row[TEXTURE_V] + 0.12 * v)
    facing = max(nx * _LIGHT_X + ny * _LIGHT_Y + nz * _LIGHT_Z, 0.0)
    mirror = max(2.0 * facing * nz - _LIGHT_Z, 0.0)
    bright = (0.42 + 0.62 * facing) * (1.0 + 0.04 * pores + 0.10 * blotch)
    stem = math.hypot(u - 0.15 * a, v + 0.1 * b) / (0.09 * a)
    if stem < 1.5:
        bright *= 0.45 + 0.55 * max(stem - 0.5, 0.0)
    mirror *= mirror * mirror
    mirror *= mirror
    return bright, row[GLOSS] * mirror * mirror * mirror


@kernel
def _stone(
    row: FloatArray, tile: FloatArray, u: float, v: float, rho: float, cosine: float, sine: float
) -> tuple[float, float]:
    """Return brightness and gloss of a broken stone: facets, grain and glittering specks."""
    p, q = row[TEXTURE_U] + 0.22 * u, row[TEXTURE_V] + 0.22 * v
    slope = tile_at(tile, p + 0.7, q + 0.7) - tile_at(tile, p - 0.7, q - 0.7)
    grain = tile_at(tile, 5.0 * p, 5.0 * q)
    nu, nv = u / row[2], v / row[3]
    round_shape = 0.90 - 0.22 * (nu * (cosine + sine) + nv * (cosine - sine)) * rho
    bright = round_shape * (1.0 + 0.16 * slope + 0.10 * grain)
    return bright, 0.12 * max(grain - 1.6, 0.0)


@kernel
def paint_object(image: FloatArray, row: FloatArray, tile: FloatArray) -> None:
    """Paint one object with its body over the image."""
    height, width = image.shape[:2]
    x, y, a, b, sweep = row[0], row[1], row[2], row[3], row[5]
    cosine, sine = math.cos(row[4]), math.sin(row[4])
    around = a + abs(sweep) + 1.0
    farthest = (1.0 + 0.5 / b) ** 2
    kind = int(row[KIND])
    for i in range(max(0, int(y - around)), min(height, int(y + around) + 2)):
        for j in range(max(0, int(x - around)), min(width, int(x + around) + 2)):
            u = (j - x) * cosine + (i - y) * sine
            v = (i - y) * cosine - (j - x) * sine
            if sweep != 0.0:
                d = swept_distance(row, u, v)
                if d >= 0.5:
                    continue
                across = u / a
                tone = 0.16 + 0.30 * (1.0 - across * across) - 0.10 * across * cosine
                cover = min(0.5 - d, 1.0)
                for c in range(3):
                    image[i, j, c] += cover * (tone * row[BLUE + c] - image[i, j, c])
            square = (u / a) ** 2 + (v / b) ** 2
            if square >= farthest:
                continue
            rho = math.sqrt(square)
            d = b * (rho - 1.0)
            if -0.5 < d < 0.5:
                d = signed_distance(u, v, a, b)
            if d >= 0.5:
                continue
            cover = min(0.5 - d, 1.0)
            rho = min(rho, 1.0)
            if kind == LID:
                bright, gloss = _lid(row, tile, u, v, rho, cosine, sine)
            elif kind == COIN:
                bright, gloss = _coin(row, tile, u, v, rho, cosine, sine)
            elif kind == FRUIT:
                bright, gloss = _fruit(row, tile, u, v, rho, cosine, sine)
            else:
                bright, gloss = _stone(row, tile, u, v, rho, cosine, sine)
            for c in range(3):
                value = bright * row[BLUE + c] + gloss
                image[i, j, c] += cover * (value - image[i, j, c])


@kernel
def soften_rows(image: FloatArray, share: float) -> None:
    """Let every pixel give `share` of its light to its left and right neighbours, in place."""
    height, width = image.shape[:2]
    for i in range(height):
        for c in range(3):
            before = image[i, 0, c]
            for j in range(width):
                here = image[i, j, c]
                after = image[i, min(j + 1, width - 1), c]
                image[i, j, c] = (1.0 - 2.0 * share) * here + share * (before + after)
                before = here


@kernel
def expose(
    image: FloatArray, share: float, light: FloatArray, noise: float, seed: int
) -> np.ndarray:
    """Return the bytes of a camera: uneven light, sensor noise that grows with the signal.

    Every pixel gives `share` of its light to the ones above and below. `light` holds the relative
    brightness in the middle and its change to the right and down.
    """
    height, width = image.shape[:2]
    result = np.empty((height, width, 3), np.uint8)
    state = np.uint64(seed) * np.uint64(2654435769) + np.uint64(88172645463325252)
    for i in range(height):
        down = (i - 0.5 * height) / width
        above, here, below = image[max(i - 1, 0)], image[i], image[min(i + 1, height - 1)]
        for j in range(width):
            right = (j - 0.5 * width) / width
            lit = light[0] + light[1] * right + light[2] * down
            lit *= 255.0 * (1.0 - 0.45 * (right * right + down * down))
            for c in range(3):
                state ^= state << np.uint64(13)
                state ^= state >> np.uint64(7)
                state ^= state << np.uint64(17)
                total = 0.0  # the sum of four bytes is nearly normal
                for k in range(4):
                    total += float((state >> np.uint64(16 + 12 * k)) & np.uint64(255))
                normal = (total - 510.0) / 147.8
                value = (1.0 - 2.0 * share) * here[j, c] + share * (above[j, c] + below[j, c])
                value = max(lit * value, 0.0)
                value += noise * normal * math.sqrt(0.4 + value * (0.6 / 128.0))
                result[i, j, c] = np.uint8(min(max(value, 0.0), 255.0) + 0.5)
    return result


@kernel
def seen_shares(
    rings: FloatArray, owners: np.ndarray, rows: FloatArray, width: int, height: int, samples: int
) -> FloatArray:
    """Return, for each ring (as an ellipse row and a side), its shares in the frame and visible.

    A ring belongs to the object `owners[k]` and is hidden by the objects after it. Side 0 means
    that the whole ring can be seen, +1 or -1 only its half in that direction of the minor axis.
    """
    shares = np.zeros((len(rings), 2))
    for k in range(len(rings)):
        a, b, side = rings[k, 2], rings[k, 3], rings[k, 5]
        cosine, sine = math.cos(rings[k, 4]), math.sin(rings[k, 4])
        total = 0.0
        for s in range(samples):
            t = 2.0 * math.pi * (s + 0.5) / samples
            u, v = a * math.cos(t), b * math.sin(t)
            px = rings[k, 0] + u * cosine - v * sine
            py = rings[k, 1] + u * sine + v * cosine
            length = math.hypot(a * math.sin(t), b * math.cos(t))
            total += length
            if not (-0.5 <= px <= width - 0.5 and -0.5 <= py <= height - 0.5):
                continue
            shares[k, 0] += length
            seen = side * v >= 0.0
            for m in range(owners[k] + 1, len(rows)):
                if not seen:
                    break
                du, dv = px - rows[m, 0], py - rows[m, 1]
                reach = rows[m, 2] + abs(rows[m, 5])
                if du * du + dv * dv < reach * reach:
                    c2, s2 = math.cos(rows[m, 4]), math.sin(rows[m, 4])
                    seen = not swept_contains(rows[m], du * c2 + dv * s2, dv * c2 - du * s2)
            if seen:
                shares[k, 1] += length
        shares[k] /= total
    return shares
