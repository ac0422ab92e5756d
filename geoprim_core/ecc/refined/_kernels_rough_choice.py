"""Kernels of the `refined` scheme: which rough outlines are reported, and their edge points."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_fit import offset_of
from geoprim_core.ecc.refined._kernels_rough import (
    ALONG,
    ELSEWHERE,
    LENGTH,
    SCATTER,
    SIGN,
    TURN,
    WIDEST,
    overlaps_one,
)
from geoprim_core.ecc.refined._kernels_select import CHOSEN, CLAIMED, TWIN, WEAK

SCATTER_WEIGHT = 8.0  # a scatter of 0.01 semi-minor axes tells as much as a gap of 0.08


@kernel
def rough_evidence(figures: FloatArray) -> FloatArray:
    """Return for each rough ellipse the share of its outline that one even curve explains.

    That is the covered share less the widest gap, the scatter, and what runs on elsewhere.
    """
    evidence = np.empty(len(figures))
    for k in range(len(figures)):
        row = figures[k]
        evidence[k] = min(row[TURN], row[LENGTH]) - row[WIDEST] - row[ELSEWHERE]
        evidence[k] -= SCATTER_WEIGHT * row[SCATTER]
    return evidence


@inner_kernel
def points_along(
    points: FloatArray, normals: FloatArray, runs: IntArray, ellipse: FloatArray, reach: float,
    polarity: float, chosen: IntArray,
) -> tuple[int, float]:  # fmt: skip
    """Put the points of runs that lie along an ellipse to `chosen`; return number and squares."""
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    count, squares = 0, 0.0
    for r in range(len(runs)):
        for k in range(runs[r, 0], runs[r, 1]):
            if abs(points[k, 0] - ellipse[0]) > ellipse[2] + reach:
                continue
            d, nx, ny = offset_of(ellipse, cos, sin, points[k, 0], points[k, 1])
            along = -polarity * (nx * normals[k, 0] + ny * normals[k, 1]) >= ALONG
            if along and abs(d) <= reach:
                chosen[count] = k
                count += 1
                squares += d * d
    return count, squares


@kernel
def choose_rough(
    points: FloatArray, normals: FloatArray, runs: IntArray, ellipses: FloatArray,
    figures: FloatArray, evidence: FloatArray, others: FloatArray, claimed: BoolArray,
    reach: float, least_evidence: float, max_scatter: float, min_unclaimed: float, most: float,
) -> tuple[IntArray, IntArray, IntArray, IntArray, FloatArray]:  # fmt: skip
    """Choose greedily the rough ellipses with the strongest evidence that others leave.

    `others` are the ellipses reported so far. Returns the chosen in order, what became of each,
    offsets and indices of their supporting points, and the rms distances. Claims these points.
    """
    count = len(ellipses)
    outcome = np.full(count, WEAK)
    rms = np.zeros(count)
    chosen, offsets = np.empty(count, np.int64), np.zeros(count + 1, np.int64)
    support = np.empty(len(points), np.int64)  # no point twice
    along = np.empty(len(points), np.int64)
    found = used = 0
    for k in np.argsort(-evidence, kind="mergesort"):
        if evidence[k] < least_evidence or figures[k, SCATTER] > max_scatter:
            continue
        same = overlaps_one(ellipses[k], others, most)
        if same or overlaps_one(ellipses[k], ellipses[chosen[:found]], most):
            outcome[k] = TWIN
            continue
        size, squares = points_along(
            points, normals, runs, ellipses[k], reach * ellipses[k, 3], figures[k, SIGN], along
        )
        free = 0
        for m in range(size):
            if not claimed[along[m]]:
                support[used + free] = along[m]
                free += 1
        if free < min_unclaimed * size or free == 0:
            outcome[k] = CLAIMED
            continue
        outcome[k], rms[k] = CHOSEN, math.sqrt(squares / size)
        chosen[found] = k
        used += free
        found += 1
        offsets[found] = used
        for m in range(offsets[found - 1], used):
            claimed[support[m]] = True
    return chosen[:found].copy(), outcome, offsets[: found + 1], support[:used].copy(), rms
