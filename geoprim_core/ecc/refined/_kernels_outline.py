"""Kernels of the `refined` scheme: the walk along an outline, and the edge points on it.

The parts of a step are compiled into it: what they take would be passed array by array, each as
seven numbers, which costs as much as a tenth of the step.
"""

from __future__ import annotations

import math
from typing import NamedTuple, cast

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, Int8Array, Int32Array, IntArray
from geoprim_core._jit import inlined_kernel, inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_fit import offset_at
from geoprim_core.ecc.refined._kernels_places import pixels_of, quarter_of
from geoprim_core.ecc.refined._kernels_points import EdgeIndex

ACROSS = 0.82  # cosine of 35 degrees: an edge point turned further crosses the outline
CHUNK = 24  # places of a quarter that are looked at together
WINDOW = 9  # pixels around a place
GAP, COVERED_PLACE, OUTSIDE = range(3)  # what a place is
FIRST = cast(int, np.int64(0))  # typed: numba may compile a kernel anew for a literal number

# Columns of the sums that `add_support` makes.
STEPS, IN_FRAME, COVERED, TURN, TURN_COVERED, SQUARES, TURNED, CROSSING, SUMS = range(9)


class Walk(NamedTuple):
    """What a walk along an outline writes; made once and used for all.

    Attributes
    ----------
    places : (3, n) float64
        Of the first quarter, as `quarter_of` writes them.
    state : (4 n,) int8
        What each place is: `GAP`, `COVERED_PLACE` or `OUTSIDE`; place k of quarter s is at
        4 k + s, mirrored left and right in quarters 1 and 3, up and down in 2 and 3.
    seen : (2, m) int32
        Edge points and the place that each is around.
    spots : (4, c) int32
        Pixels of the places that are looked at together, a row a quarter; 0 outside the image.
    windows : (2, k) int32
        Pixels of places around which there are edge points, and these places.
    near : (H * W,) bool
        Whether one of the nine pixels around a pixel holds an edge point. The outermost pixels
        have no nine pixels and tell nothing.
    about : (4, m) float64
        Of the fresh points: position about the centre and normal. Then: what `weigh` makes of them.
    fresh : (m,) int32
        Those of the points seen that were not seen before on this walk.
    along : (m,) bool
        Which of the fresh points support the ellipse.
    stamp : (N,) int32
        Of every edge point the mark of the walk that has judged it last: negative where it does
        not support the ellipse of that walk.
    chosen : (N + 1,) int64
        The supporting points.
    sums : (SUMS,) float64
        What `add_support` counts.
    gathered : (3, N) float64
        The supporting points as `_kernels_refit` takes them.
    """

    places: FloatArray
    state: Int8Array
    seen: Int32Array
    spots: Int32Array
    windows: Int32Array
    near: BoolArray
    about: FloatArray
    fresh: Int32Array
    along: BoolArray
    stamp: Int32Array
    chosen: IntArray
    sums: FloatArray
    gathered: FloatArray


class Band(NamedTuple):
    """Which edge points support an ellipse on one walk along its outline.

    Attributes
    ----------
    reach : float
        How far they lie at most, in pixels.
    min_cosine : float
        Least cosine of the angle between gradient and normal.
    polarity : int
        1 where the gradient has to point inwards, -1 outwards, 0 where either will do.
    mark : int
        A number that no other walk has, and none that is its negative.
    """

    reach: float
    min_cosine: float
    polarity: int
    mark: int


@kernel
def pixels_near(head: Int32Array) -> BoolArray:
    """Return, for every pixel, whether one of the nine around it holds an edge point."""
    height, width = head.shape
    near = np.zeros((height, width), np.bool_)
    rows = np.zeros((3, width), np.bool_)  # of three pixels side by side, in three rows by turns
    for y in range(height):
        line, row = head[y], rows[y % 3]
        for x in range(1, width - 1):
            row[x] = (line[x - 1] & line[x] & line[x + 1]) >= 0  # not all -1
        if y >= 2:
            out = near[y - 1]
            for x in range(1, width - 1):
                out[x] = rows[0, x] | rows[1, x] | rows[2, x]
    return near.ravel()


