"""Last step of the `refined` scheme: from evidence to the probability that an ellipse is right."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from geoprim_core import _check
from geoprim_core._check import FloatArray
from geoprim_core.ecc.refined._kernels_score import line_through
from geoprim_core.errors import InputError

MOST_LOG_ODDS = 30.0
"""Beyond, a probability is told from one no longer."""
LEAST_LOG_ODDS = -700.0
"""Beyond, it is no number in double precision."""


@dataclass(frozen=True, slots=True, eq=False)
class ScoreMap:
    """A rising, piecewise linear map from evidence to log odds.

    Evidence is the sum of weighted figures that orders the ellipses; the map makes it a
    probability that is met as often as it says. It goes on straight beyond its first and last
    knots.

    Attributes
    ----------
    evidence : (k,) float64
        The knots, rising, k >= 2.
    log_odds : (k,) float64
        Log odds of being right at the knots, rising.

    Raises
    ------
    InputError
        Fewer than two knots, or numbers that do not rise.

    References
    ----------
    Platt, Probabilistic outputs for support vector machines (1999), with several pieces.

    Examples
    --------
    >>> steps = ScoreMap([0.0, 2.0], [-1.0, 1.0])
    >>> steps.probability(np.array([1.0, 3.0])).round(3).tolist()
    [0.5, 0.881]
    >>> round(steps.evidence_of(0.5), 6)
    1.0
    """

    evidence: FloatArray
    log_odds: FloatArray

    def __post_init__(self) -> None:
        evidence = _check.finite(self.evidence, "evidence", (None,))
        log_odds = _check.finite(self.log_odds, "log_odds", evidence.shape)
        if len(evidence) < 2 or min(np.diff(evidence).min(), np.diff(log_odds).min()) <= 0.0:
            raise InputError("evidence, log_odds", "two knots or more, rising", f"{self}")
        object.__setattr__(self, "evidence", evidence)
        object.__setattr__(self, "log_odds", log_odds)

    def probability(self, evidence: FloatArray) -> FloatArray:
        """Return the probability (n,) in [0, 1] for evidence (n,)."""
        odds = line_through(
            _row(evidence), self.evidence, self.log_odds, LEAST_LOG_ODDS, MOST_LOG_ODDS
        )
        result: FloatArray = 1.0 / (1.0 + np.exp(-odds))
        return result

    def log_odds_of(self, evidence: FloatArray) -> FloatArray:
        """Return the log odds (n,) for evidence (n,)."""
        return line_through(_row(evidence), self.evidence, self.log_odds, -np.inf, np.inf)

    def evidence_at(self, log_odds: FloatArray) -> FloatArray:
        """Return the evidence (n,) that has log odds (n,)."""
        return line_through(_row(log_odds), self.log_odds, self.evidence, -np.inf, np.inf)

    def evidence_of(self, probability: float) -> float:
        """Return the evidence that has a probability, infinite at 0 and 1."""
        return _evidence_of(self, probability)


@lru_cache(maxsize=64)
def _evidence_of(score_map: ScoreMap, probability: float) -> float:
    """Return `ScoreMap.evidence_of`, kept: each image asks for the same few several times."""
    if probability <= 0.0 or probability >= 1.0:
        return np.inf if probability >= 1.0 else -np.inf
    odds = np.array([np.log(probability / (1.0 - probability))])
    return float(line_through(odds, score_map.log_odds, score_map.evidence, -np.inf, np.inf)[0])


def _row(values: FloatArray) -> FloatArray:
    return np.ascontiguousarray(values, float)


# Fitted by `geoprim calibrate FOLDER --fit --scenes 8 --seed 1000 --singles 0` on rendered scenes
# and a folder of photographs with ground truth; to be fitted anew when the evidence changes.
SCORE_MAP = ScoreMap(
    np.array([-5.0, -1.0, 2.0, 6.0]),
    np.array([-2.09, 0.21, 3.04, 5.5]),
)
"""The map that the `refined` scheme uses."""
