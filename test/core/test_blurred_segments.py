"""Blurred segments: the promised width, corners, noise, and windows against brute force."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.polygon import BlurredSegmentsParams, blurred_segments, deviation_bound
from geoprim_core.polygon._kernels_blurred import maximal_blurred_segments

STEPS = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])


def thickness(points):
    """Return the least thickness along an axis over all directions through two of the points."""
    if len(np.unique(points, axis=0)) < 3:
        return 0.0
    least = np.inf
    for p, q in itertools.combinations(np.unique(points, axis=0), 2):
        d = q - p
        side = d[0] * (points[:, 1] - p[1]) - d[1] * (points[:, 0] - p[0])
        least = min(least, np.ptp(side) / np.abs(d).max())
    return least


@st.composite
def curves(draw, most=14):
    codes = draw(st.lists(st.integers(0, 7), min_size=2, max_size=most))
    if draw(st.booleans()):
        codes = [code % 3 for code in codes]
    return np.vstack([np.zeros((1, 2)), STEPS[codes].cumsum(axis=0)])


@given(curve=curves(), width=st.sampled_from([0.0, 0.7, 1.0, 1.5, 2.5]))
@settings(max_examples=100, deadline=None)
def test_the_windows_are_all_maximal_ones(curve, width):
    found, _ = maximal_blurred_segments(curve, False, width + 1e-9, -1)
    ends = []
    for start in range(len(curve)):
        end = start
        while end + 1 < len(curve) and (
            end == start or thickness(curve[start : end + 2]) <= width + 1e-9
        ):
            end += 1
        ends.append(end)
    starts = np.flatnonzero(np.diff(ends, prepend=-1) > 0)
    assert found[:, 0].tolist() == starts.tolist()
    assert found[:, 1].tolist() == np.array(ends)[starts].tolist()


@given(curve=curves(30), closed=st.booleans(), width=st.sampled_from([0.5, 1.0, 2.0, 4.0]))
@settings(max_examples=150, deadline=None)
def test_the_pixels_of_every_edge_lie_in_a_strip_of_the_width(curve, closed, width):
    params = BlurredSegmentsParams(width)
    indices = blurred_segments(curve, closed=closed, params=params)
    ends = list(itertools.pairwise(indices))
    if closed:
        ends.append((indices[-1], indices[0] + len(curve)))
    for i, j in ends:
        piece = curve[np.arange(i, j + 1) % len(curve)]
        assert j - i <= 1 or thickness(piece) <= width + 1e-9


@pytest.mark.parametrize("rule", ["width", "thesis", "exact", "released"])
def test_a_digital_line_of_any_slope_is_two_points(rule):
    for dx, dy in [(50, 0), (50, 50), (50, 17), (31, -50), (-89, 55)]:
        t = np.arange(max(abs(dx), abs(dy)) + 1) / max(abs(dx), abs(dy))
        line = np.rint(np.stack([t * dx, t * dy], axis=1))
        params = BlurredSegmentsParams(1.0, rule)
        assert blurred_segments(line, params=params).tolist() == [0, len(line) - 1]


def test_a_wider_segment_bridges_the_noise_of_an_edge():
    random = np.random.default_rng(3)
    x = np.arange(200.0)
    y = np.where(x < 100, 0.5 * x, 100 - 0.5 * x) + random.uniform(-1, 1, 200)
    noisy = np.rint(np.stack([x, y], axis=1))
    narrow = blurred_segments(noisy, params=BlurredSegmentsParams(1.0))
    wide = blurred_segments(noisy, params=BlurredSegmentsParams(3.5))
    assert len(narrow) > 10 * len(wide)
    assert len(wide) == 3 and abs(wide[1] - 100) <= 4


def test_the_bound_rule_needs_no_width():
    t = np.linspace(0, 2 * np.pi, 4000, endpoint=False)
    circle = np.rint(60 * np.stack([np.cos(t), np.sin(t)], axis=1))
    circle = circle[(circle != np.roll(circle, 1, axis=0)).any(axis=1)]
    found = [
        blurred_segments(circle, closed=True, params=BlurredSegmentsParams(width, "released"))
        for width in (0.1, 9.0)
    ]
    assert np.array_equal(*found)
    assert 8 <= len(found[0]) <= 30
    assert deviation_bound((0, 0), (20, 0)) < 1.5


def test_a_closed_curve_gives_the_corners_of_a_square_from_every_start():
    side = np.arange(30)
    square = np.concatenate(
        [
            np.stack([side, 0 * side], axis=1),
            np.stack([0 * side + 30, side], axis=1),
            np.stack([30 - side, 0 * side + 30], axis=1),
            np.stack([0 * side, 30 - side], axis=1),
        ]
    )
    for start in (0, 1, 14, 29, 60):
        turned = np.roll(square, start, axis=0)
        found = blurred_segments(turned, closed=True)
        assert {tuple(p) for p in turned[found]} == {(0, 0), (30, 0), (30, 30), (0, 30)}
