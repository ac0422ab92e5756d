"""Thesis 5.5: similar hypotheses, saliency criteria, selection."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.ecc import Arcs, SaliencyParams
from geoprim_core.ecc.hypotheses import Hypotheses
from geoprim_core.ecc.saliency import (
    Saliency,
    alignment_ratio,
    circumference_ratio,
    continuity_ratio,
    score_saliency,
)
from geoprim_core.ecc.selection import select_salient
from geoprim_core.ecc.similarity import merge_similar
from geoprim_core.ecc.tangents import ArcTangents
from geoprim_core.fitting import overlap_matrix
from geoprim_core.types import Ellipses

PARAMS = SaliencyParams()
CIRCLE = (50.0, 40.0, 30.0, 30.0, 0.0)


def pieces(*spans, radius=30.0, closed=False):
    """Exact pieces of a circle about (50, 40), degrees, with their exact tangents."""
    angles = [np.deg2rad(np.linspace(a, b, 181)[: -1 if closed else None]) for a, b in spans]
    points = [np.stack([50 + radius * np.cos(t), 40 + radius * np.sin(t)], axis=1) for t in angles]
    offsets = np.concatenate([[0], np.cumsum([len(p) for p in points])]).astype(np.int64)
    flat = np.concatenate(points)
    count = len(spans)
    arcs = Arcs(flat, offsets, np.arange(count), np.full(count, closed), np.arange(len(flat)))
    tangent = np.concatenate(angles) + np.pi / 2
    ends = np.stack([tangent[offsets[:-1]], tangent[offsets[1:] - 1]], axis=1)
    return arcs, ArcTangents(tangent, ends)


def hypotheses(ellipses, groups):
    offsets = np.concatenate([[0], np.cumsum([len(g) for g in groups])]).astype(np.int64)
    count = len(groups)
    members = np.concatenate(groups).astype(np.int64)
    rows = np.array(ellipses, float).reshape(-1, 5)
    return Hypotheses(rows, np.zeros(count), np.zeros(count, int), members, offsets)


def test_a_whole_ellipse_by_one_arc_has_the_best_saliency():
    arcs, tangents = pieces((0, 360), closed=True)
    found = score_saliency(arcs, tangents, hypotheses([CIRCLE], [[0]]), PARAMS)
    assert found.circumference == pytest.approx([1])
    assert found.alignment == pytest.approx([1])
    assert found.continuity == pytest.approx([1])
    assert found.product == pytest.approx([1])
    assert found.mean == pytest.approx([1])


@settings(max_examples=20, deadline=None)
@given(st.floats(0, 360), st.floats(5, 359))
def test_circumference_is_the_share_of_the_turn_that_arcs_subtend(start, width):
    arcs, _ = pieces((start, start + width))
    ratio = circumference_ratio(arcs, hypotheses([CIRCLE], [[0]]))
    assert ratio == pytest.approx([width / 360])


def test_circumferences_of_a_group_add_up_to_at_most_a_turn():
    arcs, _ = pieces((0, 90), (180, 225), (0, 300))
    groups = hypotheses([CIRCLE] * 2, [[0, 1], [0, 1, 2]])
    assert circumference_ratio(arcs, groups) == pytest.approx([0.375, 1])


def test_continuity_is_one_for_arcs_that_run_into_each_other():
    arcs, tangents = pieces((0, 180), (180, 350))
    ratio = continuity_ratio(arcs, tangents, hypotheses([CIRCLE], [[0, 1]]))
    assert ratio == pytest.approx([1])


@pytest.mark.parametrize("gap", [30, 90, 150])
def test_continuity_falls_with_the_turn_in_the_gap(gap):
    """theta_diff is pi less the turn; the wider gap of the two is not counted."""
    arcs, tangents = pieces((0, 90), (90 + gap, 180 + gap))
    ratio = continuity_ratio(arcs, tangents, hypotheses([CIRCLE], [[1, 0]]))
    assert ratio == pytest.approx([1 - min(gap, 180 - gap) / 180])


def test_continuity_does_not_depend_on_direction_or_rank():
    arcs, tangents = pieces((0, 90), (100, 150), (300, 200))  # the last one runs backwards
    ends = tangents.ends.copy()
    ends[2] += np.pi
    groups = hypotheses([CIRCLE] * 2, [[0, 1, 2], [2, 0, 1]])
    ratio = continuity_ratio(arcs, ArcTangents(tangents.angle, ends), groups)
    assert ratio == pytest.approx([1 - (10 + 50) / 2 / 180] * 2)


@pytest.mark.parametrize(("radius", "expected"), [(31.9, 1), (32.1, 0), (28.1, 1), (27.9, 0)])
def test_a_pixel_is_aligned_within_two_pixels(radius, expected):
    arcs, _ = pieces((0, 200), radius=radius)
    assert alignment_ratio(arcs, hypotheses([CIRCLE], [[0]]), PARAMS) == pytest.approx([expected])


def test_of_similar_ellipses_the_one_with_most_circumference_stays():
    arcs, _ = pieces((0, 100), (0, 250), (0, 40))
    near = (50.3, 40.0, 30.2, 30.0, 0.3)
    far = (70.0, 40.0, 30.0, 30.0, 0.0)
    found = merge_similar(arcs, hypotheses([CIRCLE, near, far], [[0], [1], [2]]), PARAMS)
    assert found.ellipses.tolist() == [list(near), list(far)]
    assert [found.group(i).tolist() for i in range(2)] == [[1], [2]]


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000), st.sampled_from([0.5, 0.8, 0.9]))
def test_clustering_equals_the_plain_greedy_rule(seed, threshold):
    """The bounds that spare overlaps change nothing."""
    rng = np.random.default_rng(seed)
    a = rng.uniform(20, 30, 40)
    rows = np.stack(
        [*rng.normal(40, 3, (2, 40)), a, a * rng.uniform(0.6, 1, 40), rng.uniform(0, 3.1, 40)],
        axis=1,
    )
    arcs, _ = pieces((0, 100))
    groups = hypotheses(rows, [[0]] * 40)
    circumference = circumference_ratio(arcs, groups)
    overlap = overlap_matrix(Ellipses.from_array(rows), Ellipses.from_array(rows))
    kept = []
    for i in np.argsort(-circumference, kind="stable"):
        if all(overlap[i, k] <= threshold for k in kept):
            kept.append(i)
    found = merge_similar(arcs, groups, SaliencyParams(min_similarity=threshold))
    assert np.array_equal(found.ellipses, rows[kept])


#                  c    a    phi
TABLE = np.array([[0.9, 0.9, 0.9], [0.8, 0.2, 1.0], [0.1, 0.8, 0.8], [0.6, 0.7, 0.9]])


def test_selection_takes_what_is_at_least_average_in_everything():
    """(5-16): the averages are 0.6, 0.65, 0.9 and 0.7167; the last row's sigma_add is 0.7333."""
    assert select_salient(Saliency(*TABLE.T)).tolist() == [True, False, False, True]


def test_thresholds_on_the_net_saliencies():
    """sigma_mul: 0.729, 0.16, 0.064, 0.378; sigma_add: 0.9, 0.667, 0.567, 0.733."""
    saliency = Saliency(*TABLE.T)
    product = SaliencyParams(selection="multiplicative", selection_threshold=0.5)
    assert select_salient(saliency, product).tolist() == [True, False, False, True]
    total = SaliencyParams(selection="additive", selection_threshold=0.7)
    assert select_salient(saliency, total).tolist() == [True, True, False, True]


@given(st.floats(0.01, 1), st.integers(1, 30))
def test_equal_hypotheses_are_all_selected(value, count):
    """The rounding of the average may not cost any of them."""
    assert select_salient(Saliency(*np.full((3, count), value))).all()


def test_nothing_is_selected_of_nothing():
    none = Saliency(*np.zeros((3, 0)))
    for rule in ("average", "multiplicative", "additive"):
        assert len(select_salient(none, SaliencyParams(selection=rule))) == 0
