"""Kernels of the `refined` scheme: the support that all edge points give an ellipse."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.ecc._kernels_refined_fit import offset_at
from geoprim_core.fitting._kernels_shape import perimeter_of

Int32Array = npt.NDArray[np.int32]

PROBES = 32
PROBE_COS = np.cos(2.0 * np.pi * (np.arange(PROBES) + 0.5) / PROBES)
PROBE_SIN = np.sin(2.0 * np.pi * (np.arange(PROBES) + 0.5) / PROBES)
CLEAN_RMS = 0.1  # pixels, the scatter of clean edges
CLEAN_ROUND = 0.01  # semi-minor axes, that of small clean ellipses
CLEAN_SLANT = 0.04  # radians, that of their gradients
CLEAN_ENDS = 0.3  # share of ends that nothing explains
NEARLY_WHOLE = (0.7, 0.9)  # shares of the outline from which it counts as whole, a little and fully
ROUND_BY_CHANCE = (3.0, 5.0)  # semi-minor axes in pixels at which any blob is round, and no longer
UNEVEN = 90.0  # evidence lost for a scatter of one semi-minor axis
EVEN = (
    0.03,
    0.015,
)  # scatter in semi-minor axes at which a whole outline counts not yet, and fully
ACROSS = 0.82  # cosine of 35 degrees: an edge point turned further crosses the outline

# Columns of the sums that `collect` makes.
STEPS, IN_FRAME, COVERED, TURN, TURN_COVERED, SQUARES, TURNED, CROSSING, SUMS = range(9)


@kernel
def index_points(points: FloatArray, width: int, height: int) -> tuple[Int32Array, Int32Array]:
    """Return, for every pixel, the first edge point in it (-1: none) and each point's successor."""
    head = np.full((height, width), -1, np.int32)
    following = np.full(len(points), -1, np.int32)
    for k in range(len(points) - 1, -1, -1):
        x = int(math.floor(points[k, 0] + 0.5))
        y = int(math.floor(points[k, 1] + 0.5))
        if 0 <= x < width and 0 <= y < height:
            following[k] = head[y, x]
            head[y, x] = k
    return head, following


@kernel
def arcs_of_points(order: IntArray, ends: IntArray, total: int) -> IntArray:
    """Return for each of `total` points the arc that it is on, -1 for none."""
    arc_of = np.full(total, -1, np.int64)
    for i in range(len(ends) - 1):
        for k in range(ends[i], ends[i + 1]):
            arc_of[order[k]] = i
    return arc_of


@kernel
def has_direction(
    head: Int32Array,
    following: Int32Array,
    normals: FloatArray,
    px: int,
    py: int,
    nx: float,
    ny: float,
    polarity: int,
) -> bool:
    """Tell whether one of the nine pixels around a place has an edge with the normal (nx, ny)."""
    for y in range(py - 1, py + 2):
        for x in range(px - 1, px + 2):
            p = head[y, x]
            while p >= 0:
                dot = -(nx * normals[p, 0] + ny * normals[p, 1])
                if abs(dot) > 0.9 and (polarity == 0 or dot * polarity > 0.0):
                    return True
                p = following[p]
    return False


