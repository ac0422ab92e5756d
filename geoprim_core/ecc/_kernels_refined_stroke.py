"""Kernels of step 4 of the `refined` scheme: the two edges of one drawn line."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc._kernels_refined_outline import Int32Array

FARTHEST = 1.5  # pixels that a point in the pixel of a step may be nearer than the step
ALIKE = 1.0  # pixels between the width of a line here and its typical width
DOUBTED = 5.0  # points without a mate that each contour is given: short ones have mates by chance
FOLLOWED = 5.0  # points with a mate that it is given in an image of lines
BLOCK = 64  # points that mates are looked for together, at most
LONG = 30.0  # points of a contour; on shorter ones noise decides
LONG_SHARE = 0.5  # or that share of the longest: of small circles all contours are short
FOLLOWING = 0.1  # share of mates from which a contour is a line in an image of lines


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
def write_gaps(
    head: Int32Array,
    following: Int32Array,
    points: FloatArray,
    normals: FloatArray,
    reach: float,
    first: int,
    last: int,
    spots: Int32Array,
    found: Int32Array,
    rows: FloatArray,
    gaps: FloatArray,
) -> None:
    """Write the `gaps` (see `find_mates`) of the points first .. last - 1, at most `BLOCK`.

    The points found are kept or not without a branch, as most pixels hold none.
    """
    height, width = head.shape
    flat = head.reshape(head.size)
    steps = len(spots) // 2
    nearest = rows[4]
    for k in range(last - first):
        rows[0, k], rows[1, k] = points[first + k, 0], points[first + k, 1]
        rows[2, k], rows[3, k] = normals[first + k, 0], normals[first + k, 1]
    for row in range(2 * steps):
        far = -1 - row if row < steps else row - steps + 1
        spots_along(rows, last - first, float(far), width, height, spots[row])
    size = 0
    for k in range(last - first):
        nearest[k] = reach
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
        x, y, nx, ny = rows[0, k], rows[1, k], rows[2, k], rows[3, k]
        while p >= 0:
            at = np.uint64(p)
            dx, dy = points[at, 0] - x, points[at, 1] - y
            along = dx * nx + dy * ny
            dot = normals[at, 0] * nx + normals[at, 1] * ny
            nearer = (dot < -0.9) & (along * side > 0.5) & (abs(along) < nearest[k])
            nearest[k] = abs(along) if nearer else nearest[k]
            gaps[first + k] = along if nearer else gaps[first + k]
            p = following[at]


@inner_kernel
def count_sides(gaps: FloatArray, reach: float) -> tuple[int, int]:
    """Return how many points have a mate within `reach` on the dark and on the bright side."""
    dark = bright = 0
    for gap in gaps:
        dark += -reach < gap < 0.0
        bright += 0.0 < gap < reach
    return dark, bright


@inner_kernel
def least_long(offsets: IntArray) -> float:
    """Return the number of points from which a contour is a long one."""
    longest = 0
    for c in range(len(offsets) - 1):
        longest = max(longest, offsets[c + 1] - offsets[c])
    return min(LONG, LONG_SHARE * longest)


@inner_kernel
def long_contours(offsets: IntArray, long: IntArray) -> tuple[int, int]:
    """Write which contours are long; return how many they and their points are."""
    least = least_long(offsets)
    count = total = 0
    for c in range(len(offsets) - 1):
        size = offsets[c + 1] - offsets[c]
        long[count] = c
        count += size >= least
        total += size if size >= least else 0
    return count, total


@kernel
def find_mates(
    head: Int32Array,
    following: Int32Array,
    points: FloatArray,
    normals: FloatArray,
    offsets: IntArray,
    reach: float,
    alone: float,
    alone_reach: float,
    share: float,
) -> tuple[FloatArray, bool]:
    """Return for every edge point the signed distance to the nearest opposite edge, else 0.

    The mate lies within `reach` pixels along the gradient (positive: on the bright side, negative:
    on the dark side), its gradient points the other way.

    Also returned is whether more than a `share` of the points on long contours have mates on one
    side. Of most images it is soon certain that they have not, and of most contours
    that they have no width of their own (`own_width`, by `alone` and `alone_reach`): the rest of
    these is not looked at. So the first points of all contours come before the next ones.
    """
    steps = int(reach)
    gaps = np.zeros(len(points))
    spots = np.empty((2 * steps, BLOCK), np.int32)
    found = np.empty((2, 2 * steps * BLOCK + 1), np.int32)
    rows = np.empty((5, BLOCK))
    done = offsets[:-1].copy()
    long = np.empty(len(offsets), np.int64)
    waiting, rest = long_contours(offsets, long)
    wanted = share * rest
    drawn = rest > wanted
    dark = bright = 0
    while drawn and waiting > 0:
        kept = 0
        for c in long[:waiting]:
            first, last = done[c], min(done[c] + BLOCK, offsets[c + 1])
            write_gaps(
                head, following, points, normals, reach, first, last, spots, found, rows, gaps
            )
            done[c] = last
            more = count_sides(gaps[first:last], math.inf)
            dark, bright, rest = dark + more[0], bright + more[1], rest - (last - first)
            drawn = max(dark, bright) + rest > wanted
            if not drawn:
                break
            long[kept] = c
            kept += last < offsets[c + 1]
        waiting = kept
    for c in range(len(done)):
        end = offsets[c + 1]
        wanted = alone * (end - offsets[c] + DOUBTED)
        dark, bright = count_sides(gaps[offsets[c] : done[c]], alone_reach)
        while done[c] < end and (drawn or max(dark, bright) + end - done[c] > wanted):
            first, last = done[c], min(done[c] + BLOCK, end)
            write_gaps(
                head, following, points, normals, reach, first, last, spots, found, rows, gaps
            )
            done[c] = last
            more = count_sides(gaps[first:last], alone_reach)
            dark, bright = dark + more[0], bright + more[1]
    return gaps, drawn


@kernel
def gaps_of_long(gaps: FloatArray, offsets: IntArray) -> FloatArray:
    """Return the gaps of the points of all long contours."""
    least = least_long(offsets)
    kept = np.empty(len(gaps))
    size = 0
    for c in range(len(offsets) - 1):
        own = gaps[offsets[c] : offsets[c + 1]]
        if len(own) >= least:
            kept[size : size + len(own)] = own
            size += len(own)
    return kept[:size]


@inner_kernel
def count_alike(gaps: FloatArray, width: float) -> int:
    """Count the mates that lie about as far as a line of the given signed width is wide."""
    count = 0
    for gap in gaps:
        count += gap != 0.0 and abs(gap - width) < ALIKE
    return count


@kernel
def own_width(gaps: FloatArray, share: float, reach: float) -> float:
    """Return the signed width of the line that a contour is an edge of by its own mates, else 0.

    More than `share` of its points have a mate on one side within `reach`, at one distance.
    """
    least = share * (len(gaps) + DOUBTED)
    if len(gaps) <= least:
        return 0.0
    dark, bright = count_sides(gaps, reach)
    if max(dark, bright) <= least:
        return 0.0
    side = -1.0 if dark > bright else 1.0
    width = np.median(gaps[(side * gaps > 0.0) & (side * gaps < reach)])
    return width if count_alike(gaps, width) > least else 0.0


@kernel
def stroke_widths(
    gaps: FloatArray, offsets: IntArray, share: float, reach: float, common: float
) -> tuple[FloatArray, int]:
    """Return for every point the signed width of the line that its contour is an edge of, else 0.

    And how many points are on lines.

    Each contour is judged by its own mates within `reach` (`own_width`). In an image of lines,
    most of them `common` wide (0: no such image), a contour follows the others unless it is long
    enough to tell that it is none: crossings hide mates.
    """
    widths = np.zeros(len(gaps))
    count = 0
    for c in range(len(offsets) - 1):
        own = gaps[offsets[c] : offsets[c + 1]]
        follows = common != 0.0 and count_alike(own, common) + FOLLOWED > FOLLOWING * len(own)
        width = common if follows else own_width(own, share, reach)
        if width != 0.0:
            widths[offsets[c] : offsets[c + 1]] = width
            count += len(own)
    return widths, count