@kernel
def new_walk(edges: EdgeIndex, longest: float) -> Walk:
    """Return room for walks in steps of a pixel or more; semi-axes are at most `longest`."""
    total = len(edges.points)
    quarter = 2 * int(longest) + 16
    return Walk(
        np.empty((3, quarter)),
        np.empty(4 * quarter, np.int8),
        np.empty((2, 4 * CHUNK * WINDOW + 1), np.int32),
        np.empty((4, CHUNK), np.int32),
        np.empty((2, 4 * CHUNK + 1), np.int32),
        pixels_near(edges.head),
        np.empty((4, 4 * CHUNK * WINDOW + 1)),
        np.empty(4 * CHUNK * WINDOW + 1, np.int32),
        np.empty(4 * CHUNK * WINDOW + 1, np.bool_),
        np.zeros(total, np.int32),
        np.empty(total + 1, np.int64),
        np.empty(SUMS),
        np.empty((3, total + 1)),
    )


@inner_kernel
def look(flat: Int32Array, corner: int, width: int, place: int, seen: Int32Array, size: int) -> int:
    """Note the first edge point of each of nine pixels, and the place that they are around.

    `corner` is the flat index of the upper left one. `seen` gets the points and places from `size`
    on, which is returned, grown. Every pixel is written and kept or not: whether it holds an edge
    is a coin toss, which a branch loses.
    """
    for row in range(3):
        at = np.uint64(corner + row * width)
        for column in range(3):
            p = flat[at + np.uint64(column)]
            seen[0, np.uint64(size)] = p
            seen[1, np.uint64(size)] = place
            size += p >= 0
    return size


@inlined_kernel
def find_windows(
    head: Int32Array,
    ellipse: FloatArray,
    cos: float,
    sin: float,
    walk: Walk,
    first: int,
    last: int,
) -> int:
    """Note which of the places first .. last - 1 of all quarters have edge points around them.

    Sets the state of the places, and counts them and those inside the image. Returns how many
    were noted. There are no branches, for the reason that `look` gives.
    """
    height, width = head.shape
    pixels_of(walk.places, first, last, ellipse, cos, sin, width, height, walk.spots)
    noted = inside = 0
    turn = 0.0
    for k in range(first, last):
        sides = 0
        for side in range(4):
            at = walk.spots[side, k - first]
            walk.state[4 * k + side] = GAP if at > 0 else OUTSIDE
            sides += at > 0
            walk.windows[0, np.uint64(noted)] = at
            walk.windows[1, np.uint64(noted)] = 4 * k + side
            noted += walk.near[np.uint64(at)]
        inside += sides
        turn += sides * walk.places[2, k]
    walk.sums[STEPS] += 4.0 * (last - first)
    walk.sums[IN_FRAME] += inside
    walk.sums[TURN] += turn
    return noted


@inlined_kernel
def pick_new(walk: Walk, mark: int, size: int) -> int:
    """Write to `walk.fresh` those of the points noted that no place before had; return how many.

    A point is around several places, and judged once.
    """
    fresh = 0
    for k in range(size):
        p = walk.seen[0, k]
        at = np.uint64(p)
        known = walk.stamp[at]
        walk.fresh[np.uint64(fresh)] = p
        fresh += (known != mark) & (known != -mark)
        walk.stamp[at] = known if known == -mark else mark
    return fresh


@inlined_kernel
def weigh(
    edges: EdgeIndex, walk: Walk, size: int, ellipse: FloatArray, cos: float, sin: float, band: Band
) -> int:
    """Tell of the fresh points which support an ellipse; return how many cross its outline.

    Writes for those that support it the square of the distance over the position, and that of the
    sine of the angle between gradient and normal, for others zeros. The body of the second loop
    has no branches, so that it compiles to vector instructions.
    """
    dx, dy, across_x, across_y = walk.about[0], walk.about[1], walk.about[2], walk.about[3]
    along = walk.along
    x0, y0 = ellipse[0], ellipse[1]
    for k in range(size):
        at = np.uint64(walk.fresh[k])
        dx[k], dy[k] = edges.points[at, 0] - x0, edges.points[at, 1] - y0
        across_x[k], across_y[k] = edges.normals[at, 0], edges.normals[at, 1]
    flat, steep = 1.0 / (ellipse[2] * ellipse[2]), 1.0 / (ellipse[3] * ellipse[3])
    crossing = 0
    for k in range(size):
        d, nx, ny = offset_at(dx[k], dy[k], cos, sin, flat, steep)
        dot = -(nx * across_x[k] + ny * across_y[k])
        right = (band.polarity == 0) | (dot * band.polarity > 0.0)
        across = abs(dot) < ACROSS
        good = (abs(dot) >= band.min_cosine) & right & (abs(d) <= band.reach) & (not across)
        dx[k] = d * d if good else 0.0
        # Rounding can make an exact normal longer than one: no root of that below.
        dy[k] = max(0.0, 1.0 - dot * dot) if good else 0.0
        along[k] = good
        crossing += across
    return crossing


