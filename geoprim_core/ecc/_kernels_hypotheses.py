"""Kernels of grouping and hypotheses evaluation, thesis 5.4.5, all from additive moments."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.fitting._kernels_fit import NSAF, OK, fit_group
from geoprim_core.fitting._kernels_moments import add_moments


@kernel
def arc_moments(
    points: FloatArray, offsets: IntArray, x0: float, y0: float, scale: float
) -> FloatArray:
    """Return the moments (K, 15) of every arc about a common origin, in units of `scale`."""
    moments = np.zeros((len(offsets) - 1, 15))
    for k in range(len(moments)):
        add_moments(points[offsets[k] : offsets[k + 1]], x0, y0, scale, moments[k])
    return moments


@kernel
def holds(ellipse: FloatArray, x: float, y: float) -> bool:
    """Say whether a point lies inside an ellipse."""
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    u = ((x - ellipse[0]) * cos + (y - ellipse[1]) * sin) / ellipse[2]
    v = ((y - ellipse[1]) * cos - (x - ellipse[0]) * sin) / ellipse[3]
    return bool(u * u + v * v < 1.0)


@kernel
def strongest_valid(
    group: IntArray,
    moments: FloatArray,
    frame: FloatArray,
    at: FloatArray,
    max_residual: float,
) -> tuple[int, FloatArray, float]:
    """Return how many arcs of a ranked group remain when C1 and C2 hold, the ellipse, its error.

    None may remain. The sums of the first n arcs' moments are kept, so that dropping the weakest
    arc is one step back.
    """
    ellipse = np.zeros(5)
    sums = np.zeros((len(group) + 1, 15))
    for n in range(len(group)):
        sums[n + 1] = sums[n] + moments[group[n]]
    for n in range(len(group), 0, -1):
        status, ellipse, residual = fit_group(sums[n], frame[0], frame[1], frame[2], NSAF)
        if status == OK and residual <= max_residual and holds(ellipse, at[0], at[1]):
            return n, ellipse, residual
    return 0, ellipse, math.nan


@kernel
def form_hypotheses(
    vote_arc: IntArray,
    vote_bin: IntArray,
    bins: BoolArray,
    bin_centres: FloatArray,
    moments: FloatArray,
    frame: FloatArray,
    eligible: BoolArray,
    max_group: int,
    max_residual: float,
) -> tuple[FloatArray, FloatArray, IntArray, IntArray, IntArray]:
    """Return ellipses (n, 5), residuals, bins, and the arcs of all groups with their offsets.

    `eligible` (K, K) names the arcs that each arc may be grouped with: every arc of a bin leads
    a group of its own. Where it is empty, all arcs of a bin are one group.
    """
    ellipses, residuals, origin = [np.zeros(5)], [0.0], [0]
    members, ends = [0], [0]
    start = 0
    while start < len(vote_arc):
        stop = start
        while stop < len(vote_arc) and vote_bin[stop] == vote_bin[start]:
            stop += 1
        ranked = vote_arc[start : min(stop, start + max_group)]
        at = vote_bin[start]
        start = stop
        if not bins[at]:
            continue
        seen = {np.uint64(0)}
        for lead in range(len(ranked) if len(eligible) > 0 else 1):
            group = np.empty(len(ranked), np.int64)
            size, mask = 0, np.uint64(0)
            for i in range(len(ranked)):
                if len(eligible) == 0 or i == lead or eligible[ranked[lead], ranked[i]]:
                    group[size] = ranked[i]
                    size += 1
                    mask |= np.uint64(1) << np.uint64(i)
            if mask in seen:
                continue
            seen.add(mask)
            left, ellipse, residual = strongest_valid(
                group[:size], moments, frame, bin_centres[at], max_residual
            )
            if left > 0:
                ellipses.append(ellipse)
                residuals.append(residual)
                origin.append(at)
                for i in range(left):
                    members.append(group[i])
                ends.append(len(members) - 1)
    table = np.empty((len(ellipses) - 1, 5))
    for i in range(len(table)):
        table[i] = ellipses[i + 1]
    return (
        table,
        np.array(residuals)[1:],
        np.array(origin)[1:],
        np.array(members)[1:],
        np.array(ends),
    )
