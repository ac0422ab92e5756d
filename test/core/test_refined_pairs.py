"""The pairs of arcs of the `refined` scheme: every one that may be, none twice, within bounds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.ecc.refined import _kernels_batch as batch
from geoprim_core.ecc.refined import _kernels_fit as fit
from geoprim_core.ecc.refined import _kernels_order as order
from geoprim_core.ecc.refined import _kernels_pairs as pairs
from geoprim_core.ecc.refined import trace_refined
from geoprim_core.ecc.refined.arcs import gather_edges, split_arcs
from geoprim_core.ecc.refined.candidates import pair_arcs
from geoprim_core.ecc.refined.params import RefinedParams
from geoprim_core.types import Contours

FRAME = (900, 700)


def drawn_arcs(seed, count, frame=FRAME):
    """Return contours of random circular arcs, every third one a part of a common circle."""
    random = np.random.default_rng(seed)
    points, angles = [], []
    for k in range(count):
        if k % 3 == 0:
            centre, radius = random.uniform(-20, frame), np.exp(random.uniform(2.3, 5.5))
        start = random.uniform(0, 2 * np.pi)
        turn = random.uniform(max(13 / radius, 0.4), 2.5)
        t = np.arange(start, start + turn, 1 / radius)
        rim = np.stack([np.cos(t), np.sin(t)], axis=1)
        place = centre + radius * rim + random.normal(0, 0.1, rim.shape)
        inside = ((place >= 0) & (place <= np.array(frame) - 1)).all(axis=1)
        if inside.sum() > 12:
            points.append(place[inside])
            angles.append(t[inside])
    offsets = np.cumsum([0, *map(len, points)])
    whole = np.concatenate([np.zeros((0, 2)), *points])
    angle = np.concatenate([np.zeros(0), *angles])
    closed = np.zeros(len(points), bool)
    return Contours(np.rint(whole), offsets, closed, frame, whole, angle)


def arcs_of(contours, params):
    edges = gather_edges(contours, params)
    return edges, split_arcs(edges, contours, params)


def all_pairs(edges, arcs, params):
    """Return arcs -> (rank, ellipse) of all candidates, by trying every pair."""
    table, found = arcs.table, {}
    work, pair, row = np.empty(batch.WORK), np.empty((1, 2), np.int64), np.empty((1, 6))
    samples = batch.sample_arcs(edges.points, arcs.indices, arcs.offsets)
    signed, slack = edges.signed and params.same_polarity, params.region_slack
    rules = pairs.PairRules(
        slack,
        params.max_pair_rms,
        params.min_pair_share,
        params.max_size * edges.diagonal,
        signed,
        1,
    )
    for i in range(len(table)):
        for j in range(i, len(table)):
            a, b = table[i], table[j]
            if j > i:
                far = np.hypot(*(a[:2] - b[:2])) > 0.5 * (a[18] + b[18]) / params.min_pair_share
                if far or (signed and a[16] != b[16]):
                    continue
                if not (pairs.sees(a, b, slack) and pairs.sees(b, a, slack)):
                    continue
            other = j if j > i else -1
            both = np.array([[i], [other]])
            if batch.fit_pairs(samples, table, arcs.moments, both, 1, rules, work, pair, row):
                found[i, other] = tuple(row[0].tolist())
    return found


def as_dict(candidates):
    rows = np.column_stack([candidates.rank, candidates.ellipses]).tolist()
    return dict(zip(map(tuple, candidates.arcs.tolist()), map(tuple, rows), strict=True))


@settings(max_examples=25, deadline=None)
@given(
    st.integers(0, 2**32 - 1),
    st.integers(0, 60),
    st.sampled_from([0.05, 0.07, 0.3, 1.0]),
    st.sampled_from([0.0, 2.0, 30.0]),
    st.booleans(),
)
def test_the_candidates_are_those_of_trying_every_pair(seed, count, share, slack, polarity):
    params = RefinedParams(min_pair_share=share, region_slack=slack, same_polarity=polarity)
    edges, arcs = arcs_of(drawn_arcs(seed, count), params)
    found = pair_arcs(edges, arcs, params)
    assert found.complete
    assert found.share == share
    assert np.all(np.diff(found.rank) <= 0)
    assert as_dict(found) == all_pairs(edges, arcs, params)
    # One pair less than there are sends the search to the cells.
    cells = pair_arcs(
        edges, arcs, replace(params, max_pairs=max(1, len(arcs) * (len(arcs) - 1) // 2 - 1))
    )
    if cells.complete:
        assert as_dict(cells) == as_dict(found)
        assert cells.pairs <= found.pairs


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 3000))
def test_a_bound_keeps_the_pairs_that_can_make_up_most_of_an_ellipse(seed, most):
    params = RefinedParams()
    edges, arcs = arcs_of(drawn_arcs(seed, 80), params)
    free = as_dict(pair_arcs(edges, arcs, params))
    tied = pair_arcs(edges, arcs, RefinedParams(max_pairs=most))
    assert tied.pairs <= most
    kept = as_dict(tied)
    assert kept.items() <= free.items()
    left = free.keys() - kept.keys()
    if tied.complete:
        assert not left
    else:
        assert tied.share > params.min_pair_share
        assert tied.possible > most
    middle, length = arcs.table[:, :2], arcs.table[:, 18]
    for i, j in left:
        assert j >= 0  # single arcs are no pairs
        if tied.pairs < most:  # else even the nearest pairs were too many
            assert length[[i, j]].sum() < 2 * tied.share * np.hypot(*(middle[i] - middle[j]))


def test_the_work_does_not_grow_with_the_square_of_the_arcs():
    looked = []
    for count in (500, 1000, 2000, 4000):
        side = int(40 * np.sqrt(count))  # as crowded as before
        edges, arcs = arcs_of(drawn_arcs(1, count, (side, side)), RefinedParams())
        params = RefinedParams(min_pair_share=0.4)
        looked.append(pair_arcs(edges, arcs, params).pairs / len(arcs))
    assert max(looked) < 2 * min(looked)  # all pairs: 8 times


@pytest.mark.parametrize("most", [1, 10, 100])
def test_a_ring_in_four_arcs_is_found_within_few_pairs(most):
    t = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    ring = np.stack([100 + 60 * np.cos(t), 90 + 60 * np.sin(t)], axis=1)
    points = np.concatenate([ring[k + 5 : k + 95] for k in range(0, 400, 100)])
    contours = Contours(
        np.rint(points), np.arange(0, 361, 90), np.zeros(4, bool), (200, 180), points
    )
    trace = trace_refined(contours, None, RefinedParams(max_pairs=most))
    assert len(trace.detections) == 1


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_fit_of_a_pair_is_that_of_the_points_of_both_arcs(seed):
    params = RefinedParams()
    edges, arcs = arcs_of(drawn_arcs(seed, 40), params)
    found = pair_arcs(edges, arcs, params)
    for (i, j), row in list(zip(found.arcs, found.ellipses, strict=True))[:20]:
        chosen = [arcs.indices[arcs.offsets[k] : arcs.offsets[k + 1]] for k in (i, j) if k >= 0]
        points = edges.points[np.concatenate(chosen)]
        x, y = points.mean(axis=0)
        total, ellipse = np.zeros(25), np.empty(5)
        for px, py in points:
            fit.add_point(total, (px - x) / row[2], (py - y) / row[2])
        assert fit.fit_moments(total, x, y, 1.0 / row[2], ellipse)
        np.testing.assert_allclose(row[:4], ellipse[:4], rtol=1e-6)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 300), st.sampled_from([0.0, 1e-12, 1.0, 1e6]))
def test_candidates_stand_by_falling_rank_and_of_equals_by_their_arcs(seed, count, spread):
    """Also where single precision tells no two of them apart."""
    random = np.random.default_rng(seed)
    members = random.permuted(np.indices((20, 20)).reshape(2, -1).T, axis=0)[:count] - [0, 1]
    values = np.empty((count, 6))
    values[:, 0] = 1.0 + spread * random.choice(random.random(max(1, count // 2)), count)
    values[:, 1:] = random.random((count, 5))
    expected = np.lexsort((members[:, 1], members[:, 0], -values[:, 0]))
    arcs, rank, ellipses = order.best_first(members, values)
    assert np.array_equal(rank, values[expected, 0])
    assert np.array_equal(arcs, members[expected])
    assert np.array_equal(np.sort(ellipses, axis=0), np.sort(values[:, 1:], axis=0))
    if len(np.unique(values[:, 0])) == count:
        assert np.array_equal(ellipses, values[expected, 1:])