@kernel
def probe(
    head: Int32Array,
    following: Int32Array,
    normals: FloatArray,
    ellipse: FloatArray,
    polarity: int,
) -> float:
    """Return the share of 32 places on an outline that have an edge of its direction nearby."""
    height, width = head.shape
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    a, b = ellipse[2], ellipse[3]
    hits = 0
    inside = 0
    for k in range(PROBES):
        u, v = a * PROBE_COS[k], b * PROBE_SIN[k]
        px = int(math.floor(ellipse[0] + u * cos - v * sin + 0.5))
        py = int(math.floor(ellipse[1] + u * sin + v * cos + 0.5))
        if px < 1 or py < 1 or px > width - 2 or py > height - 2:
            continue
        inside += 1
        gu, gv = b * PROBE_COS[k], a * PROBE_SIN[k]
        norm = math.sqrt(gu * gu + gv * gv)
        nx, ny = (gu * cos - gv * sin) / norm, (gu * sin + gv * cos) / norm
        if has_direction(head, following, normals, px, py, nx, ny, polarity):
            hits += 1
    return hits / inside if inside > 0 else 0.0


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
def outline_of(a: float, b: float, stride: float) -> FloatArray:
    """Return cosine and sine of the parameters of places about `stride` pixels apart, in order.

    The four quarters mirror each other, so that no direction of the walk is preferred.
    """
    count = 0
    ct, st = 1.0, 0.0
    while ct > 0.0:
        _, _, dt = middle_of_step(ct, st, a, b, stride)
        ct, st = turned(ct, st, dt)
        count += 1
    places = np.empty((4 * count, 2))
    ct, st = 1.0, 0.0
    for k in range(count):
        c, s, dt = middle_of_step(ct, st, a, b, stride)
        ct, st = turned(ct, st, dt)
        places[k, 0], places[k, 1] = c, s
        places[2 * count - 1 - k, 0], places[2 * count - 1 - k, 1] = -c, s
        places[2 * count + k, 0], places[2 * count + k, 1] = -c, -s
        places[4 * count - 1 - k, 0], places[4 * count - 1 - k, 1] = c, -s
    return places


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
    chosen: IntArray,
    sums: FloatArray,
) -> int:
    """Collect the edge points that support an ellipse: near its outline and along its normal.

    The outline is walked in steps of `stride` pixels; a step is covered when one of the nine
    pixels around it holds a supporting point. Returns the number of points put in `chosen`; the
    sums count steps, those in the frame and the covered ones, the turn of the normal over the
    latter two, squared distances, squared sines of the angles between gradient and normal, and
    points with the gradient across the outline.
    """
    height, width = head.shape
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    x0, y0, a, b = ellipse[0], ellipse[1], ellipse[2], ellipse[3]
    flat, steep = 1.0 / (a * a), 1.0 / (b * b)
    count = 0
    sums[:] = 0.0
    ct, st, mid_ct, mid_st, turn = 1.0, 0.0, 1.0, 0.0, 0.0
    side = 3
    while True:
        side = (side + 1) % 4
        if side == 0:  # a step on in the first quarter; the other quarters are its mirror images
            if ct <= 0.0:
                break
            mid_ct, mid_st, dt = middle_of_step(ct, st, a, b, stride)
            ct, st = turned(ct, st, dt)
            turn = a * b * dt / (a * a * mid_st * mid_st + b * b * mid_ct * mid_ct)
        u = a * mid_ct if side % 2 == 0 else -a * mid_ct
        v = b * mid_st if side < 2 else -b * mid_st
        px = int(math.floor(x0 + u * cos - v * sin + 0.5))
        py = int(math.floor(y0 + u * sin + v * cos + 0.5))
        sums[STEPS] += 1.0
        if px < 1 or py < 1 or px > width - 2 or py > height - 2:
            continue
        sums[IN_FRAME] += 1.0
        sums[TURN] += turn
        hit = False
        for y in range(py - 1, py + 2):
            for x in range(px - 1, px + 2):
                p = head[y, x]
                while p >= 0:
                    if stamp[p] != mark and stamp[p] != -mark:
                        dx, dy = points[p, 0] - x0, points[p, 1] - y0
                        d, nx, ny = offset_at(dx, dy, cos, sin, flat, steep)
                        dot = -(nx * normals[p, 0] + ny * normals[p, 1])
                        stamp[p] = -mark
                        if abs(dot) < ACROSS:
                            sums[CROSSING] += 1.0
                        elif (
                            abs(d) <= reach
                            and abs(dot) >= min_cos
                            and (polarity == 0 or dot * polarity > 0.0)
                        ):
                            stamp[p] = mark
                            chosen[count] = p
                            count += 1
                            sums[SQUARES] += d * d
                            sums[TURNED] += 1.0 - dot * dot
                    hit = hit or stamp[p] == mark
                    p = following[p]
        if hit:
            sums[COVERED] += 1.0
            sums[TURN_COVERED] += turn
    return count


@kernel
def rising(value: float, low: float, high: float) -> float:
    """Return 0 up to `low`, 1 from `high`, and on a line in between."""
    return min(1.0, max(0.0, (value - low) / (high - low)))


