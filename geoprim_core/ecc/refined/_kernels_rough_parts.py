"""Kernels of the `refined` scheme: parts of the long contours that rough outlines may be made of.

Every few points of a contour are looked at only: what deviates by pixels needs no more.
"""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.ecc.refined._kernels_arcs import (
    FIGURES,
    MIDDLE,
    POLARITY,
    SAGITTA,
    SIZE,
    describe_arcs,
)
from geoprim_core.ecc.refined._kernels_split import split_contours

STRIDE = 3  # every such point of a contour is looked at
TOLERANCE = 2.0  # pixels, of the polygon that finds turns and inflexions of rough contours
MAX_TURN = math.radians(60.0)  # sharpest turn inside a part
LEAST_HEIGHT = 0.03  # of a part over its chord, in its length: others are straight

# Column of the table of parts beyond those of arcs: largest distance from the middle.
RADIUS = FIGURES

# Rows of a sample: position and inner normal.
X, Y, INWARD_X, INWARD_Y = range(4)


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
    bent = np.flatnonzero(table[:, SAGITTA] > LEAST_HEIGHT * STRIDE * table[:, SIZE])
    return bent[np.argsort(-table[bent, SIZE], kind="mergesort")][:most]


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
        inward = table[kept[k], POLARITY]
        for m in range(starts[k + 1] - starts[k]):
            p, at = order[ends[kept[k]] + m], starts[k] + m
            samples[X, at], samples[Y, at] = points[p, 0], points[p, 1]
            samples[INWARD_X, at] = inward * normals[p, 0]
            samples[INWARD_Y, at] = inward * normals[p, 1]
    return samples, starts


@kernel
def with_radius(table: FloatArray, samples: FloatArray, starts: IntArray) -> FloatArray:
    """Return the table of parts with their `RADIUS` too."""
    wider = np.empty((len(table), RADIUS + 1))
    for k in range(len(table)):
        wider[k, :RADIUS] = table[k, :RADIUS]
        x, y = table[k, MIDDLE], table[k, MIDDLE + 1]
        farthest = 0.0
        for at in range(starts[k], starts[k + 1]):
            dx, dy = samples[X, at] - x, samples[Y, at] - y
            farthest = max(farthest, dx * dx + dy * dy)
        wider[k, RADIUS] = math.sqrt(farthest)
    return wider


@kernel
def parts_of_runs(
    points: FloatArray, normals: FloatArray, runs: IntArray, rings: BoolArray, least: int,
    most: int,
) -> tuple[FloatArray, IntArray, FloatArray, FloatArray]:  # fmt: skip
    """Return the samples (4, S) of at most `most` parts of runs, offsets, table and moments.

    Parts have no sharp turns and no inflexions, and `least` points of a contour or more. Table and
    moments are those of `describe_arcs`, of samples, and the table has the `RADIUS` too.
    """
    taken, offsets = sample_runs(runs)
    xy, across = np.empty((len(taken), 2)), np.empty((len(taken), 2))
    for k in range(len(taken)):
        xy[k, 0], xy[k, 1] = points[taken[k], 0], points[taken[k], 1]
        across[k, 0], across[k, 1] = normals[taken[k], 0], normals[taken[k], 1]
    order, ends, _ = split_contours(xy, offsets, rings, TOLERANCE, MAX_TURN, least // STRIDE)
    table, moments = describe_arcs(xy, across, order, ends)
    kept = bent_parts(table, most)
    samples, starts = gather_parts(xy, across, order, ends, table, kept)
    return samples, starts, with_radius(table[kept], samples, starts), moments[kept]
