"""Kernels of the `refined` scheme: rough outlines, which are ellipses but for a few per cent.

They look at every few points of long contours only: what deviates by pixels needs no more.
"""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc._kernels_refined_arcs import describe_arcs
from geoprim_core.ecc._kernels_refined_few import sees
from geoprim_core.ecc._kernels_refined_fit import (
    add_shifted,
    fit_moments,
    offset_at,
    offset_of,
)
from geoprim_core.ecc._kernels_refined_refit import refit
from geoprim_core.ecc._kernels_refined_split import split_contours

STRIDE = 3  # every such point of a contour is looked at
TOLERANCE = 2.0  # pixels, of the polygon that finds turns and inflexions of rough contours
MAX_TURN = math.radians(60.0)  # sharpest turn inside a part
LEAST_HEIGHT = 0.03  # of a part over its chord, in its length: others are straight
ALONG = math.cos(math.radians(30.0))  # between gradient and normal
LEAST_SHARE = 0.16  # of an outline that one part or two make up
SLACK = (2.0, 0.06)  # pixels, and share of the length of two parts, of their search regions
OWN_REACH, OWN_NEAR = 0.06, 0.7  # axes from two parts to their ellipse; share within
LEAST_AXIS = 30.0  # pixels: in a smaller one deviations are those of any edge
LEAST_RATIO = 0.5  # of the axes: thinner are leaves, eyes and the like
MOST_TRIES = 64  # ellipses that are grown
ROUNDS = 4  # of growing; the reach falls from twice its value
LEAST_GROWN = np.array([0.3, 0.4, 0.5, 0.5])  # supported share of the outline after each
LEAST_COVERED = 0.6  # share of the outline and of its turn
BELONGS = 0.7  # share of a part that makes it one of an ellipse
SAME = 0.95  # overlap of one ellipse found twice
BINS = 48  # of the turn

# Rows of a sample: position and inner normal.
X, Y, INWARD_X, INWARD_Y = range(4)
# Rows of what is known of a supporting sample: distance, normal in the frame of the axes.
AWAY, NORMAL_U, NORMAL_V = range(3)
# Figures of a rough ellipse: covered share of the turn and of the outline, scatter in semi-minor
# axes, widest gap in turns, points of its parts that lie elsewhere per supporting one, polarity.
TURN, LENGTH, SCATTER, WIDEST, ELSEWHERE, POLARITY, FIGURES = range(7)


