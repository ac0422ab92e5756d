"""Thesis 5.3.1 and 5.3.2: where contours are split into smooth arcs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.ecc import SmoothParams, split_arcs
from geoprim_core.errors import InputError
from geoprim_core.types import Contours, Polygons

STEP = 10  # points on each side of a polygon
EVERY = SmoothParams(min_length=1)


def polyline(turns_deg, closed=False):
    """Contour and polygon of unit steps whose i-th inner vertex turns by turns_deg[i]."""
    heading = np.deg2rad(np.cumsum([0.0, *turns_deg]))
    steps = np.repeat(np.stack([np.cos(heading), np.sin(heading)], axis=1), STEP, axis=0)
    points = np.concatenate([[[0.0, 0.0]], np.cumsum(steps, axis=0)])
    contours = Contours(points, [0, len(points)], [closed])
    vertices = np.arange(0, len(points), STEP)
    return contours, Polygons(vertices, [0, len(vertices)], [closed])


def splits(turns_deg, **params):
    """Numbers (from 1) of the vertices where the polyline is split."""
    arcs = split_arcs(*polyline(turns_deg), SmoothParams(min_length=1, **params))
    assert np.array_equal(arcs.rows, np.arange(len(arcs.rows)))
    return (arcs.offsets[1:-1] // STEP).tolist()


@pytest.mark.parametrize("rule", ["thesis", "majority"])
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(
    ("turns", "expected"),
    [
        ([20, 20, -20, 20, 20], [3]),  # case 1: one differing turn
        ([20, 20, -20, -20, 20, 20], [3, 4]),  # case 2: two
        ([20, 20, -20, -20, -20, -20], [3]),  # case 3: more
        ([20, 20, 20, 20], []),
    ],
)
def test_inflexions_follow_table_5_3_1(turns, expected, side, rule):
    assert splits([side * t for t in turns], inflexion_rule=rule) == expected


@pytest.mark.parametrize("turn", [-1, 1])
def test_a_turn_of_theta_0_or_more_is_sharp(turn):
    assert splits([30 * turn, 91 * turn, 30 * turn]) == [2]
    assert splits([30 * turn, 89 * turn, 30 * turn]) == []
    assert splits([30 * turn, 89 * turn, 30 * turn], max_turn=np.deg2rad(80)) == [2]


def test_an_early_wiggle_flips_only_the_thesis_rule():
    """Errata C1: (5-1) takes the first turn as its measure, here the odd one out."""
    turns = [-20, 20, 20, 20, -20, 20, 20, 20]
    assert splits(turns, inflexion_rule="thesis") == [2, 6]
    assert splits(turns, inflexion_rule="majority") == [2, 5]


def test_turns_below_the_tolerance_are_no_inflexions():
    turns = [20, 20, -3, 20, 20]
    assert splits(turns) == [3]
    assert splits(turns, inflexion_tolerance=np.deg2rad(5)) == []


def circle(count=200, start=0):
    t = 2 * np.pi * (np.arange(count) + start) / count
    return np.stack([50 + 30 * np.cos(t), 50 + 30 * np.sin(t)], axis=1)


@pytest.mark.parametrize("rule", ["thesis", "majority"])
def test_a_closed_smooth_contour_stays_one_closed_arc(rule):
    contours = Contours(circle(), [0, 200], [True])
    polygons = Polygons(np.arange(0, 200, 10), [0, 20], [True])
    arcs = split_arcs(contours, polygons, SmoothParams(inflexion_rule=rule))
    assert arcs.closed.tolist() == [True]
    assert np.array_equal(arcs[0], contours[0])


def test_one_corner_opens_a_closed_contour_there():
    t = np.linspace(0, 1, 120, endpoint=False)
    drop = np.stack([np.sin(np.pi * t) * 40, np.sin(2 * np.pi * t) * 15], axis=1)
    drop = np.roll(drop, 37, axis=0)  # the tip is inside the sequence
    contours = Contours(drop, [0, 120], [True])
    polygons = Polygons(np.arange(1, 120, 6), [0, 20], [True])
    arcs = split_arcs(contours, polygons)
    assert len(arcs) == 1
    assert not arcs.closed[0]
    assert arcs.rows[0] == 37
    assert sorted(arcs.rows) == list(range(120))


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.floats(-170, 170), min_size=1, max_size=30),
    st.booleans(),
    st.sampled_from(["thesis", "majority"]),
)
def test_arcs_are_a_partition_of_their_contour(turns, closed, rule):
    contours, polygons = polyline(turns, closed)
    arcs = split_arcs(contours, polygons, SmoothParams(min_length=1, inflexion_rule=rule))
    assert sorted(arcs.rows) == list(range(len(contours.points)))
    assert np.array_equal(arcs.points, contours.points[arcs.rows])


@settings(max_examples=30, deadline=None)
@given(st.lists(st.integers(-120, 120), min_size=6, max_size=20), st.integers(1, 50))
def test_the_majority_rule_does_not_see_where_a_closed_contour_starts(turns, shift):
    contours, polygons = polyline(turns, closed=True)
    count = len(contours.points)
    shift %= count
    turned = Contours(np.roll(contours.points, -shift, axis=0), [0, count], [True])
    vertices = Polygons(np.sort((polygons.indices - shift) % count), polygons.offsets, [True])
    params = SmoothParams(min_length=1, inflexion_rule="majority")
    first, second = split_arcs(contours, polygons, params), split_arcs(turned, vertices, params)
    assert len(first) == len(second)
    if not first.closed.any():
        ours = {tuple(map(tuple, arc)) for arc in first}
        assert ours == {tuple(map(tuple, arc)) for arc in second}


def test_short_arcs_are_dropped_and_what_pixels_carry_stays_with_them():
    contours, polygons = polyline([91, 91])
    count = len(contours.points)
    subpixel, gradient = contours.points + 0.25, np.arange(count, dtype=float)
    contours = Contours(contours.points, contours.offsets, [False], (50, 40), subpixel, gradient)
    arcs = split_arcs(contours, polygons, SmoothParams(min_length=11))
    assert arcs.gradient_angle.tolist() == list(range(20, 31))  # the other two have 10 points
    assert np.array_equal(arcs.positions, subpixel[20:])
    assert (arcs.contour.tolist(), arcs.image_size) == ([0], (50, 40))


def test_selected_arcs_keep_their_points():
    arcs = split_arcs(*polyline([91, 91, 91]), EVERY)
    some = arcs.select(np.array([2, 0]))
    assert np.array_equal(some[0], arcs[2])
    assert np.array_equal(some[1], arcs[0])


def test_polygons_of_other_contours_are_refused():
    contours, _ = polyline([20])
    with pytest.raises(InputError, match="polygons: expected 1 polygons"):
        split_arcs(contours, Polygons([], [0], []))
    with pytest.raises(InputError, match="indices within their contours"):
        split_arcs(contours, Polygons([0, 99], [0, 2], [False]))
    assert len(split_arcs(Contours([], [0], []), Polygons([], [0], []))) == 0
