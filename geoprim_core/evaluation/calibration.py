"""Whether a score is the probability that a detection is right, and how to make it one."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize

from geoprim_core import _check
from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core.ecc.refined.score import SCORE_MAP, ScoreMap
from geoprim_core.errors import InputError
from geoprim_core.evaluation.ground_truth import GroundTruth
from geoprim_core.evaluation.matching import match_ellipses
from geoprim_core.types import EllipseDetections

BINS = 10
"""Bins of equal width of a reliability diagram."""

_STIFFNESS = 1.0
_WEIGHT_OF_A_GROUP = 100.0


@dataclass(frozen=True, slots=True, eq=False)
class ScoredDetections:
    """n detections, each right or wrong.

    Attributes
    ----------
    score : (n,) float64
        In [0, 1].
    right : (n,) bool
        True where the detection is a true ellipse.
    groups, images : n texts
        The set and the image that each belongs to.

    Raises
    ------
    InputError
        Columns of other lengths, or a score outside [0, 1].
    """

    score: FloatArray
    right: BoolArray
    groups: tuple[str, ...]
    images: tuple[str, ...]

    def __post_init__(self) -> None:
        score = _check.finite(self.score, "score", (None,))
        right = np.asarray(self.right, bool)
        lengths = {len(score), len(right), len(self.groups), len(self.images)}
        if len(lengths) > 1 or ((score < 0.0) | (score > 1.0)).any():
            raise InputError(
                "score, right, groups, images", "n each, scores in [0, 1]", f"{lengths}"
            )
        object.__setattr__(self, "score", score)
        object.__setattr__(self, "right", right)

    def __len__(self) -> int:
        """Return the number of detections."""
        return len(self.score)

    def __add__(self, other: ScoredDetections) -> ScoredDetections:
        """Return the detections of both."""
        return ScoredDetections(
            np.append(self.score, other.score),
            np.append(self.right, other.right),
            self.groups + other.groups,
            self.images + other.images,
        )

    def select(self, chosen: npt.ArrayLike) -> ScoredDetections:
        """Return the detections at indices or flags."""
        every = np.arange(len(self))[np.asarray(chosen)]
        groups, images = (tuple(names[k] for k in every) for names in (self.groups, self.images))
        return ScoredDetections(self.score[every], self.right[every], groups, images)

    def rescored(self, score: npt.ArrayLike) -> ScoredDetections:
        """Return the same detections with other scores (n,)."""
        return ScoredDetections(np.asarray(score), self.right, self.groups, self.images)

    def of_group(self, group: str) -> ScoredDetections:
        """Return the detections of one set."""
        return self.select(np.array([name == group for name in self.groups], bool))


@dataclass(frozen=True, slots=True, eq=False)
class Reliability:
    """What a reliability diagram shows.

    Attributes
    ----------
    edges : (BINS + 1,) float64
        Limits of the bins of the score, of equal width.
    count : (BINS,) int64
        Detections in each bin.
    score : (BINS,) float64
        Their mean score, NaN in an empty bin.
    right : (BINS,) float64
        Share of them that are right, NaN in an empty bin.
    brier : float
        Mean squared difference of the score and being right (1) or wrong (0).

    References
    ----------
    Guo, Pleiss, Sun and Weinberger, On calibration of modern neural networks (2017); Brier,
    Verification of forecasts expressed in terms of probability (1950).
    """

    edges: FloatArray
    count: IntArray
    score: FloatArray
    right: FloatArray
    brier: float

    @property
    def error(self) -> float:
        """Expected calibration error: mean over the detections of the bins' |score - right|."""
        total = int(self.count.sum())
        gaps = np.abs(self.score - self.right)[self.count > 0]
        return float(gaps @ self.count[self.count > 0] / total) if total else math.nan


def collect_scores(
    pairs: Iterable[tuple[EllipseDetections, GroundTruth]], *, overlap: float = 0.8
) -> ScoredDetections:
    """Tell of every detection of a sequence of images whether it is right.

    Detections are matched one to one. Images that are judged by recall only are left out, and so
    are detections that are uncertain ellipses.

    Raises
    ------
    InputError
        The overlap is out of range.

    Examples
    --------
    >>> from geoprim_core.types import Ellipses
    >>> disc = Ellipses([50], [50], [20], [20], [0])
    >>> one = np.ones(1)
    >>> found = EllipseDetections(disc, 0.9 * one, one, one, one, np.full((1, 5, 5), np.nan))
    >>> samples = collect_scores([(found, GroundTruth("frame", disc, group="discs"))])
    >>> samples.score.tolist(), samples.right.tolist(), samples.groups
    ([0.9], [True], ('discs',))
    """
    result = ScoredDetections(np.zeros(0), np.zeros(0, bool), (), ())
    for found, truth in pairs:
        matching = match_ellipses(
            found.ellipses, truth.ellipses, overlap=overlap, uncertain=truth.uncertain
        )
        if truth.recall_only:
            continue
        kept = ~matching.dropped
        count = int(kept.sum())
        names = ((truth.group,) * count, (truth.name,) * count)
        result += ScoredDetections(found.score[kept], matching.hit[kept], *names)
    return result


