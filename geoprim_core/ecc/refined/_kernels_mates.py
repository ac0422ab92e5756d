"""Kernels of the `refined` scheme, strokes: the opposite edge beside each edge, its mate."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, Int32Array, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_second_look import OPPOSITE, MateSearch, complete_mates

WORTHWHILE = 0.5  # share of the mates that a line needs from which more are looked for
END = 6  # points at the end of a line of which only one edge may be seen
DOUBTED = 3.0  # points without a mate that open contours are given: short ones have mates by chance
BLOCK = 64  # points that mates are looked for together, at most
NEAREST = 0.5  # pixels between mates, at least
BIN = 0.25  # pixels, of the tally of distances
LONG = 30.0  # points of a contour; on shorter ones noise decides
LONG_SHARE = 0.5  # or that share of the longest: of small circles all contours are short


class MateRoom(NamedTuple):
    """Room for what `write_gaps` and `look_for_mates` note of `BLOCK` points.

    Attributes
    ----------
    spots : (2 S, BLOCK) int32
        Pixels along the normals, S on either side.
    found : (2, n) int32
        Edge points in these, and whose normal met them: k on the bright side, -1 - k on the dark.
    rows : (6, BLOCK) float64
        x, y and normal of the points, distance to the nearest mate on the dark and bright side.
    tallies : (2, m) int64
        Of the distances on either side.
    """

    spots: Int32Array
    found: Int32Array
    rows: FloatArray
    tallies: IntArray


@inner_kernel
def spots_along(
    rows: FloatArray, count: int, far: float, width: int, height: int, spots: Int32Array
) -> None:
    """Write the flat indices of the pixels `far` along the normals of some points, -1 outside.

    `rows` are x, y and the normal. The body has no branches, so that it compiles to vector
    instructions.
    """
    xs, ys, across_x, across_y = rows[0], rows[1], rows[2], rows[3]
    for k in range(count):
        x, y = xs[k] + far * across_x[k] + 0.5, ys[k] + far * across_y[k] + 0.5
        within = (x >= 0.0) & (y >= 0.0) & (x < width) & (y < height)
        spot = np.int32(y if within else 0.0) * width + np.int32(x if within else 0.0)
        spots[k] = spot if within else -1


@inner_kernel
def write_gaps(search: MateSearch, first: int, last: int, room: MateRoom, gaps: FloatArray) -> None:
    """Write the `gaps` (see `find_mates`) of the points first .. last - 1, at most `BLOCK`.

    The points found are kept or not without a branch, as most pixels hold none.
    """
    head, following, points, normals = search.edges
    heights, evenness, reach = search.heights, search.evenness, search.reach
    spots, found, rows = room.spots, room.found, room.rows
    height, width = head.shape
    flat = head.reshape(head.size)
    steps = len(spots) // 2
    for k in range(last - first):
        rows[0, k], rows[1, k] = points[first + k, 0], points[first + k, 1]
        rows[2, k], rows[3, k] = normals[first + k, 0], normals[first + k, 1]
        rows[4, k] = rows[5, k] = reach
    for row in range(2 * steps):
        far = -1 - row if row < steps else row - steps + 1
        spots_along(rows, last - first, float(far), width, height, spots[row])
    size = 0
    for k in range(last - first):
        for row in range(2 * steps):
            at = spots[row, k]
            p = flat[np.uint64(max(at, 0))]
            found[0, np.uint64(size)] = p
            found[1, np.uint64(size)] = k if row >= steps else -1 - k
            size += (at >= 0) & (p >= 0)
    for m in range(size):
        p, code = found[0, m], found[1, m]
        k = code if code >= 0 else -1 - code
        side = 1.0 if code >= 0 else -1.0
        nearest = rows[5 if code >= 0 else 4]
        x, y, nx, ny = rows[0, k], rows[1, k], rows[2, k], rows[3, k]
        while p >= 0:
            at = np.uint64(p)
            dx, dy = points[at, 0] - x, points[at, 1] - y
            along = side * (dx * nx + dy * ny)
            dot = normals[at, 0] * nx + normals[at, 1] * ny
            low, high = heights[at], heights[first + k]
            even = (low >= evenness * high) & (high >= evenness * low)
            nearer = even & (dot < OPPOSITE) & (along > NEAREST) & (along < nearest[k])
            nearest[k] = along if nearer else nearest[k]
            p = following[at]
    for k in range(last - first):
        for row in range(2):
            gaps[row, first + k] = rows[4 + row, k] if rows[4 + row, k] < reach else 0.0


@inner_kernel
def least_long(offsets: IntArray) -> float:
    """Return the number of points from which a contour is a long one."""
    longest = 0
    for c in range(len(offsets) - 1):
        longest = max(longest, offsets[c + 1] - offsets[c])
    return min(LONG, LONG_SHARE * longest)


@inner_kernel
def points_of_long(offsets: IntArray, shortest: float) -> int:
    """Return how many points all long contours have."""
    total = 0
    for c in range(len(offsets) - 1):
        size = offsets[c + 1] - offsets[c]
        total += size if size >= shortest else 0
    return total


@inner_kernel
def count_distances(gaps: FloatArray, first: int, last: int, tallies: IntArray) -> None:
    """Add the gaps of the points first .. last - 1 to the tallies of the two sides."""
    for side in range(2):
        own, tally = gaps[side], tallies[side]
        for k in range(first, last):
            tally[np.uint64(own[k] / BIN)] += own[k] > 0.0


@inner_kernel
def most_alike(tally: IntArray, within: float) -> int:
    """Return a bound from above of how many distances of a tally lie `within` so much of one."""
    span = int(2.0 * within / BIN) + 2
    most = inside = 0
    for k in range(len(tally)):
        inside += tally[k] - (tally[k - span] if k >= span else 0)
        most = max(most, inside)
    return most


@inner_kernel
def look_for_mates(
    search: MateSearch,
    first: int,
    last: int,
    needed: float,
    fewest: float,
    within: float,
    twice: bool,
    room: MateRoom,
    gaps: FloatArray,
) -> None:
    """Write the gaps of the points of a contour, after one or two looks.

    Not of all, as soon as it is certain that fewer than `fewest` of those on a side lie `within`
    so much of one distance. The second look is where a share of `needed` already does.
    """
    tallies = room.tallies
    tallies[:] = 0
    for k in range(first, last, BLOCK):
        end = min(k + BLOCK, last)
        write_gaps(search, k, end, room, gaps)
        count_distances(gaps, k, end, tallies)
        alike = max(most_alike(tallies[0], within), most_alike(tallies[1], within))
        if alike + last - end < fewest:
            return
    for side in range(2 if twice else 0):
        if most_alike(tallies[side], within) >= WORTHWHILE * needed:
            complete_mates(search, first, last, 2.0 * side - 1.0, gaps[side])


@kernel
def find_mates(
    search: MateSearch,
    offsets: IntArray,
    closed: BoolArray,
    least: int,
    alone: float,
    share: float,
    within: float,
) -> tuple[FloatArray, bool]:
    """Return for every edge point the distances (2, N) to the nearest opposite edges, else 0.

    One on the dark, one on the bright side. A mate lies along the gradient, its own
    gradient points the other way and is about as high: on either side of a line is the same
    ground, but not of a rim. On contours of `least` points mates
    are looked for twice (`complete_mates`).

    Also returned is whether more than a `share` of the points on long contours may have mates at
    one distance, to `within` so much. Of most images it is soon certain that they have not, and
    then of most contours that they have no width of their own, for which a share `alone` of their
    points needs such mates: the rest of these is not looked at.
    """
    steps = int(search.reach)
    gaps = np.zeros((2, len(search.heights)))
    tallies = np.zeros((2, 2, int(search.reach / BIN) + 1), np.int64)  # own, of all long contours
    room = MateRoom(
        np.empty((2 * steps, BLOCK), np.int32),
        np.empty((2, 2 * steps * BLOCK + 1), np.int32),
        np.empty((6, BLOCK)),
        tallies[0],
    )
    seen = np.zeros(len(offsets) - 1, np.bool_)
    long = least_long(offsets)
    rest = points_of_long(offsets, long)
    wanted = share * rest
    drawn = rest > wanted
    shortest_open = alone * DOUBTED / (1.0 - alone) if alone < 1.0 else math.inf
    for phase in range(2):
        for c in range(len(seen)):
            first, last = offsets[c], offsets[c + 1]
            if seen[c] or (phase == 0 and (not drawn or last - first < long)):
                continue
            twice = last - first >= least
            needed = alone * (last - first)
            if not closed[c]:
                needed = max(alone * (last - first - 2 * END + DOUBTED), shortest_open)
            fewest = needed * (WORTHWHILE if twice else 1.0)
            if drawn or last - first >= needed:
                fewest = 0.0 if drawn else fewest
                look_for_mates(search, first, last, needed, fewest, within, twice, room, gaps)
            seen[c] = True
            if phase == 0:
                count_distances(gaps, first, last, tallies[1])
                rest -= last - first
                drawn = most_alike(tallies[1, 0] + tallies[1, 1], within) + rest > wanted
    return gaps, drawn


@kernel
def gaps_of_long(gaps: FloatArray, offsets: IntArray) -> FloatArray:
    """Return the gaps (2, n) of the points of all long contours."""
    least = least_long(offsets)
    kept = np.empty(gaps.shape)
    size = 0
    for c in range(len(offsets) - 1):
        own = gaps[:, offsets[c] : offsets[c + 1]]
        if own.shape[1] >= least:
            kept[:, size : size + own.shape[1]] = own
            size += own.shape[1]
    return kept[:, :size]