@kernel
def long_runs(
    offsets: IntArray, closed: BoolArray, claimed: BoolArray, least: int
) -> tuple[IntArray, BoolArray]:
    """Return first point and end (R, 2) of what nothing claims of contours, and what are rings."""
    count = 0
    total = offsets[-1]
    runs = np.empty((total // max(1, least) + 1, 2), np.int64)
    rings = np.zeros(len(runs), np.bool_)
    for c in range(len(offsets) - 1):
        low, high = offsets[c], offsets[c + 1]
        if high - low < least:
            continue
        start = low
        for k in range(low, high + 1):
            if k == high or claimed[k]:
                if k - start >= least:
                    runs[count, 0], runs[count, 1] = start, k
                    rings[count] = closed[c] and k - start == high - low
                    count += 1
                start = k + 1
    return runs[:count].copy(), rings[:count].copy()


@kernel
def sample_runs(runs: IntArray) -> tuple[IntArray, IntArray]:
    """Return every third point of each run, the first such that the ends are as far, offsets."""
    offsets = np.zeros(len(runs) + 1, np.int64)
    for r in range(len(runs)):
        offsets[r + 1] = offsets[r] + (runs[r, 1] - runs[r, 0] + STRIDE - 1) // STRIDE
    taken = np.empty(offsets[-1], np.int64)
    for r in range(len(runs)):
        first = runs[r, 0] + (runs[r, 1] - runs[r, 0] - 1) % STRIDE // 2
        for k in range(offsets[r + 1] - offsets[r]):
            taken[offsets[r] + k] = first + STRIDE * k
    return taken, offsets


@kernel
def bent_parts(table: FloatArray, most: int) -> IntArray:
    """Return the parts that are not straight, the `most` longest, longest first."""
    bent = np.flatnonzero(table[:, 17] > LEAST_HEIGHT * STRIDE * table[:, 18])
    return bent[np.argsort(-table[bent, 18], kind="mergesort")][:most]


@kernel
def gather_parts(
    points: FloatArray, normals: FloatArray, order: IntArray, ends: IntArray, table: FloatArray,
    kept: IntArray,
) -> tuple[FloatArray, IntArray]:  # fmt: skip
    """Return the samples (4, S) of parts with the normals turned inwards, and offsets."""
    starts = np.zeros(len(kept) + 1, np.int64)
    for k in range(len(kept)):
        starts[k + 1] = starts[k] + ends[kept[k] + 1] - ends[kept[k]]
    samples = np.empty((4, starts[-1]))
    for k in range(len(kept)):
        inward = table[kept[k], 16]
        for m in range(starts[k + 1] - starts[k]):
            p, at = order[ends[kept[k]] + m], starts[k] + m
            samples[X, at], samples[Y, at] = points[p, 0], points[p, 1]
            samples[INWARD_X, at] = inward * normals[p, 0]
            samples[INWARD_Y, at] = inward * normals[p, 1]
    return samples, starts


@inner_kernel
def fit_parts(
    table: FloatArray, moments: FloatArray, i: int, j: int, work: FloatArray, ellipse: FloatArray
) -> bool:
    """Fit an ellipse to one part (i = j) or two of one polarity; False if they make up none."""
    length = STRIDE * table[i, 18]
    if j != i:
        length += STRIDE * table[j, 18]
        slack = SLACK[0] + SLACK[1] * length / STRIDE
        dx, dy = table[i, 0] - table[j, 0], table[i, 1] - table[j, 1]
        near = length / (math.pi * LEAST_SHARE)
        if table[i, 16] != table[j, 16] or dx * dx + dy * dy > near * near:
            return False
        if not (sees(table[i], table[j], slack) and sees(table[j], table[i], slack)):
            return False
    scale = 1.0 / max(table[i, 19], table[j, 19])
    work[:] = 0.0
    add_shifted(work, moments[i], 0.0, 0.0, scale)
    if j != i:
        dx, dy = table[j, 0] - table[i, 0], table[j, 1] - table[i, 1]
        add_shifted(work, moments[j], dx, dy, scale)
    if not fit_moments(work, table[i, 0], table[i, 1], scale, ellipse):
        return False
    return bool(length >= LEAST_SHARE * math.pi * (ellipse[2] + ellipse[3]))


@inner_kernel
def is_fair(ellipse: FloatArray, longest: float) -> bool:
    """Tell whether an ellipse is neither too large, too small nor too thin for a rough one."""
    return bool(
        ellipse[2] <= longest
        and ellipse[3] >= LEAST_AXIS
        and ellipse[3] >= LEAST_RATIO * ellipse[2]
    )


@inner_kernel
def near_share(samples: FloatArray, low: int, high: int, ellipse: FloatArray) -> float:
    """Return the share of the samples low .. high - 1 that lie near an ellipse and along it."""
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    near = 0
    for k in range(low, high):
        d, nx, ny = offset_of(ellipse, cos, sin, samples[X, k], samples[Y, k])
        along = -(nx * samples[INWARD_X, k] + ny * samples[INWARD_Y, k]) >= ALONG
        near += along & (abs(d) <= OWN_REACH * ellipse[3])
    return near / (high - low)


@inner_kernel
def collect_rough(
    samples: FloatArray, starts: IntArray, table: FloatArray, polarity: float, ellipse: FloatArray,
    reach: float, near: FloatArray, about: FloatArray, tally: IntArray,
) -> int:  # fmt: skip
    """Gather the samples of one polarity within `reach` of an ellipse and along its normals.

    Writes their positions to `near`, what is known of them to `about`, and how many each part
    gives to `tally`; returns their number.
    """
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    flat, steep = 1.0 / (ellipse[2] * ellipse[2]), 1.0 / (ellipse[3] * ellipse[3])
    beyond = 2.0 * reach / ellipse[3] * (1.0 + 2.0 * reach / ellipse[3])  # of what follows
    count = 0
    for part in range(len(starts) - 1):
        before = count
        far = math.hypot(table[part, 0] - ellipse[0], table[part, 1] - ellipse[1])
        inside = far + table[part, 19] < ellipse[3] - reach
        if (
            table[part, 16] == polarity
            and far - table[part, 19] < ellipse[2] + reach
            and not inside
        ):
            for k in range(starts[part], starts[part + 1]):
                dx, dy = samples[X, k] - ellipse[0], samples[Y, k] - ellipse[1]
                u, v = dx * cos + dy * sin, dy * cos - dx * sin
                if abs(u * u * flat + v * v * steep - 1.0) > beyond:
                    continue
                d, nx, ny = offset_at(dx, dy, cos, sin, flat, steep)
                cosine = -(nx * samples[INWARD_X, k] + ny * samples[INWARD_Y, k])
                if abs(d) > reach or cosine < ALONG:
                    continue
                near[0, count], near[1, count] = samples[X, k], samples[Y, k]
                about[AWAY, count] = d
                about[NORMAL_U, count] = nx * cos + ny * sin
                about[NORMAL_V, count] = ny * cos - nx * sin
                count += 1
        tally[part] = count - before
    return count


@inner_kernel
def grow(
    samples: FloatArray, starts: IntArray, table: FloatArray, polarity: float, longest: float,
    reach: float, ellipse: FloatArray, near: FloatArray, about: FloatArray, tally: IntArray,
) -> int:  # fmt: skip
    """Refit an ellipse in place to what lies ever nearer to it; return how many do, 0 for none."""
    for step in range(ROUNDS):
        if not is_fair(ellipse, longest):
            return 0
        within = reach * ellipse[3] * (2.0 - step / (ROUNDS - 1.0))
        count = collect_rough(
            samples, starts, table, polarity, ellipse, within, near, about, tally
        )  # fmt: skip
        if STRIDE * count < LEAST_GROWN[step] * math.pi * (ellipse[2] + ellipse[3]):
            return 0
        if step == ROUNDS - 1:
            return count
        if not refit(near, count, ellipse, 2, 1.5 * within):
            return 0
    return 0


@inner_kernel
def measure_rough(
    starts: IntArray, ellipse: FloatArray, about: FloatArray, count: int, tally: IntArray,
    bins: IntArray, row: FloatArray,
) -> None:  # fmt: skip
    """Write the figures of an ellipse by the samples that support it."""
    bins[:] = 0
    squares = 0.0
    for k in range(count):
        nu, nv = about[NORMAL_U, k], about[NORMAL_V, k]
        turn = math.atan2(nv, nu) / (2.0 * math.pi) + 0.5
        along = math.atan2(ellipse[3] * nv, ellipse[2] * nu) / (2.0 * math.pi) + 0.5
        bins[0, int(turn * BINS) % BINS] += 1
        bins[1, int(along * BINS) % BINS] += 1
        squares += about[AWAY, k] * about[AWAY, k]
    gap = widest = turned = covered = 0
    for k in range(2 * BINS):
        gap = 0 if bins[0, k % BINS] > 0 else gap + 1
        widest = max(widest, min(gap, BINS))
        turned += (k < BINS) & (bins[0, k % BINS] > 0)
        covered += (k < BINS) & (bins[1, k % BINS] > 0)
    elsewhere = 0
    for part in range(len(tally)):
        if tally[part] > 0:
            elsewhere += starts[part + 1] - starts[part] - tally[part]
    row[TURN], row[LENGTH], row[WIDEST] = turned / BINS, covered / BINS, widest / BINS
    row[SCATTER] = math.sqrt(squares / count) / ellipse[3]
    row[ELSEWHERE] = elsewhere / count


@inner_kernel
def note_parts(starts: IntArray, tally: IntArray, known: BoolArray) -> None:
    """Note that the parts of an ellipse belong together: no two of them make another."""
    for i in range(len(tally)):
        if tally[i] > BELONGS * (starts[i + 1] - starts[i]):
            for j in range(i, len(tally)):
                known[i, j] |= tally[j] > BELONGS * (starts[j + 1] - starts[j])


@kernel
def grow_pairs(
    samples: FloatArray, starts: IntArray, table: FloatArray, moments: FloatArray, reach: float,
    longest: float,
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Return ellipses (n, 5) grown from parts and pairs of them, and their figures."""
    size, count = samples.shape[1], len(table)
    ellipses, figures = np.empty((MOST_TRIES, 5)), np.zeros((MOST_TRIES, FIGURES))
    near, about = np.empty((3, size)), np.empty((3, size))
    tally, bins = np.zeros(count, np.int64), np.zeros((2, BINS), np.int64)
    known = np.zeros((count, count), np.bool_)
    work, ellipse = np.empty(25), np.empty(5)
    found = tried = 0
    for i in range(count):
        for j in range(i, count):
            if known[i, j] or tried == MOST_TRIES:
                continue
            if not (fit_parts(table, moments, i, j, work, ellipse) and is_fair(ellipse, longest)):
                continue
            own = min(
                near_share(samples, starts[i], starts[i + 1], ellipse),
                near_share(samples, starts[j], starts[j + 1], ellipse),
            )
            if own < OWN_NEAR:
                continue
            tried += 1
            used = grow(
                samples, starts, table, table[i, 16], longest, reach, ellipse, near, about, tally
            )
            if used == 0:
                continue
            note_parts(starts, tally, known)
            measure_rough(starts, ellipse, about, used, tally, bins, figures[found])
            figures[found, POLARITY] = table[i, 16]
            if min(figures[found, TURN], figures[found, LENGTH]) < LEAST_COVERED:
                continue
            ellipses[found] = ellipse
            found += 1
    return ellipses[:found], figures[:found]


@kernel
def rough_ellipses(
    points: FloatArray, normals: FloatArray, runs: IntArray, rings: BoolArray, least: int,
    most: int, reach: float, longest: float,
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Return the rough ellipses (n, 5) of runs of points, and their figures."""
    taken, offsets = sample_runs(runs)
    xy, across = np.empty((len(taken), 2)), np.empty((len(taken), 2))
    for k in range(len(taken)):
        xy[k, 0], xy[k, 1] = points[taken[k], 0], points[taken[k], 1]
        across[k, 0], across[k, 1] = normals[taken[k], 0], normals[taken[k], 1]
    order, ends, _ = split_contours(xy, offsets, rings, TOLERANCE, MAX_TURN, least // STRIDE)
    table, moments = describe_arcs(xy, across, order, ends)
    kept = bent_parts(table, most)
    samples, starts = gather_parts(xy, across, order, ends, table, kept)
    return grow_pairs(samples, starts, table[kept], moments[kept], reach, longest)