@inlined_kernel
def judge_points(
    edges: EdgeIndex, walk: Walk, size: int, ellipse: FloatArray, cos: float, sin: float,
    band: Band, count: int,
) -> int:  # fmt: skip
    """Put those of the points noted that support the ellipse to `walk.chosen`; return their number.

    Marks the places that they are around as covered. The points of a pixel are judged one after
    the other: those that come first of all pixels, then those that follow them.
    """
    mark = band.mark
    squares = turned_sum = 0.0
    crossing = 0
    while size > 0:
        fresh = pick_new(walk, mark, size)
        crossing += weigh(edges, walk, fresh, ellipse, cos, sin, band)
        for k in range(fresh):
            p, good = walk.fresh[k], walk.along[k]
            walk.stamp[np.uint64(p)] = mark if good else -mark
            walk.chosen[np.uint64(count)] = p
            count += good
            squares += walk.about[0, k]
            turned_sum += walk.about[1, k]
        left = 0
        for k in range(size):
            at, place = np.uint64(walk.seen[0, k]), walk.seen[1, k]
            walk.state[np.uint64(place)] |= walk.stamp[at] == mark
            walk.seen[0, np.uint64(left)] = edges.following[at]
            walk.seen[1, np.uint64(left)] = place
            left += edges.following[at] >= 0
        size = left
    walk.sums[SQUARES] += squares
    walk.sums[TURNED] += turned_sum
    walk.sums[CROSSING] += crossing
    return count


@inner_kernel
def add_support(
    edges: EdgeIndex,
    ellipse: FloatArray,
    walk: Walk,
    start: int,
    end: int,
    band: Band,
    count: int,
) -> int:
    """Collect the edge points that support an ellipse: near its outline and along its normal.

    They are looked for in the nine pixels around each of the places start .. end - 1 of all
    quarters; a place is covered when there is one. Returns the number of points in `walk.chosen`,
    of which `count` are there already. The sums of the walk grow by places, those in the frame and
    the covered ones, the turn of the normal over the latter two, squared distances, squared sines
    of the angles between gradient and normal, and points with the gradient across the outline.
    """
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    flat, width = edges.head.reshape(edges.head.size), edges.head.shape[1]
    for first in range(start, end, CHUNK):
        last = min(first + CHUNK, end)
        noted = find_windows(edges.head, ellipse, cos, sin, walk, first, last)
        size = FIRST
        for k in range(noted):
            corner = np.int64(walk.windows[0, k]) - width - 1
            size = look(flat, corner, width, walk.windows[1, k], walk.seen, size)
        count = judge_points(edges, walk, size, ellipse, cos, sin, band, count)
        covered = 0
        turn = 0.0
        for k in range(first, last):
            sides = 0
            for side in range(4):
                sides += walk.state[4 * k + side] == COVERED_PLACE
            covered += sides
            turn += sides * walk.places[2, k]
        walk.sums[COVERED] += covered
        walk.sums[TURN_COVERED] += turn
    return count


@inner_kernel
def collect(edges: EdgeIndex, ellipse: FloatArray, walk: Walk, stride: float, band: Band) -> int:
    """Collect the support along a whole outline, at places about `stride` pixels apart."""
    walk.sums[:] = 0.0
    end = quarter_of(ellipse[2], ellipse[3], stride, walk.places)
    return add_support(edges, ellipse, walk, FIRST, end, band, FIRST)