@kernel
def evidence_of(
    share: float,
    rms: float,
    slant: float,
    length: float,
    semi_minor: float,
    growth: float,
    outside: float,
) -> float:
    """Return the log odds that an ellipse is right, as far as its support tells.

    `share` of the outline is supported over `length` pixels, with a scatter of `rms` pixels, that
    may be `growth` times as long as on a small ellipse, and of `slant` radians; a share `outside`
    lies beyond the image. Close alignment over a length is what chance does not give: an edge
    point at random is as near with a probability in proportion to both scatters, so that their
    logarithms count for each pixel. The rest of the outline is extrapolated: the scatter, and
    what lies beyond the image, count in proportion to it. An outline that is as good as whole
    has more for it than its length: few curves close evenly by chance, but for blobs of some
    pixels.
    The weights, here and below, are those of a logistic regression.
    """
    aligned = math.log(2.0 / (rms + 0.05)) - math.log(slant + 0.03)
    extrapolated = 16.0 * rms / growth + 30.0 * outside
    doubt = (1.0 - share) * extrapolated + UNEVEN * rms / semi_minor
    whole = rising(share, NEARLY_WHOLE[0], NEARLY_WHOLE[1])
    whole *= rising(semi_minor, ROUND_BY_CHANCE[0], ROUND_BY_CHANCE[1])
    whole *= rising(-rms / semi_minor, -EVEN[0], -EVEN[1])
    return 3.7 * math.log(1.0 + length * max(aligned, 0.1)) + 1.3 * whole - doubt - 17.7


@kernel
def doubt_of_ends(share: float, continuing: float, unexplained: float) -> float:
    """Return what the ends of the supported stretches take from the evidence.

    It counts in proportion to the unsupported rest, as in `evidence_of`.
    """
    return (1.0 - share) * (11.5 * continuing + 7.0 * unexplained)


@kernel
def doubt_of_clutter(share: float, across: float) -> float:
    """Return what `across` crossing edge points for each supporting one take from the evidence.

    Mild: it is not known yet which of them belong to other ellipses.
    """
    return 8.0 * (1.0 - share) * across


@kernel
def support_evidence(
    sums: FloatArray, count: int, length: float, ellipse: FloatArray, growth: float
) -> float:
    """Return the evidence of an ellipse from the sums that `collect` made, but for clutter."""
    share = min(sums[COVERED] / sums[IN_FRAME], sums[TURN_COVERED] / sums[TURN])
    rms, slant = math.sqrt(sums[SQUARES] / count), math.sqrt(sums[TURNED] / count)
    outside = 1.0 - sums[IN_FRAME] / sums[STEPS]
    return evidence_of(share, rms, slant, length, ellipse[3], growth, outside)


@kernel
def hopeless(
    sums: FloatArray, count: int, stride: float, ellipse: FloatArray, growth: float, least: float
) -> bool:
    """Tell whether the evidence of a first collection of support is below `least`.

    The scatter counts over the gaps only: a small ellipse is easily some tenths of its size off
    before it is fitted to all of its support.
    """
    share = min(sums[COVERED] / sums[IN_FRAME], sums[TURN_COVERED] / sums[TURN])
    evidence = support_evidence(sums, count, stride * sums[COVERED], ellipse, growth)
    evidence += UNEVEN * math.sqrt(sums[SQUARES] / count) / ellipse[3]
    return bool(evidence - doubt_of_clutter(share, sums[CROSSING] / count) < least)


@kernel
def unpromising(share: float, ellipse: FloatArray, growth: float, least: float) -> bool:
    """Tell whether the evidence of an ellipse can hardly reach `least` after a probe's share.

    The refits may find half as much again, and a little more, with a scatter as of clean edges.
    """
    best = min(1.0, 1.5 * share + 0.1)
    length = best * perimeter_of(ellipse[2], ellipse[3])
    rms = min(CLEAN_RMS, CLEAN_ROUND * ellipse[3])
    support = evidence_of(best, rms, CLEAN_SLANT, length, ellipse[3], growth, 0.0)
    return support - doubt_of_ends(best, CLEAN_ENDS, CLEAN_ENDS) < least
