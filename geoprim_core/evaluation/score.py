"""Precision, recall and F-measure."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from geoprim_core.errors import InputError


@dataclass(frozen=True, slots=True)
class Score:
    """Counts of a comparison with the truth, and the measures made from them.

    Where nothing was found, no claim was wrong: precision is 1. Where nothing was to be found,
    nothing was missed: recall is 1. The F-measure then follows from the counts alike.

    Attributes
    ----------
    hits : int
        Detections that are a true ellipse.
    misses : int
        True ellipses that were not found.
    false : int or None
        Detections that are no true ellipse. None where they cannot be told, because not all true
        ellipses are known (recall-only images): precision and F-measure are NaN then.

    Raises
    ------
    InputError
        A count is negative.

    References
    ----------
    Thesis (5-17), (5-18), (5-19).

    Examples
    --------
    >>> score = Score(hits=6, misses=2, false=4)
    >>> score.precision, score.recall, round(score.f_measure, 4)
    (0.6, 0.75, 0.6667)
    """

    hits: int
    misses: int
    false: int | None

    def __post_init__(self) -> None:
        if min(self.hits, self.misses, self.false or 0) < 0:
            raise InputError("score", "counts of at least 0", f"{self}")

    @property
    def found(self) -> int:
        """Number of detections that count."""
        return self.hits + (self.false or 0)

    @property
    def actual(self) -> int:
        """Number of true ellipses that count."""
        return self.hits + self.misses

    @property
    def precision(self) -> float:
        """Share of the detections that are true, (5-17)."""
        if self.false is None:
            return math.nan
        return self.hits / self.found if self.found else 1.0

    @property
    def recall(self) -> float:
        """Share of the true ellipses that were found, (5-18)."""
        return self.hits / self.actual if self.actual else 1.0

    @property
    def f_measure(self) -> float:
        """Harmonic mean of precision and recall, (5-19)."""
        if self.false is None:
            return math.nan
        both = self.found + self.actual
        return 2 * self.hits / both if both else 1.0


def pool(scores: Iterable[Score]) -> Score:
    """Add the counts of many images.

    Raises
    ------
    InputError
        Some scores count false detections and some do not.

    Examples
    --------
    >>> pool([Score(1, 1, 0), Score(3, 0, 2)])
    Score(hits=4, misses=1, false=2)
    """
    each = tuple(scores)
    known = [score.false for score in each if score.false is not None]
    if known and len(known) < len(each):
        raise InputError("scores", "scores that all count false detections or all do not", "both")
    hits, misses = sum(s.hits for s in each), sum(s.misses for s in each)
    return Score(hits, misses, sum(known) if known or not each else None)
