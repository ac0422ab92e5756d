"""Kernels of the `refined` scheme, pairs: one ellipse for each of many pairs of arcs.

Pairs are fitted in batches, each quantity in a row of its own and without branches: the bodies of
the loops then compile to vector instructions. All rows lie in one flat array, at places that are
known when it is compiled: whether two of them overlap need not be asked at run time.
"""

from __future__ import annotations

import math
from typing import cast

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel, summing_kernel
from geoprim_core.ecc.refined._kernels_arcs import INWARDS, MIDDLE, SIZE
from geoprim_core.ecc.refined._kernels_conic import axes_of_conic, direct_conic, ellipse_of_conic
from geoprim_core.ecc.refined._kernels_few import PairRules
from geoprim_core.fitting._kernels_shape import perimeter_of

SAMPLES = 12  # points of an arc that an ellipse is measured by
BATCH = 64  # pairs that are fitted together
ALONG = 0.9  # cosine between the inner normals of an arc and of an ellipse that it may lie on
TINY = 1e-300
LEAST_SEMI_MINOR = 2.0  # pixels
LEAST_RMS = 0.15  # pixels, below which a closer fit is hardly a better one
FIRST = cast(int, np.int64(0))  # typed: numba may compile a kernel anew for a literal number

# Where rows of `BATCH` numbers begin: moments of either arc ([5 p + q] as in `add_point`), from the
# middle of the arc to the origin of its pair, that origin, the conic a x^2 + b xy + ... + f, its
# semi-axes, whether the pair is still good.
ONE, OTHER = 0, 25 * BATCH
DX, DY, X, Y = 50 * BATCH, 51 * BATCH, 52 * BATCH, 53 * BATCH
A, B, C, D, E, F = (54 * BATCH, 55 * BATCH, 56 * BATCH, 57 * BATCH, 58 * BATCH, 59 * BATCH)
MAJOR, MINOR, GOOD = 60 * BATCH, 61 * BATCH, 62 * BATCH
WORK = 63 * BATCH