def measure_reliability(samples: ScoredDetections) -> Reliability:
    """Compare scores with the share of right detections, in bins of equal width.

    Examples
    --------
    >>> samples = ScoredDetections([0.75, 0.75, 0.1], [True, False, False], ("",) * 3, ("",) * 3)
    >>> reliability = measure_reliability(samples)
    >>> round(reliability.error, 3), round(reliability.brier, 3)
    (0.2, 0.212)
    """
    place = np.minimum((samples.score * BINS).astype(np.int64), BINS - 1)
    count = np.bincount(place, minlength=BINS)
    sums = [np.bincount(place, values, BINS) for values in (samples.score, samples.right)]
    with np.errstate(invalid="ignore"):
        score, right = sums[0] / count, sums[1] / count
    missed = (samples.score - samples.right) ** 2
    brier = float(missed.mean()) if len(samples) else math.nan
    return Reliability(np.linspace(0.0, 1.0, BINS + 1), count, score, right, brier)


def reliability_table(samples: ScoredDetections) -> str:
    """Return, as a Markdown table, how far the scores of each set are probabilities."""
    lines = [
        "| set | detections | right | mean score | calibration error | Brier score |",
        "|---|---:|---:|---:|---:|---:|",
    ]
    for group in dict.fromkeys(samples.groups):
        chosen = samples.of_group(group)
        measured = measure_reliability(chosen)
        figures = (chosen.right.mean(), chosen.score.mean(), measured.error, measured.brier)
        cells = " | ".join(f"{value:.3f}" for value in figures)
        lines.append(f"| {group} | {len(chosen)} | {cells} |")
    return "\n".join(lines)


def fit_score(
    samples: ScoredDetections,
    *,
    start: ScoreMap = SCORE_MAP,
    weights: dict[str, float] | None = None,
) -> ScoreMap:
    """Fit the map from evidence to probability to detections whose truth is known.

    Maximum likelihood of the log odds at the knots of `start`, the map that made the scores. Every
    set weighs the same, however many detections it holds. A slope that no detection tells of stays
    near that of `start`.

    Parameters
    ----------
    samples : ScoredDetections
        From detections with `min_score` 0, so that they cover the range.
    start : ScoreMap
    weights : group -> weight, or None
        Of sets that weigh other than 1.

    Raises
    ------
    InputError
        The samples are all right or all wrong.

    Examples
    --------
    >>> random = np.random.default_rng(0)
    >>> evidence = random.uniform(-6.0, 8.0, 4000)
    >>> right = random.random(4000) < 1 / (1 + np.exp(-evidence))
    >>> names = ("",) * 4000
    >>> samples = ScoredDetections(SCORE_MAP.probability(evidence), right, names, names)
    >>> fitted = fit_score(samples)
    >>> bool(np.abs(fitted.log_odds - fitted.evidence)[1:3].max() < 0.5)
    True
    """
    if samples.right.all() or not samples.right.any():
        raise InputError("samples", "right and wrong detections", f"{len(samples)} of one kind")
    evidence = np.array([start.evidence_of(score) for score in samples.score])
    evidence = np.clip(evidence, start.evidence[0] - 20.0, start.evidence[-1] + 20.0)
    each = _weights(samples, weights or {})
    sign = np.where(samples.right, -1.0, 1.0)
    steps = np.diff(start.log_odds)

    def loss(values: FloatArray) -> float:
        odds = ScoreMap(start.evidence, _rising(values)).log_odds_of(evidence)
        away = np.expm1(values[1:] - np.log(steps))
        return float(each @ np.logaddexp(0.0, sign * odds) + _STIFFNESS * away @ away)

    best = minimize(loss, np.append(start.log_odds[0], np.log(steps)), method="BFGS").x
    return ScoreMap(start.evidence, _rising(best))


def cross_scores(
    samples: ScoredDetections, group: str, *, weights: dict[str, float] | None = None
) -> ScoredDetections:
    """Return the detections of one set, each scored by a map fitted without its image.

    Raises
    ------
    InputError
        As `fit_score`.
    """
    evidence = np.array([SCORE_MAP.evidence_of(score) for score in samples.score])
    inside = np.array([name == group for name in samples.groups], bool)
    images = np.array(samples.images)
    score = samples.score.copy()
    for image in dict.fromkeys(images[inside]):
        left_out = inside & (images == image)
        fitted = fit_score(samples.select(~left_out), weights=weights)
        score[left_out] = fitted.probability(evidence[left_out])
    return samples.rescored(score).select(inside)


def _rising(values: FloatArray) -> FloatArray:
    """Return the log odds at the knots: the first, and logarithms of the steps."""
    result: FloatArray = values[0] + np.append(0.0, np.cumsum(np.exp(values[1:])))
    return result


def _weights(samples: ScoredDetections, weights: dict[str, float]) -> FloatArray:
    names, places, counts = np.unique(samples.groups, return_inverse=True, return_counts=True)
    each = np.array([weights.get(str(name), 1.0) for name in names])
    result: FloatArray = (_WEIGHT_OF_A_GROUP * each / counts)[places]
    return result
