"""Scores against the share of right detections, on made-up samples whose truth is known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.ecc import DetectorParams, detect_ellipses
from geoprim_core.ecc.refined.score import SCORE_MAP, ScoreMap
from geoprim_core.errors import InputError
from geoprim_core.evaluation import (
    GroundTruth,
    ScoredDetections,
    collect_scores,
    cross_scores,
    fit_score,
    measure_reliability,
    reliability_table,
)
from geoprim_core.synthetic import assorted_scenes
from geoprim_core.types import EllipseDetections, Ellipses

steps = st.lists(st.floats(0.05, 5.0), min_size=2, max_size=6)


def rising(first, gaps):
    return first + np.cumsum(np.append(0.0, gaps))


@given(steps, st.floats(-5, 5), st.floats(-5, 5), st.randoms())
def test_a_score_map_rises_and_can_be_read_backwards(gaps, evidence, odds, random):
    heights = [random.uniform(0.1, 3.0) for _ in gaps]
    made = ScoreMap(rising(evidence, gaps), rising(odds, heights))
    values = np.linspace(evidence - 3, evidence + sum(gaps) + 3, 50)
    scores = made.probability(values)
    assert np.all((scores > 0) & (scores < 1))
    assert np.all(np.diff(scores) >= 0)
    told = scores < 1 - 1e-9
    back = np.array([made.evidence_of(score) for score in scores[told]])
    assert np.allclose(back, values[told], atol=1e-3)


def test_no_score_is_certain_and_only_certainty_needs_infinite_evidence():
    assert SCORE_MAP.probability(np.array([1e6]))[0] < 1
    assert SCORE_MAP.probability(np.array([-1e6]))[0] >= 0
    assert (SCORE_MAP.evidence_of(0.0), SCORE_MAP.evidence_of(1.0)) == (-np.inf, np.inf)


@pytest.mark.parametrize(
    ("evidence", "odds"), [([0.0], [0.0]), ([0.0, 1.0], [1.0, 1.0]), ([1.0, 0.0], [0.0, 1.0])]
)
def test_a_score_map_that_does_not_rise_is_refused(evidence, odds):
    with pytest.raises(InputError, match="rising"):
        ScoreMap(evidence, odds)


def samples_of(probability, seed=0, group="a", score=None):
    """Return detections that are right with a probability each, with that score or another."""
    right = np.random.default_rng(seed).random(len(probability)) < probability
    names = (group,) * len(probability)
    images = tuple(str(k % 20) for k in range(len(probability)))
    return ScoredDetections(probability if score is None else score, right, names, images)


def test_scores_that_are_probabilities_have_no_calibration_error():
    probability = np.random.default_rng(1).uniform(0, 1, 20000)
    measured = measure_reliability(samples_of(probability))
    # Ten bins of 2000: the mean of |normal| errors of sqrt(p (1 - p) / 2000) is below 0.01.
    assert measured.error < 0.015
    assert measured.brier == pytest.approx(np.mean(probability * (1 - probability)), abs=0.01)
    assert measured.count.sum() == 20000


def test_the_calibration_error_is_what_the_scores_are_off():
    probability = np.full(5000, 0.6)
    measured = measure_reliability(samples_of(probability, score=np.full(5000, 0.9)))
    assert measured.error == pytest.approx(0.3, abs=0.03)
    assert np.flatnonzero(measured.count).tolist() == [9]


def test_extreme_scores_fall_into_the_outer_bins():
    measured = measure_reliability(
        ScoredDetections([0.0, 1.0], [False, True], ("",) * 2, ("",) * 2)
    )
    assert measured.count[[0, -1]].tolist() == [1, 1]
    assert (measured.error, measured.brier) == (0, 0)


def discs(*places):
    count = len(places)
    full = np.ones(count)
    return Ellipses(np.array(places, float), 50 * full, 20 * full, 20 * full, 0 * full)


def detected(*places):
    full = np.full(len(places), 0.9)
    return EllipseDetections(
        discs(*places), full, full, full, full, np.full((len(places), 5, 5), np.nan)
    )


def test_of_two_detections_of_one_ellipse_one_is_right():
    samples = collect_scores([(detected(50, 51, 200), GroundTruth("a", discs(50)))])
    assert samples.right.tolist() == [True, False, False]


def test_uncertain_ellipses_and_recall_only_images_do_not_count():
    uncertain = GroundTruth("a", discs(50, 200), np.array([False, True]))
    partly = GroundTruth("b", discs(50), recall_only=True)
    samples = collect_scores([(detected(50, 200, 400), uncertain), (detected(50, 300), partly)])
    assert samples.right.tolist() == [True, False]
    assert samples.images == ("a", "a")


def true_map():
    return ScoreMap(SCORE_MAP.evidence, SCORE_MAP.log_odds * 0.7 - 0.8)


def test_the_fit_finds_the_map_that_the_truth_was_drawn_from():
    evidence = np.random.default_rng(4).uniform(-6, 7, 8000)
    told = SCORE_MAP.probability(evidence)
    samples = samples_of(true_map().probability(evidence), score=told)
    fitted = fit_score(samples)
    assert np.allclose(fitted.probability(evidence), true_map().probability(evidence), atol=0.04)
    before = measure_reliability(samples).error
    after = measure_reliability(samples.rescored(fitted.probability(evidence))).error
    assert after < 0.02 < before


def test_a_set_weighs_the_same_however_many_images_it_has():
    evidence = np.random.default_rng(5).uniform(-6, 7, 600)
    told = SCORE_MAP.probability(evidence)
    easy, hard = samples_of(told, 1, "easy"), samples_of(0.5 * told, 2, "hard", told)
    once, often = fit_score(easy + hard), fit_score(easy + easy + easy + hard)
    assert np.allclose(once.log_odds, often.log_odds, atol=0.01)


def test_an_image_does_not_vote_on_its_own_scores():
    evidence = np.random.default_rng(6).uniform(-6, 7, 400)
    told = SCORE_MAP.probability(evidence)
    samples = samples_of(told)
    first = np.array([name == "0" for name in samples.images])
    turned = ScoredDetections(told, samples.right ^ first, samples.groups, samples.images)
    one, other = cross_scores(samples, "a"), cross_scores(turned, "a")
    assert np.allclose(one.score[first], other.score[first])
    assert not np.allclose(one.score[~first], other.score[~first])


def test_detections_of_one_kind_cannot_be_fitted():
    with pytest.raises(InputError, match="right and wrong"):
        fit_score(ScoredDetections([0.5, 0.6], [True, True], ("",) * 2, ("",) * 2))


@pytest.fixture(scope="module")
def assorted():
    params = DetectorParams().updated({"ecc.refined.min_score": 0.0})
    return collect_scores(
        (
            detect_ellipses(scene.image, params),
            GroundTruth("", scene.ellipses, ~scene.required, group=name),
        )
        for name, scene in assorted_scenes(1, seed=11)
    )


def test_scores_of_rendered_scenes_are_probabilities(assorted):
    """The issue asks for an error of 0.08 at most, pooled and on every set of enough detections."""
    assert len(assorted) > 500
    assert (assorted.score < 0.5).sum() > 30
    assert measure_reliability(assorted).error < 0.08
    assert reliability_table(assorted).count("\n") == 14


@settings(max_examples=5, deadline=None)
@given(st.floats(0.1, 0.95))
def test_the_least_score_is_a_limit_on_the_score(least):
    scene = next(scene for _, scene in assorted_scenes(1, seed=3))
    params = DetectorParams().updated({"ecc.refined.min_score": least})
    assert np.all(detect_ellipses(scene.image, params).score >= least - 1e-12)
