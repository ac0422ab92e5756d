"""Kernels of the centres of arcs and their votes, thesis 5.4.3 and 5.4.4."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.tangent._kernels_yuen import yuen_centre

# Powers of the plastic constant: the additive sequence that fills the cube most evenly.
STEP_1 = 0.8191725133961645
STEP_2 = 0.6710436067037893
STEP_3 = 0.5497004779019703


@kernel
def arc_centres(
    points: FloatArray, angle: FloatArray, offsets: IntArray, sets: int, min_sine: float
) -> FloatArray:
    """Return the centres (K, S, 2) of S triples of every arc, NaN where a triple gives none."""
    count = len(offsets) - 1
    centres = np.full((count, sets, 2), np.nan)
    p = np.empty((len(points), 4))  # x, y, cos, sin of the pixels with a tangent
    for k in range(count):
        n = 0
        for i in range(offsets[k], offsets[k + 1]):
            if not math.isnan(angle[i]):
                p[n, 0], p[n, 1] = points[i, 0], points[i, 1]
                p[n, 2], p[n, 3] = math.cos(angle[i]), math.sin(angle[i])
                n += 1
        if n < 3:
            continue
        cut1, cut2 = n // 3, (2 * n) // 3
        at1 = at2 = at3 = 0.5
        for s in range(sets):
            at1 = at1 + STEP_1 - (1.0 if at1 + STEP_1 >= 1.0 else 0.0)
            at2 = at2 + STEP_2 - (1.0 if at2 + STEP_2 >= 1.0 else 0.0)
            at3 = at3 + STEP_3 - (1.0 if at3 + STEP_3 >= 1.0 else 0.0)
            i = int(at1 * cut1)
            j = cut1 + int(at2 * (cut2 - cut1))
            m = cut2 + int(at3 * (n - cut2))
            found, x, y = yuen_centre(p, i, j, m, min_sine)
            if found:
                centres[k, s, 0] = x
                centres[k, s, 1] = y
    return centres


@kernel
def count_votes(
    centres: FloatArray, x0: float, y0: float, bin_size: float, columns: int, rows: int
) -> tuple[IntArray, IntArray]:
    """Return the votes as rows (arc, bin, S_e^b), and the valid sets S_e (K,) of every arc.

    The edge of the grid is at (x0, y0). A centre that lies in no bin is not valid.
    """
    count, sets = centres.shape[:2]
    table = np.empty((count * sets, 3), np.int64)
    valid = np.zeros(count, np.int64)
    at = 0
    bins = np.empty(sets, np.int64)
    for k in range(count):
        n = 0
        for s in range(sets):
            x = (centres[k, s, 0] - x0) / bin_size
            y = (centres[k, s, 1] - y0) / bin_size
            if 0.0 <= x < columns and 0.0 <= y < rows:
                bins[n] = int(y) * columns + int(x)
                n += 1
        valid[k] = n
        ordered = np.sort(bins[:n])
        for s in range(n):
            if s == 0 or ordered[s] != ordered[s - 1]:
                table[at, 0] = k
                table[at, 1] = ordered[s]
                table[at, 2] = 0
                at += 1
            table[at - 1, 2] += 1
    return table[:at].copy(), valid


@kernel
def meeting_pairs(
    vote_arc: IntArray, vote_bin: IntArray, bins: BoolArray, max_group: int, count: int
) -> BoolArray:
    """Return (K, K): two different arcs are among the strongest of a common bin."""
    meet = np.zeros((count, count), np.bool_)
    start = 0
    while start < len(vote_arc):
        stop = start
        while stop < len(vote_arc) and vote_bin[stop] == vote_bin[start]:
            stop += 1
        if bins[vote_bin[start]]:
            last = min(stop, start + max_group)
            for i in range(start, last):
                for j in range(start, last):
                    meet[vote_arc[i], vote_arc[j]] = i != j
        start = stop
    return meet
