"""Precision, recall and F-measure."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from geoprim_core.errors import InputError

UNDEFINED = "-"
"""What stands in a table for a measure that is undefined."""


@dataclass(frozen=True, slots=True)
class Score:
    """Counts of a comparison with the truth, and the measures made from them.

    A share of nothing is undefined: where nothing was found, precision is NaN; where nothing was
    to be found, recall is NaN. The F-measure 2 hits / (found + actual) is 0 where either is empty,
    and 1 where both are: nothing was to be found, and nothing was.

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
    >>> silent = Score(hits=0, misses=8, false=0)
    >>> silent.precision, silent.recall, silent.f_measure
    (nan, 0.0, 0.0)
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
        """Share of the detections that are true, (5-17); NaN without detections."""
        if self.false is None:
            return math.nan
        return self.hits / self.found if self.found else math.nan

    @property
    def recall(self) -> float:
        """Share of the true ellipses that were found, (5-18); NaN without true ellipses."""
        return self.hits / self.actual if self.actual else math.nan

    @property
    def f_measure(self) -> float:
        """Harmonic mean of precision and recall, (5-19)."""
        if self.false is None:
            return math.nan
        both = self.found + self.actual
        return 2 * self.hits / both if both else 1.0

    @property
    def merit(self) -> float:
        """The F-measure, or recall where only that is known."""
        return self.recall if self.false is None else self.f_measure


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


def mean_measures(scores: Iterable[Score]) -> tuple[float, float, float]:
    """Return the mean precision, recall and F-measure over the images where each is defined.

    A measure that no image has is NaN.

    Examples
    --------
    >>> mean_measures([Score(1, 0, 1), Score(0, 1, 0)])  # of the second nothing was found
    (0.5, 0.5, 0.3333333333333333)
    """
    each = tuple(scores)
    return (
        _mean(score.precision for score in each),
        _mean(score.recall for score in each),
        _mean(score.f_measure for score in each),
    )


def _mean(values: Iterable[float]) -> float:
    known = [value for value in values if not math.isnan(value)]
    return math.fsum(known) / len(known) if known else math.nan


def measure_text(value: float, digits: int = 3) -> str:
    """Return a number as it stands in a table: a dash where it is undefined.

    Examples
    --------
    >>> measure_text(2 / 3), measure_text(math.nan)
    ('0.667', '-')
    """
    return UNDEFINED if math.isnan(value) else f"{value:.{digits}f}"
