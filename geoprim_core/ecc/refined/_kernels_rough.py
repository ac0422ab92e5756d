"""Kernels of the `refined` scheme: rough outlines, which are ellipses but for a few per cent."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, Int8Array, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_arcs import MIDDLE, POLARITY, SIZE
from geoprim_core.ecc.refined._kernels_few import sees
from geoprim_core.ecc.refined._kernels_fit import (
    add_shifted,
    fit_moments,
    offset_at,
    offset_of,
)
from geoprim_core.ecc.refined._kernels_refit import refit
from geoprim_core.ecc.refined._kernels_rough_parts import (
    INWARD_X,
    INWARD_Y,
    RADIUS,
    STRIDE,
    X,
    Y,
    parts_of_runs,
)
from geoprim_core.fitting._kernels_overlap import overlap_bound, overlap_of

ALONG = math.cos(math.radians(30.0))  # between gradient and normal
LEAST_SHARE = 0.16  # of an outline that one part or two make up
SLACK = (2.0, 0.06)  # pixels, and share of the length of two parts, of their search regions
OWN_REACH, OWN_NEAR = 0.06, 0.7  # axes from two parts to their ellipse; share within
LEAST_AXIS = 40.0  # pixels: in a smaller one the usual reach is as wide
LEAST_RATIO = 0.5  # of the axes: thinner are leaves, eyes and the like
MOST_TRIES = 48  # ellipses that are grown, those of the longest parts first
ROUNDS = 4  # of growing; the reach falls from twice its value
COARSE = 4  # every such sample tells enough at first
LEAST_GROWN = np.array([0.3, 0.4, 0.5, 0.5])  # supported share of the outline after each
MOST_ELSEWHERE = 0.5  # samples of its parts that are no support, per supporting one
LEAST_COVERED = 0.6  # share of the outline and of its turn
WELL_COVERED = 0.7  # that share, from which other ellipses of the same parts are not better
BELONGS = 0.7  # share of a part that makes it one of an ellipse
COPY = 0.85  # overlap from which an ellipse will end as a copy of a reported one
BINS = 48  # of the turn

# Rows of what is known of a supporting sample: distance, normal in the frame of the axes.
AWAY, NORMAL_U, NORMAL_V = range(3)
# Figures of a rough ellipse: covered share of the turn and of the outline, scatter in semi-minor
# axes, widest gap in turns, points of its parts that lie elsewhere per supporting one, polarity.
TURN, LENGTH, SCATTER, WIDEST, ELSEWHERE, SIGN, FIGURES = range(7)


@inner_kernel
def parts_near(columns: FloatArray, i: int, marks: Int8Array) -> None:
    """Mark the parts from part i on that are of its polarity and near enough for their lengths.

    `columns` holds the table of parts, a row a figure. No branches: vector instructions.
    """
    x, y, size, polarity = (
        columns[MIDDLE, i],
        columns[MIDDLE + 1, i],
        columns[SIZE, i],
        columns[POLARITY, i],
    )
    xs, ys, sizes, polarities = (
        columns[MIDDLE], columns[MIDDLE + 1], columns[SIZE], columns[POLARITY]
    )  # fmt: skip
    for j in range(i, len(marks)):
        dx, dy = x - xs[j], y - ys[j]
        near = STRIDE / (math.pi * LEAST_SHARE) * (size + sizes[j])
        marks[j] = (dx * dx + dy * dy <= near * near) & (polarity == polarities[j])


@inner_kernel
def fit_parts(
    table: FloatArray, moments: FloatArray, i: int, j: int, work: FloatArray, ellipse: FloatArray
) -> bool:
    """Fit an ellipse to one part (i = j) or two that see each other; False if they make up none."""
    length = STRIDE * table[i, SIZE]
    if j != i:
        length += STRIDE * table[j, SIZE]
        slack = SLACK[0] + SLACK[1] * length / STRIDE
        if not (sees(table[i], table[j], slack) and sees(table[j], table[i], slack)):
            return False
    scale = 1.0 / max(table[i, RADIUS], table[j, RADIUS])
    work[:] = 0.0
    add_shifted(work, moments[i], 0.0, 0.0, scale)
    if j != i:
        dx, dy = table[j, MIDDLE] - table[i, MIDDLE], table[j, MIDDLE + 1] - table[i, MIDDLE + 1]
        add_shifted(work, moments[j], dx, dy, scale)
    if not fit_moments(work, table[i, MIDDLE], table[i, MIDDLE + 1], scale, ellipse):
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
    reach: float, every: int, near: FloatArray, about: FloatArray, tally: IntArray,
    picked: IntArray,
) -> int:  # fmt: skip
    """Gather samples of one polarity within `reach` of an ellipse and along its normals.

    Of every so many samples one is looked at. Writes their positions to `near`, what is known of
    them to `about`, and how many each part gives to `tally`; returns their number.
    """
    x0, y0, cos, sin = ellipse[0], ellipse[1], math.cos(ellipse[4]), math.sin(ellipse[4])
    flat, steep = 1.0 / (ellipse[2] * ellipse[2]), 1.0 / (ellipse[3] * ellipse[3])
    beyond = 2.0 * reach / ellipse[3] * (1.0 + 2.0 * reach / ellipse[3])  # of what follows
    xs, ys, inward_x, inward_y = samples[X], samples[Y], samples[INWARD_X], samples[INWARD_Y]
    count = 0
    for part in range(len(starts) - 1):
        tally[part] = 0
        dx, dy, radius = table[part, MIDDLE] - x0, table[part, MIDDLE + 1] - y0, table[part, RADIUS]
        far = math.sqrt(dx * dx + dy * dy)
        inside = far + radius < ellipse[3] - reach
        if table[part, POLARITY] != polarity or inside or far - radius > ellipse[2] + reach:
            continue
        size = 0
        for k in range(starts[part], starts[part + 1], every):  # no branches: most are far
            dx, dy = xs[k] - x0, ys[k] - y0
            u, v = dx * cos + dy * sin, dy * cos - dx * sin
            picked[np.uint64(size)] = k
            size += abs(u * u * flat + v * v * steep - 1.0) <= beyond
        before = count
        for m in range(size):
            k = picked[m]
            d, nx, ny = offset_at(xs[k] - x0, ys[k] - y0, cos, sin, flat, steep)
            if abs(d) <= reach and -(nx * inward_x[k] + ny * inward_y[k]) >= ALONG:
                near[0, count], near[1, count] = xs[k], ys[k]
                about[AWAY, count] = d
                about[NORMAL_U, count] = nx * cos + ny * sin
                about[NORMAL_V, count] = ny * cos - nx * sin
                count += 1
        tally[part] = count - before
    return count


@inner_kernel
def elsewhere(starts: IntArray, tally: IntArray, every: int) -> int:
    """Return how many of every so many samples of parts that support an ellipse do not."""
    count = 0
    for part in range(len(tally)):
        size = (starts[part + 1] - starts[part] + every - 1) // every
        count += size - tally[part] if tally[part] > 0 else 0
    return count


@inner_kernel
def overlaps_one(ellipse: FloatArray, others: FloatArray, most: float) -> bool:
    """Tell whether an ellipse overlaps any of the others by more than `most`."""
    for m in range(len(others)):
        if overlap_bound(ellipse, others[m]) > most and overlap_of(ellipse, others[m]) > most:
            return True
    return False


@inner_kernel
def grow(
    samples: FloatArray, starts: IntArray, table: FloatArray, polarity: float, longest: float,
    reach: float, others: FloatArray, ellipse: FloatArray, near: FloatArray, about: FloatArray,
    tally: IntArray, picked: IntArray,
) -> int:  # fmt: skip
    """Refit an ellipse in place to what lies ever nearer to it; return how many do, 0 for none.

    None, too, where it becomes a copy of one of the `others`.
    """
    for step in range(ROUNDS):
        if not is_fair(ellipse, longest):
            return 0
        every = COARSE if step < ROUNDS // 2 else 1
        if step == ROUNDS // 2 and overlaps_one(ellipse, others, COPY):
            return 0
        within = reach * ellipse[3] * (2.0 - step / (ROUNDS - 1.0))
        count = collect_rough(
            samples, starts, table, polarity, ellipse, within, every, near, about, tally, picked,
        )  # fmt: skip
        if STRIDE * every * count < LEAST_GROWN[step] * math.pi * (ellipse[2] + ellipse[3]):
            return 0
        if step > 0 and elsewhere(starts, tally, every) > MOST_ELSEWHERE * count:
            return 0
        if step == ROUNDS - 1:
            return count
        if not refit(near, count, ellipse, 2, 1.5 * within):
            return 0
    return 0


@inner_kernel
def turn_of(x: float, y: float) -> float:
    """Return the direction of (x, y) in turns, 0 to 1, within 1e-5.

    References
    ----------
    Abramowitz and Stegun, Handbook of Mathematical Functions, 4.4.49.
    """
    most, least = max(abs(x), abs(y)), min(abs(x), abs(y))
    ratio = least / (most + 1e-300)
    s = ratio * ratio
    turn = 0.180141 + s * (-0.085133 + s * 0.0208351)
    turn = ratio * (0.999866 + s * (-0.3302995 + s * turn)) / (2.0 * math.pi)
    turn = 0.25 - turn if abs(y) > abs(x) else turn
    turn = 0.5 - turn if x < 0.0 else turn
    return 1.0 - turn if y < 0.0 else turn


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
        turn = turn_of(nu, nv)
        along = turn_of(ellipse[2] * nu, ellipse[3] * nv)
        bins[0, int(turn * BINS) % BINS] += 1
        bins[1, int(along * BINS) % BINS] += 1
        squares += about[AWAY, k] * about[AWAY, k]
    gap = widest = turned = covered = 0
    for k in range(2 * BINS):
        gap = 0 if bins[0, k % BINS] > 0 else gap + 1
        widest = max(widest, min(gap, BINS))
        turned += (k < BINS) & (bins[0, k % BINS] > 0)
        covered += (k < BINS) & (bins[1, k % BINS] > 0)
    row[TURN], row[LENGTH], row[WIDEST] = turned / BINS, covered / BINS, widest / BINS
    row[SCATTER] = math.sqrt(squares / count) / ellipse[3]
    row[ELSEWHERE] = elsewhere(starts, tally, 1) / count


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
    longest: float, others: FloatArray,
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Return ellipses (n, 5) grown from parts and pairs of them, and their figures."""
    size, count = samples.shape[1], len(table)
    ellipses, figures = np.empty((MOST_TRIES, 5)), np.zeros((MOST_TRIES, FIGURES))
    near, about = np.empty((3, size)), np.empty((3, size))
    tally, bins = np.zeros(count, np.int64), np.zeros((2, BINS), np.int64)
    known = np.zeros((count, count), np.bool_)
    picked = np.empty(size + 1, np.int64)
    columns, marks = table.T.copy(), np.empty(count, np.int8)
    work, ellipse = np.empty(25), np.empty(5)
    found = tried = 0
    for i in range(count):
        parts_near(columns, i, marks)
        for j in range(i, count):
            if not marks[j] or known[i, j] or tried == MOST_TRIES:
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
                samples, starts, table, table[i, POLARITY], longest, reach, others, ellipse, near,
                about, tally, picked,
            )  # fmt: skip
            if used == 0:
                continue
            measure_rough(starts, ellipse, about, used, tally, bins, figures[found])
            figures[found, SIGN] = table[i, POLARITY]
            covered = min(figures[found, TURN], figures[found, LENGTH])
            if covered >= WELL_COVERED:
                note_parts(starts, tally, known)
            ellipses[found] = ellipse
            found += covered >= LEAST_COVERED
    return ellipses[:found], figures[:found]


@kernel
def rough_ellipses(
    points: FloatArray, normals: FloatArray, runs: IntArray, rings: BoolArray, least: int,
    most: int, reach: float, longest: float, others: FloatArray,
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Return the rough ellipses (n, 5) of runs of points, and their figures.

    None is a copy of one of the `others`.
    """
    samples, starts, table, moments = parts_of_runs(points, normals, runs, rings, least, most)
    return grow_pairs(samples, starts, table, moments, reach, longest, others)
