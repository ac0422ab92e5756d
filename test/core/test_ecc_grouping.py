"""Thesis 5.4: search region, convexity, centres, votes and groups."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.ecc import Arcs, GroupingParams, three_point_centre
from geoprim_core.ecc.centres import find_centres
from geoprim_core.ecc.convexity import find_associated
from geoprim_core.ecc.hypotheses import form_hypotheses
from geoprim_core.ecc.search_region import find_arcs_inside, find_search_regions
from geoprim_core.ecc.tangents import arc_tangents
from geoprim_core.ecc.votes import (
    Votes,
    arc_trust,
    bin_trust,
    cast_votes,
    find_meeting_arcs,
    relationship_score,
)
from geoprim_core.errors import InputError
from geoprim_core.fitting import nsaf

PARAMS = GroupingParams()


def arc_points(x, y, a, b, angle, start, stop):
    """Pixels, in order and each once, of a piece of an ellipse (eccentric angles in degrees)."""
    t = np.deg2rad(np.linspace(start, stop, 3000))
    u, v = a * np.cos(t), b * np.sin(t)
    cos, sin = math.cos(angle), math.sin(angle)
    pixels = np.rint(np.stack([x + u * cos - v * sin, y + u * sin + v * cos], axis=1))
    fresh = np.concatenate([[True], (np.diff(pixels, axis=0) != 0).any(axis=1)])
    return pixels[fresh]


def arcs_of(*curves, closed=False, image_size=None):
    points = np.concatenate(curves)
    offsets = np.concatenate([[0], np.cumsum([len(c) for c in curves])]).astype(np.int64)
    count = len(curves)
    flags = np.full(count, closed)
    return Arcs(
        points, offsets, np.arange(count), flags, np.arange(len(points)), image_size=image_size
    )


def groupable(arcs, params=PARAMS):
    regions = find_search_regions(arcs, arc_tangents(arcs))
    every = np.ones((len(arcs), len(arcs)), bool)
    return find_associated(arcs, find_arcs_inside(arcs, regions, every, params), params)


# Yuen's centre


def on_ellipse(x, y, a, b, angle, t):
    """Points and tangent directions at eccentric angles t."""
    cos, sin = math.cos(angle), math.sin(angle)
    u, v, du, dv = a * np.cos(t), b * np.sin(t), -a * np.sin(t), b * np.cos(t)
    points = np.stack([x + u * cos - v * sin, y + u * sin + v * cos], axis=1)
    return points, np.arctan2(du * sin + dv * cos, du * cos - dv * sin)


@settings(max_examples=60, deadline=None)
@given(
    st.floats(-500, 500),
    st.floats(-500, 500),
    st.floats(5, 300),
    st.floats(0.2, 1),
    st.floats(0, 3.14),
    st.floats(0, 6.28),
    st.floats(0.3, 1.2),
    st.floats(0.3, 1.2),
)
def test_three_points_and_tangents_give_the_centre(x, y, a, ratio, angle, t, gap1, gap2):
    points, tangents = on_ellipse(
        x, y, a, a * ratio, angle, np.array([t, t + gap1, t + gap1 + gap2])
    )
    centre = three_point_centre(points, tangents)
    assert np.hypot(*(centre - [x, y])) < 1e-9 * (a + abs(x) + abs(y))


def test_a_vertical_tangent_is_no_exception():
    """Errata T4: tan(theta) is infinite at the first point."""
    points, tangents = on_ellipse(7, -3, 40, 25, 0, np.array([0.0, 1.0, 2.0]))
    assert tangents[0] == np.pi / 2
    assert three_point_centre(points, tangents) == pytest.approx([7, -3], abs=1e-12)


def test_the_centre_agrees_with_the_printed_formulas():
    p, angle = on_ellipse(30, 20, 40, 25, 0.7, np.array([0.3, 1.5, 2.4]))
    (x1, y1), (x2, y2), (x3, y3) = p
    m1, m2, m3 = np.tan(angle)
    A12 = y2**2 - y1**2 - (x2 * y2 - x1 * y1) * (m1 + m2) + (x2**2 - x1**2) * m1 * m2
    A23 = y3**2 - y2**2 - (x3 * y3 - x2 * y2) * (m2 + m3) + (x3**2 - x2**2) * m2 * m3
    B12 = (y2 - y1) * (m1 + m2) - 2 * (x2 - x1) * m1 * m2
    B23 = (y3 - y2) * (m2 + m3) - 2 * (x3 - x2) * m2 * m3
    C12 = 2 * (y2 - y1) - (x2 - x1) * (m1 + m2)
    C23 = 2 * (y3 - y2) - (x3 - x2) * (m2 + m3)
    det = B12 * C23 - B23 * C12
    printed = [-(A12 * C23 - A23 * C12) / det, -(A12 * B23 - A23 * B12) / det]
    assert three_point_centre(p, angle) == pytest.approx(printed)


def test_the_two_exceptions_of_the_method_give_no_centre():
    points, tangents = on_ellipse(0, 0, 40, 25, 0.4, np.array([0.2, 0.2 + np.pi, 5.0]))
    assert three_point_centre(points, tangents) is None  # parallel tangents
    x = np.array([-1.0, 0.0, 2.0])  # on a parabola the two lines through the centre are parallel
    assert three_point_centre(np.stack([x, x**2], axis=1), np.arctan(2 * x)) is None
    with pytest.raises(InputError, match="angles"):
        three_point_centre(points, tangents[:2])


# Search region and convexity


@settings(max_examples=25, deadline=None)
@given(st.floats(30, 80), st.floats(0.6, 1), st.floats(0, 3.1), st.integers(0, 359))
def test_two_parts_of_one_ellipse_may_be_grouped(a, ratio, angle, start):
    ellipse = (100, 90, a, a * ratio, angle)
    arcs = arcs_of(
        arc_points(*ellipse, start, start + 130), arc_points(*ellipse, start + 180, start + 310)
    )
    assert groupable(arcs).tolist() == [[False, True], [True, False]]


LEFT = {"(": (110, 250), ")": (-70, 70)}  # eccentric angles of arcs that bow left and right


@pytest.mark.parametrize("pair", [")(", "((", "))"])
def test_arcs_that_do_not_bow_away_from_each_other_are_not_grouped(pair):
    """Scenarios of Figure 5.4-2; the arcs stand opposite each other, 60 pixels apart."""
    curves = [arc_points(40 + 100 * i, 60, 30, 30, 0, *LEFT[bow]) for i, bow in enumerate(pair)]
    assert not groupable(arcs_of(*curves)).any()


def test_arcs_side_by_side_are_not_grouped():
    """The remaining scenario of Figure 5.4-2: both bow to the same side of one line."""
    curves = [arc_points(x, 60, 30, 30, 0, 200, 340) for x in (40, 140)]
    assert not groupable(arcs_of(*curves)).any()


def test_arcs_that_bow_away_from_each_other_are_grouped():
    curves = [arc_points(x, 60, 30, 30, 0, *LEFT[bow]) for x, bow in ((60, "("), (75, ")"))]
    assert groupable(arcs_of(*curves)).all(axis=None, where=~np.eye(2, dtype=bool))


def test_the_search_region_does_not_hold_the_arc_that_it_belongs_to():
    arcs = arcs_of(
        arc_points(60, 60, 40, 30, 0.3, 20, 170), arc_points(60, 60, 40, 30, 0.3, 60, 90)
    )
    regions = find_search_regions(arcs, arc_tangents(arcs))
    assert regions.defined[0]
    normal, c = regions.half_planes[0, :, :2], regions.half_planes[0, :, 2]
    middle = arcs[0][len(arcs[0]) // 2]
    assert (normal @ middle - c > 0).tolist() == [True, True, False]
    assert not groupable(arcs)[0, 1]


def test_straight_and_closed_arcs_have_no_search_region():
    line = np.stack([np.arange(40.0), np.zeros(40)], axis=1)
    arcs = arcs_of(line)
    assert not find_search_regions(arcs, arc_tangents(arcs)).defined.any()
    ring = arcs_of(arc_points(60, 60, 40, 40, 0, 0, 359), closed=True)
    assert not find_search_regions(ring, arc_tangents(ring)).defined.any()


# Votes


def test_trust_functions_have_their_printed_values():
    """(5-6), (5-7) at 0, 1/2 and 1; r_2 dampens more."""
    share = np.array([0.0, 0.5, 1.0])
    assert bin_trust(share) == pytest.approx([0, 0.5 * math.exp(-0.5), 1])
    assert arc_trust(share) == pytest.approx([0, 0.5 * math.exp(-1), 1])
    score = relationship_score(np.array([50]), np.array([100]), 200)
    assert score == pytest.approx([50 * 0.5 * math.exp(-0.5) * 0.5 * math.exp(-1)])


def test_an_arc_votes_for_the_bin_of_its_centre():
    arcs = arcs_of(arc_points(90, 60, 50, 40, 0.5, 10, 250), image_size=(200, 150))
    centres = find_centres(arcs, arc_tangents(arcs), PARAMS)
    votes = cast_votes(arcs, centres, "2", PARAMS)
    best = int(np.argmax(votes.totals()))
    assert np.abs(votes.bin_centres()[best] - [90, 60]).max() <= 12.5
    assert votes.count.sum() == votes.valid[0] <= PARAMS.sets
    assert votes.count.max() > 0.6 * PARAMS.sets
    assert (votes.columns, votes.rows) == (8, 6)
    counts = cast_votes(arcs, centres, "1", PARAMS)
    assert sorted(counts.score) == sorted(counts.count)


def test_centres_outside_the_image_are_not_valid():
    arcs = arcs_of(arc_points(-30, 60, 50, 40, 0, -60, 60), image_size=(60, 150))
    centres = find_centres(arcs, arc_tangents(arcs), PARAMS)
    votes = cast_votes(arcs, centres, "2", PARAMS)
    x, y = centres[0].T  # NaN compares false
    inside = (x >= -0.5) & (x < 74.5) & (y >= -0.5) & (y < 149.5)
    assert votes.valid[0] == inside.sum() < PARAMS.sets / 2


# Groups


def votes_for(arcs, counts, at):
    """All arcs vote for the one bin that holds the position `at`."""
    arc = np.argsort(counts)[::-1]
    count, n = np.asarray(counts)[arc], len(counts)
    columns, size = 8, 25.0
    where = int((at[1] + 0.5) // size) * columns + int((at[0] + 0.5) // size)
    return Votes(
        arc, np.full(n, where), count, count.astype(float), np.asarray(counts), np.full(2, -0.5),
        columns, 6, size,
    )  # fmt: skip


ELLIPSE = (90, 60, 50, 35, 0.5)


def scene():
    """Two arcs of one ellipse, and a weaker one of another ellipse about the same centre."""
    return arcs_of(
        arc_points(*ELLIPSE, 0, 120),
        arc_points(*ELLIPSE, 170, 290),
        arc_points(90, 60, 30, 15, 2.0, 30, 200),
    )


def test_dropping_the_weakest_equals_a_fit_to_the_pixels_that_remain():
    arcs = scene()
    found = form_hypotheses(arcs, votes_for(arcs, [90, 80, 20], (90, 60)), None, PARAMS)
    assert found.group(0).tolist() == [0, 1]
    direct = nsaf(np.concatenate([arcs[0], arcs[1]]))
    expected = [getattr(direct.ellipse, n) for n in ("x", "y", "semi_major", "semi_minor", "angle")]
    assert found.ellipses[0] == pytest.approx(expected, abs=1e-7)
    assert found.residual[0] == pytest.approx(direct.residual, rel=1e-6)
    assert found.ellipses[0] == pytest.approx(ELLIPSE, abs=0.3)


def test_arcs_that_are_not_eligible_stay_out_of_the_group():
    arcs = scene()
    eligible = np.zeros((3, 3), bool)
    eligible[0, 1] = eligible[1, 0] = True
    found = form_hypotheses(arcs, votes_for(arcs, [20, 30, 90], (90, 60)), eligible, PARAMS)
    assert sorted(found.group(i).tolist() for i in range(len(found))) == [[1, 0], [2]]


def test_c2_refuses_an_ellipse_that_does_not_hold_its_bin():
    arcs = scene()
    assert len(form_hypotheses(arcs, votes_for(arcs, [9, 8, 2], (170, 130)), None, PARAMS)) == 0


def test_pairs_that_never_meet_in_a_bin_need_no_test():
    """Skipping them leaves the hypotheses as they are."""
    rng = np.random.default_rng(3)
    curves = []
    for _ in range(12):
        x, y = rng.uniform(40, 160, 2)
        a, t = rng.uniform(15, 35), rng.uniform(0, 360)
        curves += [arc_points(x, y, a, a * 0.8, 1, t + d, t + d + 100) for d in (0, 170)]
    arcs = arcs_of(*curves, image_size=(200, 200))
    tangents = arc_tangents(arcs)
    votes = cast_votes(arcs, find_centres(arcs, tangents, PARAMS), "3", PARAMS)
    regions = find_search_regions(arcs, tangents)
    found = []
    for candidates in (np.ones((24, 24), bool), find_meeting_arcs(votes, PARAMS)):
        inside = find_arcs_inside(arcs, regions, candidates, PARAMS)
        found.append(form_hypotheses(arcs, votes, find_associated(arcs, inside, PARAMS), PARAMS))
    assert len(found[0]) >= 12
    assert np.array_equal(found[0].ellipses, found[1].ellipses)
    assert np.array_equal(found[0].arc, found[1].arc)