@kernel
def sample_arcs(points: FloatArray, order: IntArray, ends: IntArray) -> FloatArray:
    """Return 12 points of each arc (A, 2, 13), the one amidst at the end; of short arcs fewer."""
    samples = np.zeros((len(ends) - 1, 2, SAMPLES + 1))
    for i in range(len(samples)):
        low, size = ends[i], ends[i + 1] - ends[i]
        count = min(SAMPLES, size)
        middle, other = order[low + size // 2], order[low + (size - 1) // 2]
        for c in range(2):
            samples[i, c, SAMPLES] = 0.5 * (points[middle, c] + points[other, c])
        for k in range(count):
            # Backwards from the end in the second half: the same points whichever way the arc runs.
            back = count - 1 - k
            at = (min(k, back) * (size - 1)) // (count - 1)
            p = order[low + (at if k <= back else size - 1 - at)]
            samples[i, 0, k], samples[i, 1, k] = points[p, 0], points[p, 1]
    return samples


@inner_kernel
def load_moments(
    moments: FloatArray, arcs: IntArray, size: int, start: int, work: FloatArray
) -> None:
    """Write the moments of one arc of each pair to rows from `start` on; of arc -1 zeros."""
    for k in range(size):
        i = np.uint64(max(arcs[k], 0))
        share = 1.0 if arcs[k] >= 0 else 0.0
        for p in range(5):
            for q in range(5 - p):
                c = 5 * p + q
                work[start + c * BATCH + k] = share * moments[i, c]


@inner_kernel
def move_moments(size: int, start: int, work: FloatArray) -> None:
    """Move the points that moments are of by (DX, DY): (x + d)^p in p steps of one product each.

    One step takes x^p to x^p + d x^(p - 1); those with a power too few are done already.
    """
    for step in range(1, 5):
        for p in range(4, step - 1, -1):
            for q in range(5 - p):
                to, of = start + (5 * p + q) * BATCH, start + (5 * p + q - 5) * BATCH
                for k in range(size):
                    work[to + k] += work[DX + k] * work[of + k]
    for step in range(1, 5):
        for q in range(4, step - 1, -1):
            for p in range(5 - q):
                to, of = start + (5 * p + q) * BATCH, start + (5 * p + q - 1) * BATCH
                for k in range(size):
                    work[to + k] += work[DY + k] * work[of + k]


@inner_kernel
def add_pairs(
    table: FloatArray,
    moments: FloatArray,
    first: IntArray,
    second: IntArray,
    size: int,
    work: FloatArray,
) -> None:
    """Write the moments of both arcs of each pair about the point between their middles."""
    for k in range(size):
        i = first[k]
        j = second[k] if second[k] >= 0 else i
        own_x, own_y = table[i, MIDDLE], table[i, MIDDLE + 1]
        x, y = 0.5 * (own_x + table[j, MIDDLE]), 0.5 * (own_y + table[j, MIDDLE + 1])
        work[X + k], work[Y + k] = x, y
        work[DX + k], work[DY + k] = own_x - x, own_y - y
    load_moments(moments, first, size, ONE, work)
    move_moments(size, ONE, work)
    for k in range(size):  # the other middle lies as far on the other side
        work[DX + k], work[DY + k] = -work[DX + k], -work[DY + k]
    load_moments(moments, second, size, OTHER, work)
    move_moments(size, OTHER, work)
    for c in range(25):
        for k in range(size):
            work[ONE + c * BATCH + k] += work[OTHER + c * BATCH + k]


@inner_kernel
def fit_conics(size: int, work: FloatArray) -> None:
    """Write the conics of the direct fits, positive outside."""
    for k in range(size):
        a, b, c, d, e, f = direct_conic(
            work[k], work[BATCH + k], work[2 * BATCH + k], work[3 * BATCH + k], work[4 * BATCH + k],
            work[5 * BATCH + k], work[6 * BATCH + k], work[7 * BATCH + k], work[8 * BATCH + k],
            work[10 * BATCH + k], work[11 * BATCH + k], work[12 * BATCH + k],
            work[15 * BATCH + k], work[16 * BATCH + k], work[20 * BATCH + k],
        )  # fmt: skip
        sign = 1.0 if a + c >= 0.0 else -1.0
        work[A + k], work[B + k], work[C + k] = sign * a, sign * b, sign * c
        work[D + k], work[E + k], work[F + k] = sign * d, sign * e, sign * f
        _, _, work[MAJOR + k], work[MINOR + k] = axes_of_conic(a, b, c, d, e, f)


@inner_kernel
def refuse_lengths(
    lengths: FloatArray, size: int, max_size: float, min_share: float, work: FloatArray
) -> None:
    """Refuse ellipses of no size and those of which the arcs can but be too small a share."""
    for k in range(size):
        major, minor = work[MAJOR + k], work[MINOR + k]
        whole = math.pi * (major + minor)  # or longer
        good = (major <= max_size) & (minor >= LEAST_SEMI_MINOR) & (min_share * whole <= lengths[k])
        work[GOOD + k] = 1.0 if good else 0.0


@inner_kernel
def refuse_normals(
    samples: FloatArray, table: FloatArray, arcs: IntArray, size: int, work: FloatArray
) -> None:
    """Refuse ellipses that one arc of each pair bends away from, by its normal amidst."""
    for k in range(size):
        i = np.uint64(max(arcs[k], 0))
        x, y = samples[i, 0, SAMPLES] - work[X + k], samples[i, 1, SAMPLES] - work[Y + k]
        gx = 2.0 * work[A + k] * x + work[B + k] * y + work[D + k]
        gy = 2.0 * work[C + k] * y + work[B + k] * x + work[E + k]
        inwards = gx * table[i, INWARDS + 2] + gy * table[i, INWARDS + 3]
        good = (inwards <= -ALONG * math.sqrt(gx * gx + gy * gy)) | (arcs[k] < 0)
        work[GOOD + k] = work[GOOD + k] if good else 0.0


@summing_kernel
def mean_square(samples: FloatArray, i: int, count: int, work: FloatArray, k: int) -> float:
    """Return the mean square distance of the first `count` samples of arc i to ellipse k.

    Sampson's distance: the conic's value over the length of its gradient.
    """
    xs, ys = samples[np.uint64(i), 0], samples[np.uint64(i), 1]
    a, b, c, d, e, f = (
        work[A + k], work[B + k], work[C + k], work[D + k], work[E + k], work[F + k],
    )  # fmt: skip
    x0, y0 = work[X + k], work[Y + k]
    total = 0.0
    for s in range(SAMPLES):
        x, y = xs[s] - x0, ys[s] - y0
        gx, gy = 2.0 * a * x + b * y + d, 2.0 * c * y + b * x + e
        value = 0.5 * (x * (gx + d) + y * (gy + e)) + f
        square = value * value / (gx * gx + gy * gy + TINY)
        total += square if s < count else 0.0
    return total / count


@inner_kernel
def write_ellipse(work: FloatArray, k: int, values: FloatArray, found: int) -> None:
    """Write ellipse k of a batch to a row of values, from the second on."""
    out = values[found, 1:]
    ellipse_of_conic(
        work[A + k], work[B + k], work[C + k], work[D + k], work[E + k], work[F + k], out
    )
    out[0] += work[X + k]
    out[1] += work[Y + k]


@kernel
def fit_pairs(
    samples: FloatArray,
    table: FloatArray,
    moments: FloatArray,
    pairs: IntArray,
    size: int,
    rules: PairRules,
    work: FloatArray,
    arcs: IntArray,
    values: FloatArray,
) -> int:
    """Fit an ellipse to each of the first `size` columns of `pairs` (2, BATCH).

    They are two arcs, or one where the second is -1. Writes the arcs, and the rank and ellipse, of
    those that lie near enough to it and make up enough of it; returns how many these are.
    """
    first, second = pairs[0], pairs[1]
    min_share, most = rules.min_share, rules.max_rms * rules.max_rms
    lengths = np.empty(BATCH)
    for k in range(size):
        lengths[k] = table[first[k], SIZE] + (table[second[k], SIZE] if second[k] >= 0 else 0.0)
    add_pairs(table, moments, first, second, size, work)
    fit_conics(size, work)
    refuse_lengths(lengths, size, rules.max_semi_major, min_share, work)
    refuse_normals(samples, table, first, size, work)
    refuse_normals(samples, table, second, size, work)
    found = FIRST
    for k in range(size):
        worst = 0.0
        for side in range(2):  # the shorter arc first: the fit follows the longer one
            i = second[k] if side == 0 else first[k]
            if work[GOOD + k] > 0.0 and i >= 0:
                count = min(SAMPLES, int(table[i, SIZE]))
                worst = max(worst, mean_square(samples, i, count, work, k))
                work[GOOD + k] = 1.0 if worst < most else 0.0
        if not work[GOOD + k] > 0.0:
            continue
        major, minor = work[MAJOR + k], work[MINOR + k]
        longest = math.pi * math.sqrt(2.0 * (major * major + minor * minor))  # of this perimeter
        if lengths[k] < min_share * longest and lengths[k] < min_share * perimeter_of(major, minor):
            continue
        arcs[found, 0], arcs[found, 1] = first[k], second[k]
        values[found, 0] = lengths[k] / (LEAST_RMS + math.sqrt(worst))
        write_ellipse(work, k, values, found)
        found += 1
    return found
