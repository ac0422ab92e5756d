"""Thesis 5.4.5: groups of arcs become elliptic hypotheses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core.ecc import _kernels_hypotheses as kernels
from geoprim_core.ecc.arcs import Arcs
from geoprim_core.ecc.grouping_params import GroupingParams
from geoprim_core.ecc.votes import Votes


@dataclass(frozen=True, slots=True, eq=False)
class Hypotheses:
    """Elliptic hypotheses and the groups of arcs that they were fitted to.

    Attributes
    ----------
    ellipses : (n, 5) float64
        x, y, semi_major, semi_minor, angle.
    residual : (n,) float64
        Error of criterion C1: root mean square of the conic that is -1 at the centre.
    bin : (n,) int64
        The centre bin of the group.
    arc : (M,) int64
        Arcs of all groups, each from strong to weak.
    offsets : (n + 1,) int64
        Group i is `arc[offsets[i]:offsets[i + 1]]`.
    """

    ellipses: FloatArray
    residual: FloatArray
    bin: IntArray
    arc: IntArray
    offsets: IntArray

    def __len__(self) -> int:
        """Return the number of hypotheses."""
        return len(self.ellipses)

    def group(self, index: int) -> IntArray:
        """Return the arcs of one hypothesis, strongest first."""
        return self.arc[self.offsets[index] : self.offsets[index + 1]]

    def select(self, chosen: IntArray | BoolArray) -> Hypotheses:
        """Return the hypotheses at the given indices or where the mask is true."""
        kept = np.arange(len(self))[chosen]
        sizes = np.diff(self.offsets)[kept]
        offsets = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
        inside = np.arange(offsets[-1]) + np.repeat(self.offsets[kept] - offsets[:-1], sizes)
        return Hypotheses(
            self.ellipses[kept], self.residual[kept], self.bin[kept], self.arc[inside], offsets
        )


def form_hypotheses(
    arcs: Arcs, votes: Votes, eligible: BoolArray | None, params: GroupingParams
) -> Hypotheses:
    """Group the arcs of every centre bin, rank them, and fit ellipses that pass C1 and C2.

    Each arc of a bin leads a group: itself and the arcs that are eligible for it (row k of
    `eligible`); with None all arcs of a bin are one group. The weakest arc is dropped until the
    fit passes or nothing is left. Groups that end up with the same arcs count once. Sums of
    moments serve for every fit: a group costs the same, however many pixels it has.

    References
    ----------
    Thesis 5.4.5, C1 and C2, 4.2.2 (NSAF); errata C4: the error of C1 is the root mean square of
    the conic f that is -1 at the centre of the ellipse, to first order twice the deviation over
    the radius there; epsilon_ls is tuned to that.
    """
    moments, frame = group_frame(arcs)
    found = kernels.form_hypotheses(
        votes.arc,
        votes.bin,
        votes.strong_bins(params.min_bin_score),
        votes.bin_centres(),
        moments,
        frame,
        np.zeros((0, 0), np.bool_) if eligible is None else eligible,
        params.max_group,
        params.max_residual,
    )
    return _without_copies(Hypotheses(*found))


def group_frame(arcs: Arcs) -> tuple[FloatArray, FloatArray]:
    """Return the moments of every arc and their common frame (x0, y0, scale)."""
    positions = arcs.positions
    if len(positions) == 0:
        return np.zeros((0, 15)), np.array([0.0, 0.0, 1.0])
    low, high = positions.min(axis=0), positions.max(axis=0)
    frame = np.array([*(low + high) / 2, max(1.0, *(high - low)) / 2])
    return kernels.arc_moments(positions, arcs.offsets, *frame), frame


def _without_copies(hypotheses: Hypotheses) -> Hypotheses:
    seen: set[bytes] = set()
    kept = np.zeros(len(hypotheses), np.bool_)
    for i in range(len(hypotheses)):
        key = np.sort(hypotheses.group(i)).tobytes()
        kept[i] = key not in seen
        seen.add(key)
    return hypotheses.select(kept)
