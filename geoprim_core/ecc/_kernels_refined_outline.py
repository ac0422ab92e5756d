"""Kernels of the `refined` scheme: the walk along an outline, and the edge points on it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.ecc._kernels_refined_fit import offset_at

Int8Array = npt.NDArray[np.int8]
Int32Array = npt.NDArray[np.int32]

ACROSS = 0.82  # cosine of 35 degrees: an edge point turned further crosses the outline
CHUNK = 24  # places of a quarter that are looked at together
WINDOW = 9  # pixels around a place
GAP, COVERED_PLACE, OUTSIDE = range(3)  # what a place is

# Columns of the sums that `add_support` makes.
STEPS, IN_FRAME, COVERED, TURN, TURN_COVERED, SQUARES, TURNED, CROSSING, SUMS = range(9)

SKETCH = 18  # places of a quarter that serve a first look
SKETCHES = 64  # as many ratios of the semi-axes
GLANCES = (5, 9, SKETCH)  # as many of them make a first glance, half a look, a look


def _sketches() -> FloatArray:
    """Return equally spaced places of a quarter (SKETCHES, SKETCH, 3), every fourth one first.

    The columns are those of `quarter_of`. A part of them from the first on is spread over the
    whole quarter: with mirror images, over the outline.
    """
    t = np.linspace(0.0, 0.5 * np.pi, 1025)
    table = np.empty((SKETCHES, SKETCH, 3))
    order = np.concatenate([np.arange(first, SKETCH, 4) for first in (1, 3, 0, 2)])
    for k in range(SKETCHES):
        ratio = (k + 0.5) / SKETCHES
        pace = np.hypot(np.sin(t), ratio * np.cos(t))
        path = np.concatenate(([0.0], np.cumsum(0.5 * (pace[1:] + pace[:-1]))))
        at = np.interp(np.arange(2 * SKETCH + 1) * path[-1] / (2 * SKETCH), path, t)
        c, s, dt = np.cos(at[1::2]), np.sin(at[1::2]), np.diff(at[::2])
        places = np.stack((c, s, ratio * dt / (s * s + ratio * ratio * c * c)), axis=1)
        table[k] = places[order]
    return table


_SKETCHES = _sketches()


class Walk(NamedTuple):
    """What a walk along an outline writes; made once and used for all.

    Attributes
    ----------
    places : (n, 3) float64
        Of the first quarter, as `quarter_of` writes them.
    state : (4 n,) int8
        What each place is: `GAP`, `COVERED_PLACE` or `OUTSIDE`; place k of quarter s is at
        4 k + s, mirrored left and right in quarters 1 and 3, up and down in 2 and 3.
    seen : (2, m) int32
        Edge points and the place that each is around.
    """

    places: FloatArray
    state: Int8Array
    seen: Int32Array


@kernel
def new_walk(longest: float) -> Walk:
    """Return room for walks in steps of a pixel or more; semi-axes are at most `longest`."""
    quarter = 2 * int(longest) + 16
    return Walk(
        np.empty((quarter, 3)),
        np.empty(4 * quarter, np.int8),
        np.empty((2, 4 * CHUNK * WINDOW + 1), np.int32),
    )


@kernel
def turned(cos: float, sin: float, angle: float) -> tuple[float, float]:
    """Return the cosine and sine of an angle turned on by a small one."""
    half = 0.5 * angle
    grow = 1.0 / (1.0 + half * half)
    cd, sd = (1.0 - half * half) * grow, 2.0 * half * grow
    return cos * cd - sin * sd, sin * cd + cos * sd


@kernel
def middle_of_step(
    ct: float, st: float, a: float, b: float, stride: float
) -> tuple[float, float, float]:
    """Return cosine and sine of the parameter amidst the step from a place, and its length."""
    dt = min(0.5, stride / math.sqrt(a * a * st * st + b * b * ct * ct))
    mid_ct, mid_st = turned(ct, st, 0.5 * dt)
    dt = min(0.5, stride / math.sqrt(a * a * mid_st * mid_st + b * b * mid_ct * mid_ct))
    mid_ct, mid_st = turned(ct, st, 0.5 * dt)
    return mid_ct, mid_st, dt


@kernel
def quarter_of(a: float, b: float, stride: float, places: FloatArray) -> int:
    """Write places about `stride` pixels apart on the first quarter of an outline, in order.

    Of each: cosine and sine of the parameter, and the turn of the normal over the step. Returns
    how many they are.
    """
    count = 0
    ct, st = 1.0, 0.0
    while ct > 0.0 and count < len(places):
        c, s, dt = middle_of_step(ct, st, a, b, stride)
        ct, st = turned(ct, st, dt)
        places[count, 0], places[count, 1] = c, s
        places[count, 2] = a * b * dt / (a * a * s * s + b * b * c * c)
        count += 1
    return count


@kernel
def sketch_of(a: float, b: float, places: FloatArray) -> int:
    """Write `SKETCH` places as `quarter_of` does, in the order of `GLANCES`; return their number.

    They come from a table of ratios: where exactly on the outline the places lie does not matter.
    """
    row = min(SKETCHES - 1, int(SKETCHES * b / a))
    for k in range(SKETCH):
        for column in range(3):
            places[k, column] = _SKETCHES[row, k, column]
    return SKETCH


@kernel
def outline_of(a: float, b: float, stride: float) -> FloatArray:
    """Return cosine and sine of the parameters of places about `stride` pixels apart, in order.

    The four quarters mirror each other, so that no direction of the walk is preferred.
    """
    quarter = np.empty((int((a + b) / stride) + 8, 3))
    count = quarter_of(a, b, stride, quarter)
    places = np.empty((4 * count, 2))
    for k in range(count):
        c, s = quarter[k, 0], quarter[k, 1]
        places[k, 0], places[k, 1] = c, s
        places[2 * count - 1 - k, 0], places[2 * count - 1 - k, 1] = -c, s
        places[2 * count + k, 0], places[2 * count + k, 1] = -c, -s
        places[4 * count - 1 - k, 0], places[4 * count - 1 - k, 1] = c, -s
    return places


@kernel
def look(flat: Int32Array, corner: int, width: int, place: int, seen: Int32Array, size: int) -> int:
    """Note the first edge point of each of nine pixels, and the place that they are around.

    `corner` is the flat index of the upper left one. `seen` gets the points and places from `size`
    on, which is returned, grown. Every pixel is written and kept or not: whether it holds an edge
    is a coin toss, which a branch loses.
    """
    kept = np.uint64(size)
    for row in range(3):
        at = np.uint64(corner + row * width)
        for column in range(3):
            p = flat[at + np.uint64(column)]
            seen[0, kept] = p
            seen[1, kept] = place
            kept += np.uint64(p >= 0)
    return int(kept)


@kernel
def find_points(
    head: Int32Array,
    ellipse: FloatArray,
    cos: float,
    sin: float,
    walk: Walk,
    first: int,
    last: int,
    sums: FloatArray,
) -> int:
    """Note the edge points around the places first .. last - 1 of all quarters; return how many.

    Sets the state of the places, and counts them and those inside the image.
    """
    height, width = head.shape
    x0, y0, a, b = ellipse[0], ellipse[1], ellipse[2], ellipse[3]
    flat = head.ravel()
    size = inside = 0
    turn = 0.0
    places = walk.places
    for k in range(first, last):
        for side in range(4):
            u = a * places[k, 0] if side % 2 == 0 else -a * places[k, 0]
            v = b * places[k, 1] if side < 2 else -b * places[k, 1]
            px = int(math.floor(x0 + u * cos - v * sin + 0.5))
            py = int(math.floor(y0 + u * sin + v * cos + 0.5))
            walk.state[4 * k + side] = OUTSIDE
            if px >= 1 and py >= 1 and px <= width - 2 and py <= height - 2:
                inside += 1
                walk.state[4 * k + side] = GAP
                turn += places[k, 2]
                corner = (py - 1) * width + px - 1
                size = look(flat, corner, width, 4 * k + side, walk.seen, size)
    sums[STEPS] += 4.0 * (last - first)
    sums[IN_FRAME] += inside
    sums[TURN] += turn
    return size


@kernel
def judge_points(
    following: Int32Array,
    points: FloatArray,
    normals: FloatArray,
    ellipse: FloatArray,
    cos: float,
    sin: float,
    reach: float,
    min_cos: float,
    polarity: int,
    stamp: IntArray,
    mark: int,
    walk: Walk,
    size: int,
    chosen: IntArray,
    count: int,
    sums: FloatArray,
) -> int:
    """Put those of the points noted that support the ellipse to `chosen`; return their number.

    Marks the places that they are around as covered. The loop has no branches on
    what the points are like, for the reason that `look` gives.
    """
    x0, y0 = ellipse[0], ellipse[1]
    flat, steep = 1.0 / (ellipse[2] * ellipse[2]), 1.0 / (ellipse[3] * ellipse[3])
    squares = turned_sum = 0.0
    crossing = 0
    for k in range(size):
        place = walk.seen[1, k]
        p = np.int64(walk.seen[0, k])
        while p >= 0:
            at = np.uint64(p)
            d, nx, ny = offset_at(points[at, 0] - x0, points[at, 1] - y0, cos, sin, flat, steep)
            dot = -(nx * normals[at, 0] + ny * normals[at, 1])
            fresh = (stamp[at] != mark) & (stamp[at] != -mark)
            along = (abs(dot) >= min_cos) & ((polarity == 0) | (dot * polarity > 0.0))
            across = abs(dot) < ACROSS
            good = along & (abs(d) <= reach) & (not across)
            stamp[at] = mark if good else -mark
            walk.state[place] |= good
            crossing += fresh & across
            chosen[count] = p
            count += good & fresh
            squares += d * d if good & fresh else 0.0
            # Rounding can make an exact normal longer than one: no root of that below.
            turned_sum += max(0.0, 1.0 - dot * dot) if good & fresh else 0.0
            p = np.int64(following[at])
    sums[SQUARES] += squares
    sums[TURNED] += turned_sum
    sums[CROSSING] += crossing
    return count


@kernel
def add_support(
    head: Int32Array,
    following: Int32Array,
    points: FloatArray,
    normals: FloatArray,
    ellipse: FloatArray,
    walk: Walk,
    start: int,
    end: int,
    reach: float,
    min_cos: float,
    polarity: int,
    stamp: IntArray,
    mark: int,
    chosen: IntArray,
    count: int,
    sums: FloatArray,
) -> int:
    """Collect the edge points that support an ellipse: near its outline and along its normal.

    They are looked for in the nine pixels around each of the places start .. end - 1 of all
    quarters; a place is covered when there is one. Returns the
    number of points in `chosen`, which has room for one more than there are points; `count` are
    there already. The sums grow by places, those in the frame and the covered ones, the turn of
    the normal over the latter two, squared distances, squared sines of the angles between gradient
    and normal, and points with the gradient across the outline.
    """
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    for first in range(start, end, CHUNK):
        last = min(first + CHUNK, end)
        size = find_points(head, ellipse, cos, sin, walk, first, last, sums)
        count = judge_points(
            following, points, normals, ellipse, cos, sin, reach, min_cos, polarity, stamp, mark,
            walk, size, chosen, count, sums,
        )  # fmt: skip
        for k in range(first, last):
            for side in range(4):
                covered = walk.state[4 * k + side] == COVERED_PLACE
                sums[COVERED] += covered
                sums[TURN_COVERED] += covered * walk.places[k, 2]
    return count


@kernel
def collect(
    head: Int32Array,
    following: Int32Array,
    points: FloatArray,
    normals: FloatArray,
    ellipse: FloatArray,
    stride: float,
    reach: float,
    min_cos: float,
    polarity: int,
    stamp: IntArray,
    mark: int,
    walk: Walk,
    chosen: IntArray,
    sums: FloatArray,
) -> int:
    """Collect the support along a whole outline, at places about `stride` pixels apart."""
    sums[:] = 0.0
    end = quarter_of(ellipse[2], ellipse[3], stride, walk.places)
    return add_support(
        head, following, points, normals, ellipse, walk, 0, end, reach, min_cos, polarity, stamp,
        mark, chosen, 0, sums,
    )  # fmt: skip
