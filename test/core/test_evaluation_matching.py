"""Matching is one to one, symmetric and the best possible; scores follow from its counts."""

from __future__ import annotations

import math
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError
from geoprim_core.evaluation import UNMATCHED, Score, match_ellipses, pool
from geoprim_core.fitting.overlap import overlap_matrix
from geoprim_core.types import Ellipses

# Crowded on purpose: most ellipses have several partners to choose from.
ROWS = st.tuples(
    st.floats(0, 8), st.floats(0, 8), st.floats(14, 20), st.floats(10, 14), st.floats(0, 3.1)
)
SETS = st.lists(ROWS, max_size=5).map(lambda rows: Ellipses.from_array(np.reshape(rows, (-1, 5))))
EXAMPLES = settings(max_examples=40, deadline=None)


def discs(*x):
    return Ellipses(x, np.zeros(len(x)), *np.full((2, len(x)), 20.0), np.zeros(len(x)))


@EXAMPLES
@given(SETS, SETS)
def test_every_ellipse_has_one_partner_at_most_and_pairs_reach_the_overlap(found, truth):
    matching = match_ellipses(found, truth)
    partners = matching.truth_of[matching.truth_of != UNMATCHED]
    assert len(set(partners.tolist())) == len(partners)
    ratios = overlap_matrix(found, truth)
    for k in np.flatnonzero(matching.hit):
        assert matching.overlap[k] == ratios[k, matching.truth_of[k]] >= 0.8
    assert (matching.overlap[matching.false] == 0).all()
    assert matching.missed.sum() == len(truth) - len(partners)


@EXAMPLES
@given(SETS, SETS)
def test_found_and_truth_may_be_exchanged(found, truth):
    one, other = match_ellipses(found, truth).score(), match_ellipses(truth, found).score()
    assert one.hits == other.hits
    assert (one.misses, one.false) == (other.false, other.misses)


@EXAMPLES
@given(SETS)
def test_the_truth_itself_is_perfect(truth):
    score = match_ellipses(truth, truth, overlap=1.0).score()
    assert score == Score(len(truth), 0, 0)
    assert score.f_measure == 1


@EXAMPLES
@given(SETS, SETS, st.randoms(use_true_random=False))
def test_the_order_does_not_matter(found, truth, random):
    rows, columns = list(range(len(found))), list(range(len(truth)))
    random.shuffle(rows)
    random.shuffle(columns)
    mixed = match_ellipses(found.select(np.array(rows, int)), truth.select(np.array(columns, int)))
    plain = match_ellipses(found, truth)
    assert mixed.score() == plain.score()
    assert mixed.overlap.sum() == pytest.approx(plain.overlap.sum(), abs=1e-9)


@EXAMPLES
@given(SETS, SETS)
def test_no_matching_has_more_pairs_or_as_many_better_ones(found, truth):
    ratios = overlap_matrix(found, truth)
    if len(found) > len(truth):
        ratios = ratios.T
    best = (0, 0.0)
    for columns in permutations(range(ratios.shape[1]), ratios.shape[0]):
        pairs = ratios[np.arange(len(columns)), list(columns)]
        pairs = pairs[pairs >= 0.8 - 1e-9]
        best = max(best, (len(pairs), round(float(pairs.sum()), 9)))
    matching = match_ellipses(found, truth)
    assert (int(matching.hit.sum()), round(float(matching.overlap.sum()), 9)) == pytest.approx(best)


def test_two_pairs_are_better_than_the_single_best_pair():
    # taking the best pair first (0 with 1) would leave 3 and -2 apart
    matching = match_ellipses(discs(0, 3), discs(1, -2))
    assert matching.truth_of.tolist() == [1, 0]


def test_an_uncertain_ellipse_is_neither_hit_nor_miss():
    truth, flags = discs(0, 100), [False, True]
    assert match_ellipses(discs(0), truth, uncertain=flags).score() == Score(1, 0, 0)
    assert match_ellipses(discs(0, 100), truth, uncertain=flags).score() == Score(1, 0, 0)
    assert match_ellipses(discs(100), truth, uncertain=flags).score() == Score(0, 1, 0)
    matching = match_ellipses(discs(200, 100), truth, uncertain=flags)
    assert matching.dropped.tolist() == [False, True]
    assert matching.false.tolist() == [True, False]


def test_an_uncertain_ellipse_excuses_one_detection_only():
    matching = match_ellipses(discs(0, 1), discs(0), uncertain=[True])
    assert matching.score() == Score(0, 0, 1)


def test_a_certain_ellipse_is_preferred_to_a_nearer_uncertain_one():
    matching = match_ellipses(discs(0), discs(0, 2), uncertain=[True, False])
    assert matching.truth_of.tolist() == [1]
    assert matching.score() == Score(1, 0, 0)


def test_the_overlap_ratio_decides():
    # of concentric discs the ratio is that of the areas: 0.81
    inner = Ellipses([0], [0], [18], [18], [0])
    assert match_ellipses(inner, discs(0), overlap=0.80).score().hits == 1
    assert match_ellipses(inner, discs(0), overlap=0.82).score().hits == 0


def test_measures_of_the_thesis():
    score = Score(hits=8, misses=8, false=2)
    assert (score.precision, score.recall) == (0.8, 0.5)
    assert score.f_measure == pytest.approx(2 * 0.8 * 0.5 / 1.3)


@pytest.mark.parametrize(
    ("score", "measures"),
    [
        (Score(0, 0, 0), (math.nan, math.nan, 1.0)),
        (Score(0, 3, 0), (math.nan, 0.0, 0.0)),
        (Score(0, 0, 3), (0.0, math.nan, 0.0)),
        (Score(0, 3, 3), (0.0, 0.0, 0.0)),
        (Score(3, 0, 0), (1.0, 1.0, 1.0)),
    ],
)
def test_a_share_of_nothing_is_undefined_and_f_follows_from_the_counts(score, measures):
    found = (score.precision, score.recall, score.f_measure)
    assert found == pytest.approx(measures, abs=0, nan_ok=True)


def test_recall_only_counts_no_false_detections():
    score = match_ellipses(discs(0, 100), discs(0, 200)).score(recall_only=True)
    assert score == Score(1, 1, None)
    assert score.recall == 0.5
    assert math.isnan(score.precision)
    assert math.isnan(score.f_measure)


def test_pooling_adds_counts():
    assert pool([Score(1, 2, 3), Score(4, 5, 6)]) == Score(5, 7, 9)
    assert pool([Score(1, 2, None), Score(4, 5, None)]) == Score(5, 7, None)
    assert pool([]) == Score(0, 0, 0)
    with pytest.raises(InputError):
        pool([Score(1, 2, 3), Score(4, 5, None)])


@pytest.mark.parametrize(
    "call",
    [
        lambda: match_ellipses(discs(0), discs(0), overlap=0.0),
        lambda: match_ellipses(discs(0), discs(0), overlap=1.5),
        lambda: match_ellipses(discs(0), discs(0), uncertain=[True, False]),
        lambda: match_ellipses(discs(0), discs(0), uncertain=[3]),
        lambda: Score(-1, 0, 0),
    ],
)
def test_wrong_arguments_are_refused(call):
    with pytest.raises(InputError):
        call()
