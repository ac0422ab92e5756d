"""Kernels of the `refined` scheme: edge points vote for the centres of small circles."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, Int16Array, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_points import EdgeIndex

CELL = 2.0  # pixels of a bin
LEAST_RADIUS = 4.0  # pixels
ABOVE_CHANCE = 11.0  # votes of a peak above the mean of bins, in roots of it
FACING = 0.64  # least square of the cosine between the normal of a point and its radius
APART = 3.0  # pixels between the radii of two circles around one centre
BANDS = (2.0, 1.5)  # pixels either side of the circle that the points of two fits are in
LEAST_SHARE = 0.45  # points for each pixel of the outline
LEAST_POINTS = 6.0  # that a circle is fitted to
ALONG_LINE = 1e-3  # of the squared spread of points, below which they lie along a line
ROOM = 1024  # points around a centre
CIRCLES = 2  # around one centre, as in a target


@kernel
def cast_votes(
    points: FloatArray, normals: FloatArray, width: int, height: int, steps: int
) -> Int16Array:
    """Return the votes (rows, columns) of edge points for centres along their normals.

    Each votes `steps` times on both sides of its edge, a bin apart. The middle of the image lies
    on a corner of bins: a turned or mirrored image has the same bins. Around the image there is
    room for the votes that leave it.
    """
    first = LEAST_RADIUS / CELL
    margin = int(first) + steps + 2
    rows, columns = 2 * (int(0.5 * height / CELL) + margin), 2 * (int(0.5 * width / CELL) + margin)
    votes = np.zeros((rows, columns), np.int16)
    flat = votes.ravel()
    x0, y0 = 0.5 * (width - 1) / CELL - columns // 2, 0.5 * (height - 1) / CELL - rows // 2
    for k in range(len(points)):
        if not (-1.0 < points[k, 0] < width and -1.0 < points[k, 1] < height):
            continue  # of contours from elsewhere
        x, y = points[k, 0] / CELL - x0, points[k, 1] / CELL - y0
        nx, ny = normals[k, 0], normals[k, 1]
        for m in range(steps):
            u, v = (first + m) * nx, (first + m) * ny
            flat[np.uint64(np.int32(y + v) * columns + np.int32(x + u))] += 1
            flat[np.uint64(np.int32(y - v) * columns + np.int32(x - u))] += 1
    return votes


@kernel
def sum_nine(votes: Int16Array, y: int, three: Int16Array, out: Int16Array) -> int:
    """Write the sums of each bin of row y and the eight around it to `out`; return the largest."""
    above, level, below = votes[y - 1], votes[y], votes[y + 1]
    for x in range(len(three)):
        three[x] = above[x] + level[x] + below[x]
    left, right = three, three[2:]
    middle, inner = three[1:], out[1:]
    most = np.int16(0)
    for x in range(len(right)):
        total = np.int16(left[x] + middle[x] + right[x])
        inner[x] = total
        most = max(most, total)
    return int(most)


@kernel
def find_peaks(votes: Int16Array, width: int, height: int, least: int) -> FloatArray:
    """Return the centres (n, 2) in pixels around which there are most votes, at least so many.

    Counted in three by three bins: normals in noise miss their centre by some pixels. Centres
    outside the image are not looked for.
    """
    rows, columns = votes.shape
    margin = (rows - int(height / CELL)) // 2 - 1
    x0, y0 = 0.5 * (width - 1) - CELL * (columns // 2), 0.5 * (height - 1) - CELL * (rows // 2)
    three, sums = np.zeros(columns, np.int16), np.zeros((3, columns), np.int16)
    peaks = np.empty((64, 2))
    size = high = 0
    for y in range(margin - 1, rows - margin + 1):
        before, high = high, sum_nine(votes, y, three, sums[y % 3])  # of the row above, and here
        if before < least:
            continue
        row = sums[(y - 1) % 3]
        for x in range(margin, columns - margin):
            if row[x] < least or row[x] < sums[:, x - 1 : x + 2].max():
                continue
            if size == len(peaks):
                peaks = np.concatenate((peaks, np.empty((size, 2))))
            peaks[size, 0], peaks[size, 1] = x0 + (x + 0.5) * CELL, y0 + (y - 0.5) * CELL
            size += 1
    return peaks[:size]


@inner_kernel
def gather_facing(
    edges: EdgeIndex,
    x: float,
    y: float,
    near: IntArray,
    tally: IntArray,
) -> int:
    """Put the edge points that face a centre to `near`, tallied by distance; return their number.

    Those nearer than `tally` is long, as far as `near` has room.
    """
    head, following, points, normals = edges
    height, width = head.shape
    flat = head.reshape(head.size)
    reach = len(tally)
    first, last = max(0, int(x) - reach), min(width, int(x) + reach + 2)
    tally[:] = 0
    count = 0
    for row in range(max(0, int(y) - reach), min(height, int(y) + reach + 2)):
        for place in range(row * width + first, row * width + last):
            p = flat[np.uint64(place)]
            while p >= 0:
                at = np.uint64(p)
                dx, dy = points[at, 0] - x, points[at, 1] - y
                square = dx * dx + dy * dy
                along = dx * normals[at, 0] + dy * normals[at, 1]
                if along * along >= FACING * square and square < reach * reach:
                    if count < len(near):
                        near[count] = p
                        count += 1
                        tally[int(math.sqrt(square))] += 1
                p = following[at]
    return count


@kernel
def radius_of(tally: IntArray, other: float) -> float:
    """Return the radius at which most points face a centre, for the root of the radius.

    By that root the number of points that face it by chance scatters. Radii `APART` and less from
    an `other` one do not count; 0 where there is none.
    """
    best = radius = 0.0
    for r in range(int(LEAST_RADIUS) - 1, len(tally) - 1):
        if abs(r + 0.5 - other) <= APART:
            continue
        merit = (tally[r - 1] + tally[r] + tally[r + 1]) / math.sqrt(r + 0.5)
        if merit > best:
            best, radius = merit, r + 0.5
    return radius


@kernel
def fit_circle(points: FloatArray, near: IntArray, circle: FloatArray, band: float) -> int:
    """Refit a circle (x, y, r) in place to those of some points that are within `band` of it.

    Least squares of the algebraic distance. Returns the number of points, 0 where they give none.
    """
    low, high = max(0.0, circle[2] - band) ** 2, (circle[2] + band) ** 2
    n = mu = mv = uu = uv = vv = uz = vz = 0.0
    for p in near:
        u, v = points[p, 0] - circle[0], points[p, 1] - circle[1]
        z = u * u + v * v
        if low <= z <= high:
            n, mu, mv = n + 1.0, mu + u, mv + v
            uu, uv, vv, uz, vz = uu + u * u, uv + u * v, vv + v * v, uz + u * z, vz + v * z
    if n < LEAST_POINTS:
        return 0
    mu, mv, mz = mu / n, mv / n, (uu + vv) / n
    uu, uv, vv = uu / n - mu * mu, uv / n - mu * mv, vv / n - mv * mv
    uz, vz = uz / n - mu * mz, vz / n - mv * mz
    det = uu * vv - uv * uv
    if det <= ALONG_LINE * (uu + vv) ** 2:
        return 0
    a, b = 0.5 * (uz * vv - vz * uv) / det, 0.5 * (vz * uu - uz * uv) / det
    circle[0], circle[1] = circle[0] + a, circle[1] + b
    circle[2] = math.sqrt(max(0.0, mz - 2.0 * (a * mu + b * mv) + a * a + b * b))
    return int(n)


@kernel
def circles_by_votes(edges: EdgeIndex, most: float) -> tuple[FloatArray, IntArray]:
    """Return circles (n, 5), as ellipses, of at most about `most` pixels radius, and their points.

    Their centres are where many edge points put one, whichever contours these are on; two circles
    may have the same.
    """
    points = edges.points
    height, width = edges.head.shape
    steps = int((most - LEAST_RADIUS) / CELL) + 1
    chance = 9.0 * 2.0 * steps * len(points) * CELL * CELL / (width * height)
    least = int(chance + ABOVE_CHANCE * math.sqrt(chance))
    votes = cast_votes(points, edges.normals, width, height, steps)
    peaks = find_peaks(votes, width, height, least)
    near = np.empty(ROOM, np.int64)
    tally = np.zeros(int(most) + 3, np.int64)
    circles = np.zeros((CIRCLES * len(peaks), 5))
    counts = np.empty(CIRCLES * len(peaks), np.int64)
    circle = np.empty(3)
    found = 0
    for k in range(len(peaks)):
        x, y = peaks[k, 0], peaks[k, 1]
        around = near[: gather_facing(edges, x, y, near, tally)]
        radius = 0.0
        for _ in range(CIRCLES):
            radius = radius_of(tally, radius)
            circle[0], circle[1], circle[2] = x, y, radius
            count = 0
            for band in BANDS:
                count = fit_circle(points, around, circle, band)
                if count == 0 or circle[2] < LEAST_RADIUS - 1.0 or circle[2] > most + 1.0:
                    count = 0
                    break
            if count > 0 and count >= LEAST_SHARE * 2.0 * math.pi * circle[2]:
                circles[found, 0], circles[found, 1] = circle[0], circle[1]
                circles[found, 2] = circles[found, 3] = circle[2]
                counts[found] = count
                found += 1
    return circles[:found], counts[:found]
