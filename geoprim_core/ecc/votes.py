"""Thesis 5.4.4: votes of arcs for centre bins, and the relationship score."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core.ecc import _kernels_votes as kernels
from geoprim_core.ecc.arcs import Arcs
from geoprim_core.ecc.grouping_params import GroupingParams


@dataclass(frozen=True, slots=True, eq=False)
class Votes:
    """Votes of arcs for bins, one entry a pair of them, and the bins' grid.

    Attributes
    ----------
    arc, bin, count : (V,) int64
        Arc e, bin b (row by row) and S_e^b, ordered by bin, then from strong to weak.
    score : (V,) float64
        The relationship score of the pair.
    valid : (K,) int64
        S_e, the number of sets of each arc that gave a centre inside the grid.
    origin : (2,) float64
        The grid's corner (x, y) in pixels.
    columns, rows : int
        Size of the grid in bins.
    bin_size : float
        Side of a bin in pixels.
    """

    arc: IntArray
    bin: IntArray
    count: IntArray
    score: FloatArray
    valid: IntArray
    origin: FloatArray
    columns: int
    rows: int
    bin_size: float

    def totals(self) -> FloatArray:
        """Return the total score (rows, columns) of every bin."""
        total = np.bincount(self.bin, self.score, self.columns * self.rows)
        return np.asarray(total, np.float64).reshape(self.rows, self.columns)

    def strong_bins(self, share: float) -> BoolArray:
        """Return the mask (rows * columns,) of bins with at least a share of the best score."""
        total = self.totals().ravel()
        return np.asarray((total > 0) & (total >= share * total.max(initial=0.0)))

    def bin_centres(self) -> FloatArray:
        """Return the centres (rows * columns, 2) of all bins in pixels."""
        y, x = np.divmod(np.arange(self.columns * self.rows), self.columns)
        centres: FloatArray = self.origin + (np.stack([x, y], axis=1) + 0.5) * self.bin_size
        return centres


def bin_trust(share: npt.ArrayLike) -> FloatArray:
    """Return r_1 of the share S_e^b / S_e of an arc's votes that a bin got, (5-6)."""
    x = np.asarray(share, np.float64)
    return np.asarray(x * np.exp(x - 1))


def arc_trust(share: npt.ArrayLike) -> FloatArray:
    """Return r_2 of the share S_e / S of an arc's sets that gave a centre, (5-7)."""
    x = np.asarray(share, np.float64)
    return np.asarray(x * np.exp(2 * (x - 1)))


def relationship_score(count: IntArray, valid: IntArray, sets: int) -> FloatArray:
    """Return r_e^b of votes S_e^b from arcs with S_e valid ones of S sets, (5-5)."""
    return np.asarray(count * bin_trust(count / valid) * arc_trust(valid / sets))


def cast_votes(arcs: Arcs, centres: FloatArray, scheme: str, params: GroupingParams) -> Votes:
    """Count the centres (K, S, 2) of every arc in bins and score every pair of arc and bin.

    Scheme "1" scores with the plain count (5-4), the others with the relationship score (5-5).

    References
    ----------
    Thesis 5.4.3 (bins), 5.4.4, (5-4) to (5-7), 5.6.3 (schemes).
    """
    origin, columns, rows = _grid(arcs, params.bin_size)
    table, valid = kernels.count_votes(
        centres, origin[0], origin[1], params.bin_size, columns, rows
    )
    arc, bins, count = table.T
    score = count.astype(np.float64)
    if scheme != "1":
        score = relationship_score(count, valid[arc], params.sets)
    order = np.lexsort((arc, -score, bins))
    return Votes(
        arc[order],
        bins[order],
        count[order],
        score[order],
        valid,
        origin,
        columns,
        rows,
        params.bin_size,
    )


def find_meeting_arcs(votes: Votes, params: GroupingParams) -> BoolArray:
    """Return the matrix (K, K) of the pairs of arcs that may be grouped: a bin has both.

    Only these pairs need to be looked at for search region and convexity.
    """
    return kernels.meeting_pairs(
        votes.arc,
        votes.bin,
        votes.strong_bins(params.min_bin_score),
        params.max_group,
        len(votes.valid),
    )


def _grid(arcs: Arcs, bin_size: float) -> tuple[FloatArray, int, int]:
    low, size = np.zeros(2), np.ones(2)
    if arcs.image_size is not None:
        size = np.array(arcs.image_size, np.float64)
    elif len(arcs.points):
        low = np.floor(arcs.points.min(axis=0))
        size = arcs.points.max(axis=0) - low + 1
    columns, rows = (math.ceil(side / bin_size) for side in size)
    return low - 0.5, columns, rows
