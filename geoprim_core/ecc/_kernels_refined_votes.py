"""Kernels of the `refined` scheme: edge points vote for the centres of small circles."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.ecc._kernels_refined_outline import Int32Array

CELL = 2.0  # pixels of a bin
LEAST_RADIUS = 4.0  # pixels
ABOVE_CHANCE = 12.0  # votes of a peak above their mean, in roots of it
ALONG = 0.8  # least cosine between the normal of a point and its radius
BANDS = (2.0, 1.5)  # pixels either side of the circle that the points of two fits are in
LEAST_SHARE = 0.45  # points for each pixel of the outline
ROOM = 1024  # points around a centre


@kernel
def cast_votes(
    points: FloatArray, normals: FloatArray, width: int, height: int, most: float
) -> Int32Array:
    """Return the votes (rows, columns) of edge points for centres along their normals.

    Each votes on both sides of its edge, in steps of a bin. The middle of the image lies on a
    corner of bins: a turned or mirrored image has the same bins.
    """
    rows, columns = 2 * int(0.5 * height / CELL + 3.0), 2 * int(0.5 * width / CELL + 3.0)
    votes = np.zeros((rows, columns), np.int32)
    flat = votes.ravel()
    x0, y0 = 0.5 * (width - 1) / CELL - columns // 2, 0.5 * (height - 1) / CELL - rows // 2
    first = LEAST_RADIUS / CELL
    steps = int(most / CELL - first) + 1
    for k in range(len(points)):
        x, y = points[k, 0] / CELL - x0, points[k, 1] / CELL - y0
        for side in range(2):
            nx = -normals[k, 0] if side == 1 else normals[k, 0]
            ny = -normals[k, 1] if side == 1 else normals[k, 1]
            u, v = x + first * nx, y + first * ny
            for _ in range(steps):
                inside = (u >= 0.0) & (v >= 0.0) & (u < columns) & (v < rows)
                at = np.int32(v if inside else 0.0) * columns + np.int32(u if inside else 0.0)
                flat[np.uint64(at)] += inside
                u += nx
                v += ny
    return votes


@kernel
def sums_of_nine(votes: Int32Array) -> Int32Array:
    """Return the sums of each bin and the eight around it; 0 in the outermost bins."""
    rows, columns = votes.shape
    sums = np.zeros((rows, columns), np.int32)
    three = np.empty(columns, np.int32)
    for y in range(1, rows - 1):
        above, level, below, out = votes[y - 1], votes[y], votes[y + 1], sums[y]
        for x in range(columns):
            three[x] = above[x] + level[x] + below[x]
        for x in range(1, columns - 1):
            out[x] = three[x - 1] + three[x] + three[x + 1]
    return sums


@kernel
def find_peaks(votes: Int32Array, width: int, height: int) -> FloatArray:
    """Return the centres (n, 2) in pixels around which there are most votes, far above chance.

    Counted in three by three bins: normals in noise miss their centre by some pixels.
    """
    rows, columns = votes.shape
    sums = sums_of_nine(votes)
    chance = sums.mean()
    least = chance + ABOVE_CHANCE * math.sqrt(chance)
    x0, y0 = 0.5 * (width - 1) - CELL * (columns // 2), 0.5 * (height - 1) - CELL * (rows // 2)
    peaks = np.empty((64, 2))
    size = 0
    for y in range(1, rows - 1):
        for x in range(1, columns - 1):
            here = sums[y, x]
            if here < least or here < sums[y - 1 : y + 2, x - 1 : x + 2].max():
                continue
            if size == len(peaks):
                peaks = np.concatenate((peaks, np.empty((size, 2))))
            peaks[size, 0], peaks[size, 1] = x0 + (x + 0.5) * CELL, y0 + (y + 0.5) * CELL
            size += 1
    return peaks[:size]


@kernel
def gather_around(
    head: Int32Array, following: Int32Array, x: float, y: float, reach: float, near: IntArray
) -> int:
    """Put the edge points around a place to `near`, as far as it has room; return their number."""
    height, width = head.shape
    count = 0
    for row in range(max(0, int(y - reach)), min(height, int(y + reach) + 2)):
        for column in range(max(0, int(x - reach)), min(width, int(x + reach) + 2)):
            p = head[row, column]
            while p >= 0 and count < len(near):
                near[count] = p
                count += 1
                p = following[p]
    return count


@kernel
def radius_of(
    points: FloatArray, normals: FloatArray, near: IntArray, x: float, y: float, tally: IntArray
) -> float:
    """Return the radius around a centre at which most points face it, for the root of the radius.

    By that root the number of points that face it by chance scatters.
    """
    tally[:] = 0
    for p in near:
        dx, dy = points[p, 0] - x, points[p, 1] - y
        r = math.sqrt(dx * dx + dy * dy)
        if r < len(tally) and abs(dx * normals[p, 0] + dy * normals[p, 1]) >= ALONG * r:
            tally[int(r)] += 1
    best = radius = 0.0
    for r in range(int(LEAST_RADIUS) - 1, len(tally) - 1):
        merit = (tally[r - 1] + tally[r] + tally[r + 1]) / math.sqrt(r + 0.5)
        if merit > best:
            best, radius = merit, r + 0.5
    return radius


@kernel
def fit_circle(
    points: FloatArray, normals: FloatArray, near: IntArray, circle: FloatArray, band: float
) -> int:
    """Refit a circle (x, y, r) in place to the points near it that face its centre.

    Least squares of the algebraic distance. Returns the number of points, 0 where they give none.
    """
    n = mu = mv = uu = uv = vv = uz = vz = 0.0
    for p in near:
        u, v = points[p, 0] - circle[0], points[p, 1] - circle[1]
        z = u * u + v * v
        r = math.sqrt(z)
        facing = abs(u * normals[p, 0] + v * normals[p, 1]) >= ALONG * r
        if facing and abs(r - circle[2]) <= band:
            n, mu, mv = n + 1.0, mu + u, mv + v
            uu, uv, vv, uz, vz = uu + u * u, uv + u * v, vv + v * v, uz + u * z, vz + v * z
    if n < 6.0:
        return 0
    mu, mv, mz = mu / n, mv / n, (uu + vv) / n
    uu, uv, vv = uu / n - mu * mu, uv / n - mu * mv, vv / n - mv * mv
    uz, vz = uz / n - mu * mz, vz / n - mv * mz
    det = uu * vv - uv * uv
    if det <= 1e-3 * (uu + vv) ** 2:  # the points lie along a line
        return 0
    a, b = 0.5 * (uz * vv - vz * uv) / det, 0.5 * (vz * uu - uz * uv) / det
    circle[0], circle[1] = circle[0] + a, circle[1] + b
    circle[2] = math.sqrt(max(0.0, mz - 2.0 * (a * mu + b * mv) + a * a + b * b))
    return int(n)


@kernel
def circles_by_votes(
    head: Int32Array, following: Int32Array, points: FloatArray, normals: FloatArray, most: float
) -> tuple[FloatArray, IntArray]:
    """Return circles (n, 5), as ellipses, of at most about `most` pixels radius, and their points.

    Their centres are where many edge points put one, whichever contours these are on.
    """
    height, width = head.shape
    peaks = find_peaks(cast_votes(points, normals, width, height, most), width, height)
    near = np.empty(ROOM, np.int64)
    tally = np.zeros(int(most) + 3, np.int64)
    circles, counts = np.zeros((len(peaks), 5)), np.empty(len(peaks), np.int64)
    circle = np.empty(3)
    found = 0
    for k in range(len(peaks)):
        x, y = peaks[k, 0], peaks[k, 1]
        around = near[: gather_around(head, following, x, y, most + 3.0, near)]
        circle[0], circle[1] = x, y
        circle[2] = radius_of(points, normals, around, x, y, tally)
        count = 0
        for band in BANDS:
            count = fit_circle(points, normals, around, circle, band)
            if count == 0 or circle[2] < LEAST_RADIUS - 1.0 or circle[2] > most + 1.0:
                count = 0
                break
        if count > 0 and count >= LEAST_SHARE * 2.0 * math.pi * circle[2]:
            circles[found, 0], circles[found, 1] = circle[0], circle[1]
            circles[found, 2] = circles[found, 3] = circle[2]
            counts[found] = count
            found += 1
    return circles[:found], counts[:found]
