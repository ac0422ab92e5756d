"""Which detection is which true ellipse: one to one, by the overlap ratio."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from geoprim_core import _check
from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core.errors import InputError
from geoprim_core.evaluation.score import Score
from geoprim_core.fitting.overlap import overlap_matrix
from geoprim_core.types import Ellipses

UNMATCHED = -1
"""Stands in `Matching.truth_of` for a detection without a partner."""


@dataclass(frozen=True, slots=True, eq=False)
class Matching:
    """The partners of n detections among m true ellipses.

    Attributes
    ----------
    truth_of : (n,) int64
        Index of the true ellipse that a detection is, or -1 (`UNMATCHED`).
    overlap : (n,) float64
        Overlap ratio with that ellipse; 0 where there is none.
    uncertain : (m,) bool
        True ellipses that count neither as hit nor as miss.
    """

    truth_of: IntArray
    overlap: FloatArray
    uncertain: BoolArray

    @property
    def hit(self) -> BoolArray:
        """Detections (n,) that are a certain true ellipse."""
        return self._partner_is(~self.uncertain)

    @property
    def dropped(self) -> BoolArray:
        """Detections (n,) that are an uncertain ellipse and therefore do not count."""
        return self._partner_is(self.uncertain)

    @property
    def false(self) -> BoolArray:
        """Detections (n,) without any partner."""
        unmatched: BoolArray = self.truth_of == UNMATCHED
        return unmatched

    @property
    def missed(self) -> BoolArray:
        """Certain true ellipses (m,) that no detection is."""
        missed = ~self.uncertain
        missed[self.truth_of[self.hit]] = False
        return missed

    def score(self, *, recall_only: bool = False) -> Score:
        """Count hits, misses and false detections; these are not counted for `recall_only`."""
        false = None if recall_only else int(self.false.sum())
        return Score(int(self.hit.sum()), int(self.missed.sum()), false)

    def _partner_is(self, chosen: BoolArray) -> BoolArray:
        flags: BoolArray = np.append(chosen, False)[self.truth_of]
        return flags


def match_ellipses(
    found: Ellipses,
    truth: Ellipses,
    *,
    overlap: float = 0.8,
    uncertain: npt.ArrayLike | None = None,
) -> Matching:
    """Match detections with true ellipses, one to one.

    Of all one-to-one matchings whose pairs reach the overlap ratio, take one with the most pairs
    and, among these, the largest sum of overlap ratios. Certain ellipses choose first; uncertain
    ones are matched with the detections that are left over.

    Parameters
    ----------
    found, truth : Ellipses
        n detections and m true ellipses in pixels.
    overlap : float
        Least overlap ratio of a pair, in (0, 1]: 0.95 for the thesis' synthetic images.
    uncertain : (m,) bool or None
        True ellipses that count neither as hit nor as miss; None: there are none.

    Returns
    -------
    Matching

    Raises
    ------
    InputError
        The overlap is out of range or there is not one flag a true ellipse.

    References
    ----------
    Thesis section 5.6.2. H. W. Kuhn, The Hungarian method for the assignment problem, 1955.

    Examples
    --------
    >>> truth = Ellipses.from_array([[50, 50, 20, 10, 0.0], [90, 50, 15, 15, 0.0]])
    >>> found = Ellipses.from_array([[90, 51, 15, 15, 0.0], [20, 20, 9, 9, 0.0]])
    >>> matching = match_ellipses(found, truth)
    >>> matching.truth_of.tolist(), matching.score()
    ([1, -1], Score(hits=1, misses=1, false=1))
    """
    if not 0 < overlap <= 1:
        raise InputError("overlap", "a ratio in (0, 1]", f"{overlap}")
    flags = _uncertain_flags(uncertain, len(truth))
    ratios = overlap_matrix(found, truth)
    truth_of = np.full(len(found), UNMATCHED)
    for group in (np.flatnonzero(~flags), np.flatnonzero(flags)):
        free = np.flatnonzero(truth_of == UNMATCHED)
        rows, columns = _assign(ratios[np.ix_(free, group)], overlap)
        truth_of[free[rows]] = group[columns]
    partner = np.append(ratios, np.zeros((len(found), 1)), axis=1)
    return Matching(truth_of, partner[np.arange(len(found)), truth_of], flags)


def _assign(ratios: FloatArray, least: float) -> tuple[IntArray, IntArray]:
    """Return rows and columns of the pairs: first as many, then as good as possible."""
    allowed = ratios >= least - 1e-9  # an equal ellipse has overlap 1 up to rounding
    bonus = 1.0 / (1.0 + min(ratios.shape)) if ratios.size else 0.0
    rows, columns = linear_sum_assignment(allowed * (1.0 + bonus * ratios), maximize=True)
    kept = allowed[rows, columns]
    return rows[kept], columns[kept]


def _uncertain_flags(uncertain: npt.ArrayLike | None, count: int) -> BoolArray:
    if uncertain is None:
        return np.zeros(count, bool)
    flags = np.asarray(uncertain)
    if flags.shape != (count,) or (flags.dtype != np.bool_ and count):
        raise InputError("uncertain", f"{count} flags, one a true ellipse", _check.describe(flags))
    return flags.astype(bool)
