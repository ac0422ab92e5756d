"""The selection of the `refined` scheme against the plain greedy choice that it stands for."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.ecc.refined import _kernels_select as select
from geoprim_core.ecc.refined import _kernels_support as support
from geoprim_core.ecc.refined._kernels_points import index_points

SIZE = 120
REACH, LEAST, MOST, WEAKEST, WOVEN = 1.5, 0.6, 0.8, 0.0, 0.2


def drawn(seed, count):
    """Return edge points on `count` ellipses, some of them near copies, and their support."""
    generator = np.random.default_rng(seed)
    rows = generator.uniform([30, 30, 12, 8, 0], [90, 90, 28, 12, 3], (count, 5))
    rows[1::3] = rows[: 3 * len(rows[1::3]) : 3] + generator.normal(0, 0.4, (len(rows[1::3]), 5))
    rows[:, 2:4] = np.sort(rows[:, 2:4], axis=1)[:, ::-1]
    rows[:, 4] %= np.pi
    t = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    points, normals = [], []
    for x, y, a, b, angle in rows:
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        points.append([x, y] + np.stack([a * np.cos(t), b * np.sin(t)], axis=1) @ turn)
        across = np.stack([b * np.cos(t), a * np.sin(t)], axis=1) @ turn
        normals.append(across / np.hypot(*across.T)[:, None])
    figures = np.zeros((count, 8))
    figures[:, 0] = generator.uniform(-0.5, 4, count)
    figures[:, 1] = generator.choice([0.5, 0.7, 1.0], count)
    figures[:, 2] = figures[:, 1]
    figures[:, 3] = generator.choice([0.1, 0.9], count)
    figures[:, 5] = generator.choice([60.0, 80.0, 100.0], count)  # ties
    offsets = np.arange(count + 1) * 90
    return np.concatenate(points), np.concatenate(normals), rows, figures, offsets


def plain(edges, verified):
    """Choose the strongest, look at every other again, and so on."""
    rows, figures, offsets, members = verified
    strength = figures[:, 5] * np.sqrt(figures[:, 1]) / (1 + 2 * figures[:, 3])
    alive = figures[:, 0] >= WEAKEST
    claimed = np.zeros(len(edges.points), bool)
    chosen = []
    while True:
        value = np.zeros(len(rows))
        for k in np.flatnonzero(alive):
            share = np.mean(~claimed[members[offsets[k] : offsets[k + 1]]])
            taken = np.array(chosen, np.int64)
            twin = select.is_twin(rows, figures, taken, len(taken), k, MOST, WOVEN)
            alive[k] = share >= LEAST and not twin
            value[k] = strength[k] * share if alive[k] else 0.0
        if not alive.any():
            return chosen
        best = int(np.argmax(value))
        alive[best] = False
        chosen.append(best)
        select.claim(edges, rows[best], REACH, claimed)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 40))
def test_the_heap_chooses_what_the_plain_greedy_selection_does_in_its_order(seed, count):
    points, normals, rows, figures, offsets = drawn(seed, count)
    edges = index_points(points, normals, SIZE, SIZE)
    verified = support.Supported(rows, figures, offsets, np.arange(len(points)))
    chosen, outcome, _ = select.select(edges, verified, WEAKEST, REACH, LEAST, MOST, WOVEN)
    assert chosen.tolist() == plain(edges, verified)
    assert np.flatnonzero(outcome == select.CHOSEN).tolist() == sorted(chosen.tolist())
    assert np.array_equal(outcome == select.WEAK, figures[:, 0] < WEAKEST)


@settings(max_examples=60, deadline=None)
@given(st.floats(20, 90), st.floats(0.5, 1), st.floats(0, 3.1), st.floats(0.8, 1.25))
def test_the_second_edge_of_a_rim_does_not_weave_through_the_first(a, ratio, angle, scale):
    row = np.array([100.0, 90.0, a, a * ratio, angle])
    other = row * [1, 1, scale, scale, 1]
    assert not select.weaves(row, other, WOVEN)
    assert not select.weaves(other, row, WOVEN)


@settings(max_examples=60, deadline=None)
@given(st.floats(40, 90), st.floats(0.6, 0.8), st.floats(0, 1.5))
def test_an_ellipse_weaves_through_itself_turned_by_a_right_angle(a, ratio, angle):
    row = np.array([100.0, 90.0, a, a * ratio, angle])
    turned = np.array([100.0, 90.0, a, a * ratio, angle + np.pi / 2])
    assert select.weaves(row, turned, WOVEN)


def test_what_weaves_is_a_twin_unless_it_is_closely_supported_nearly_all_along():
    rows = np.array([[100.0, 90.0, 60.0, 52.0, 0.3], [100.0, 90.0, 60.0, 52.0, 0.3 + np.pi / 2]])
    first = np.array([0])
    for coverage, rms, twin in ((0.9, 0.1, False), (0.6, 0.1, True), (0.9, 0.8, True)):
        figures = np.zeros((2, 8))
        figures[:, 1:4] = coverage, coverage, rms
        assert select.is_twin(rows, figures, first, 1, 1, MOST, WOVEN) == twin
        assert select.is_twin(rows, figures, first, 1, 1, MOST, 1.0)
