"""Kernels of the `refined` scheme: selection by unclaimed support."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_fit import offset_of
from geoprim_core.ecc.refined._kernels_outline import ACROSS
from geoprim_core.ecc.refined._kernels_places import outline_of, pixel_at
from geoprim_core.ecc.refined._kernels_points import EdgeIndex
from geoprim_core.ecc.refined._kernels_support import (
    COVERAGE,
    EVIDENCE,
    LENGTH,
    RMS,
    TURN_COVERAGE,
    Supported,
)
from geoprim_core.fitting._kernels_overlap import overlap_bound, overlap_of

PROBES = 32
PROBE_COS = np.cos(2.0 * np.pi * (np.arange(PROBES) + 0.5) / PROBES)
PROBE_SIN = np.sin(2.0 * np.pi * (np.arange(PROBES) + 0.5) / PROBES)
BESIDE = 2.0  # pixels between outlines that are not the same
WHOLE = 0.7  # least supported share of an outline that weaves through another
CLOSE = 0.4  # pixels, its largest scatter

# What became of an ellipse.
WEAK, CLAIMED, TWIN, CHOSEN = range(4)


@kernel
def claim(
    edges: EdgeIndex,
    ellipse: FloatArray,
    reach: float,
    claimed: BoolArray,
) -> None:
    """Mark the edge points within `reach` of an outline that do not cross it."""
    head, following, points, normals = edges
    height, width = head.shape
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    band = int(math.ceil(reach))
    places = outline_of(ellipse[2], ellipse[3], 2.0)
    for k in range(len(places)):
        px, py = pixel_at(ellipse, cos, sin, places[k, 0], places[k, 1])
        for y in range(max(0, py - band), min(height, py + band + 1)):
            for x in range(max(0, px - band), min(width, px + band + 1)):
                p = head[y, x]
                while p >= 0:
                    if not claimed[p]:
                        d, nx, ny = offset_of(ellipse, cos, sin, points[p, 0], points[p, 1])
                        dot = abs(nx * normals[p, 0] + ny * normals[p, 1])
                        claimed[p] = abs(d) <= reach and dot >= ACROSS
                    p = following[p]


@inner_kernel
def weaves(ellipse: FloatArray, other: FloatArray, least: float) -> bool:
    """Tell whether an outline runs inside another for a share `least` and outside for as much.

    The second edge of a rim, or a copy, lies on one side of the first or on it.
    """
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    other_cos, other_sin = math.cos(other[4]), math.sin(other[4])
    inside = outside = 0
    for k in range(PROBES):
        u, v = ellipse[2] * PROBE_COS[k], ellipse[3] * PROBE_SIN[k]
        x, y = ellipse[0] + u * cos - v * sin, ellipse[1] + u * sin + v * cos
        d, _, _ = offset_of(other, other_cos, other_sin, x, y)
        inside += d < -BESIDE
        outside += d > BESIDE
    return min(inside, outside) >= least * PROBES


@inner_kernel
def is_twin(
    ellipses: FloatArray,
    figures: FloatArray,
    chosen: IntArray,
    found: int,
    candidate: int,
    max_overlap: float,
    min_woven: float,
) -> bool:
    """Tell whether an ellipse overlaps one of the chosen by more than `max_overlap`.

    One that is supported closely and nearly all along, and weaves through the other, is another
    thing.
    """
    row = figures[candidate]
    sound = min(row[COVERAGE], row[TURN_COVERAGE]) >= WHOLE and row[RMS] <= CLOSE
    for m in range(found):
        other = ellipses[chosen[m]]
        if overlap_bound(ellipses[candidate], other) > max_overlap:
            if overlap_of(ellipses[candidate], other) > max_overlap:
                if not (sound and weaves(ellipses[candidate], other, min_woven)):
                    return True
    return False


@inner_kernel
def sink(heap: IntArray, size: int, at: int, value: FloatArray) -> None:
    """Restore a heap, greatest value first and of equals the first, below one entry."""
    while 2 * at + 1 < size:
        best = at
        for child in range(2 * at + 1, min(2 * at + 3, size)):
            i, j = heap[child], heap[best]
            if value[i] > value[j] or (value[i] == value[j] and i < j):
                best = child
        if best == at:
            return
        heap[at], heap[best] = heap[best], heap[at]
        at = best


@kernel
def select(
    edges: EdgeIndex,
    verified: Supported,
    min_evidence: float,
    reach: float,
    min_unclaimed: float,
    max_overlap: float,
    min_woven: float,
) -> tuple[IntArray, IntArray, BoolArray]:
    """Choose greedily the ellipse with the strongest support that no chosen one has claimed.

    Strength is the unclaimed supported length, times the root of the coverage, less for scatter.
    It only falls: in a heap only what comes to the top is looked at again.
    Returns the chosen in order, what became of each ellipse, and which points are claimed.
    """
    ellipses, figures, offsets, support = verified
    count = len(ellipses)
    claimed = np.zeros(len(edges.points), np.bool_)
    outcome = np.full(count, WEAK)
    strength = np.empty(count)
    heap = np.empty(count, np.int64)
    size = 0
    for k in range(count):
        row = figures[k]
        strength[k] = row[LENGTH] * math.sqrt(row[COVERAGE]) / (1.0 + 2.0 * row[RMS])
        if row[EVIDENCE] >= min_evidence and strength[k] > 0.0:
            heap[size] = k
            size += 1
    value = strength.copy()
    for at in range(size // 2 - 1, -1, -1):
        sink(heap, size, at, value)
    judged = np.full(count, -1)  # how many were chosen when an ellipse was looked at last
    chosen = np.empty(count, np.int64)
    found = 0
    while size > 0:
        k = heap[0]
        if judged[k] == found:  # what is below can but have fallen: it is the strongest
            outcome[k] = CHOSEN
            chosen[found] = k
            found += 1
            claim(edges, ellipses[k], reach, claimed)
        else:
            free = 0
            for s in range(offsets[k], offsets[k + 1]):
                if not claimed[support[s]]:
                    free += 1
            share = free / (offsets[k + 1] - offsets[k])
            if share < min_unclaimed:
                outcome[k] = CLAIMED
            elif is_twin(ellipses, figures, chosen, found, k, max_overlap, min_woven):
                outcome[k] = TWIN
            else:
                judged[k] = found
                value[k] = strength[k] * share
        if outcome[k] != WEAK:
            size -= 1
            heap[0] = heap[size]
        sink(heap, size, 0, value)
    return chosen[:found].copy(), outcome, claimed
