"""The fitting kernels of the `refined` scheme against analytic results."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.ecc.refined import _kernels_arcs as arcs
from geoprim_core.ecc.refined import _kernels_clutter as clutter
from geoprim_core.ecc.refined import _kernels_conic as conic
from geoprim_core.ecc.refined import _kernels_ends as ends
from geoprim_core.ecc.refined import _kernels_final as final
from geoprim_core.ecc.refined import _kernels_fit as fit
from geoprim_core.ecc.refined import _kernels_mates as mates
from geoprim_core.ecc.refined import _kernels_order as order
from geoprim_core.ecc.refined import _kernels_outline as outline
from geoprim_core.ecc.refined import _kernels_places as places_of
from geoprim_core.ecc.refined import _kernels_refit as refit
from geoprim_core.ecc.refined import _kernels_second_look as second_look
from geoprim_core.ecc.refined import _kernels_stroke as stroke
from geoprim_core.ecc.refined import _kernels_support as support
from geoprim_core.ecc.refined._kernels_points import index_points

ellipses = st.tuples(
    st.floats(-50, 8000),
    st.floats(-50, 8000),
    st.floats(15, 200),
    st.floats(0.3, 1),
    st.floats(0, 3.1),
).map(lambda v: np.array([v[0], v[1], v[2], v[2] * v[3], v[4]]))


def points_of(ellipse, start=0.0, span=2 * np.pi, count=80):
    x, y, a, b, angle = ellipse
    t = np.linspace(start, start + span, count)
    u, v = a * np.cos(t), b * np.sin(t)
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack([x + u * cos - v * sin, y + u * sin + v * cos], axis=1)


def distance(row, ellipse):
    """Return the largest difference in pixels between two ellipses."""
    turn = (row[4] - ellipse[4] + np.pi / 2) % np.pi - np.pi / 2
    return max(np.abs(row - ellipse)[:4].max(), abs(turn) * (ellipse[2] - ellipse[3]))


@settings(max_examples=60, deadline=None)
@given(ellipses, st.floats(0, 6), st.floats(1.5, 6.2))
def test_the_added_moments_of_two_arcs_give_back_their_ellipse(ellipse, start, span):
    points = points_of(ellipse, start, span)
    total = np.zeros(25)
    x, y = points.mean(axis=0)
    scale = 1.0 / ellipse[2]
    for part in (points[:30], points[30:]):
        origin, moments = part[0], np.zeros(25)
        for p in part:
            fit.add_point(moments, *(p - origin))
        fit.add_shifted(total, moments, *(origin - (x, y)), scale)
    row = np.empty(5)
    assert fit.fit_moments(total, x, y, scale, row)
    assert distance(row, ellipse) < 1e-3


@settings(max_examples=100, deadline=None)
@given(st.floats(-1, 1), st.floats(0.01, 2), st.floats(0, 2), st.floats(1e-6, 1e6))
def test_the_largest_root_of_a_cubic_is_found(largest, gap, other, unit):
    p, q, r = unit * largest, unit * (largest - gap), unit * (largest - gap - other)
    found = conic.largest_root(-(p + q + r), p * q + q * r + r * p, -p * q * r)
    assert abs(found - p) <= 1e-9 * unit


@settings(max_examples=100, deadline=None)
@given(st.lists(st.floats(-7, 7) | st.floats(-1e9, 1e9), min_size=1, max_size=9))
def test_unit_vectors_are_those_of_the_library_to_rounding(angles):
    angle = np.array([*angles, 0.0, np.pi, -np.pi, 0.5 * np.pi, -0.5 * np.pi])
    expected = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    np.testing.assert_allclose(arcs.unit_vectors(angle), expected, rtol=0, atol=3e-16)


@settings(max_examples=100, deadline=None)
@given(st.lists(st.floats(-np.pi, np.pi) | st.sampled_from([-np.pi, 0.0, 1.0, np.pi])))
def test_the_order_around_an_ellipse_is_that_of_a_stable_sort(angles):
    angle = np.array(angles, float)
    np.testing.assert_array_equal(order.order_around(angle), np.argsort(angle, kind="stable"))


def test_points_on_a_line_have_no_ellipse():
    moments = np.zeros(25)
    for k in range(20):
        fit.add_point(moments, k / 10, k / 5)
    assert not fit.fit_moments(moments, 0.0, 0.0, 1.0, np.empty(5))


@settings(max_examples=40, deadline=None)
@given(ellipses)
def test_the_refit_returns_from_a_nearby_ellipse_and_ignores_outliers(ellipse):
    points = points_of(ellipse, count=200)
    points[::20] += 8.0
    row = ellipse + np.array([0.3, -0.2, 0.4, -0.3, 0.004])
    near = np.concatenate([points.T, np.zeros((1, 200))])
    assert refit.refit(near, 200, row, 8, 3.0)
    assert distance(row, ellipse) < 0.1


@settings(max_examples=40, deadline=None)
@given(ellipses, st.floats(-0.5, 0.5))
def test_the_offset_is_the_distance_along_the_normal(ellipse, height):
    a, b = ellipse[2], ellipse[3]
    t = 0.8
    normal = np.array([b * np.cos(t), a * np.sin(t)])
    normal /= np.hypot(*normal)
    u, v = np.array([a * np.cos(t), b * np.sin(t)]) + height * normal
    cos, sin = np.cos(ellipse[4]), np.sin(ellipse[4])
    x, y = ellipse[0] + u * cos - v * sin, ellipse[1] + u * sin + v * cos
    d, nx, ny = fit.offset_of(ellipse, cos, sin, x, y)
    assert abs(d - height) < 0.01 + height * height * a / b**2
    assert abs(nx * nx + ny * ny - 1) < 1e-9


def test_gap_figures_of_a_half_circle():
    circle = np.array([0.0, 0.0, 50.0, 50.0, 0.0])
    coverage, continuity = final.gap_figures(np.linspace(-np.pi / 2, np.pi / 2, 200), circle)
    assert abs(coverage - 0.5) < 0.01
    assert continuity == 1
    quarters = np.concatenate([np.linspace(-3, -1.5, 100), np.linspace(0, 1.5, 100)])
    coverage, continuity = final.gap_figures(quarters, circle)
    assert abs(coverage - 3 / (2 * np.pi)) < 0.01
    assert abs(continuity - (1 - 1.5 / np.pi)) < 0.02


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.integers(10, 13), st.integers(0, 4)), max_size=40))
def test_arcs_stand_longest_first_then_highest_then_as_they_came(rows):
    table = np.zeros((len(rows), 20))
    table[:, [18, 17]] = np.array(rows, float).reshape(-1, 2)
    expected = np.lexsort((-table[:, 17], -table[:, 18]))
    assert np.array_equal(arcs.longest_first(table, 0.0), expected)
    assert np.array_equal(arcs.longest_first(table, 2.0), expected[table[expected, 17] >= 2.0])


def mates_of(edges, offsets, share=0.0, alone=0.93, least=10):
    """Return what `find_mates` does on lists of edge points with the slope of their normal."""
    points = np.concatenate([edge for edge, _ in edges])
    normals = np.concatenate([np.tile(normal, (len(edge), 1)) for edge, normal in edges])
    wide, high = np.ceil(points.max(axis=0)).astype(int) + 20
    index = index_points(points, normals, wide, high)
    closed = np.zeros(len(offsets) - 1, bool)
    search = second_look.MateSearch(index, np.ones(len(points)), 0.7, 4.0)
    return mates.find_mates(search, offsets, closed, least, alone, share, 0.5)


def level_edges(rows, length=30):
    """Return level edges, each darker on the side of the next one or of the one before in turn."""
    x = np.arange(10.0, 10.0 + length)
    slopes = (0.0, -1.0), (0.0, 1.0)
    return [(np.stack([x, 0 * x + y], axis=1), slopes[k % 2]) for k, y in enumerate(rows)]


def mates_of_lines(lengths, share, alone=0.93):
    """Return what `find_mates` does on two level edges 2.25 px apart, and their offsets.

    The points of one go far, those of the other in contours of given lengths.
    """
    far = max(200, sum(lengths))
    (near, up), (other, down) = level_edges((20.0, 22.25), far)
    offsets = np.cumsum([0, far, *lengths])
    return *mates_of([(near, up), (other[: sum(lengths)], down)], offsets, share, alone), offsets


def test_the_edges_of_a_line_are_mates_across_its_width():
    gaps, drawn, _ = mates_of_lines([200], 0.6)
    assert np.allclose(gaps, [[2.25], [0.0]])
    assert drawn


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.integers(1, 150), min_size=1, max_size=5), st.floats(0.0, 1.0), st.floats(0.3, 1.0)
)
def test_mates_that_are_not_looked_for_would_change_nothing(lengths, share, alone):
    every, always, offsets = mates_of_lines(lengths, 0.0, alone)
    some, drawn, _ = mates_of_lines(lengths, share, alone)
    assert always
    long = mates.gaps_of_long(every, offsets)
    assert drawn == (np.count_nonzero(long) > share * long.shape[1])
    assert np.array_equal(some[some != 0.0], every[some != 0.0])
    if drawn:
        assert np.array_equal(some, every)
    found = [widths(gaps, offsets, alone=alone)[0] for gaps in (some, every)]
    assert np.array_equal(*found)


def test_each_side_of_an_edge_has_its_own_mate():
    rows = (20.0, 23.0, 25.0, 28.0)  # two dark lines 3 pixels wide with 2 pixels in between
    gaps, _ = mates_of(level_edges(rows), np.arange(0, 150, 30))
    assert np.allclose(gaps[0], 3.0)
    assert np.allclose(gaps[1].reshape(4, 30), np.array([[0.0], [2.0], [2.0], [0.0]]))


def test_what_a_normal_passes_by_is_found_beside_the_mate_of_the_neighbour():
    along, down = np.arange(10.0, 30.0), np.array([1.0, -1.0]) / np.sqrt(2)
    near = np.stack([along, along], axis=1)
    points = np.concatenate([near, near + 0.51 + 2.1 * down])  # normals go through pixel corners
    normals = np.repeat([-down, down], 20, axis=0)
    edges = (near, -down), (points[20:], down)
    gaps, _ = mates_of(edges, np.array([0, 20, 40]))
    assert not gaps.any()
    gaps[0, ::3] = 2.1
    index = index_points(points, normals, 60, 40)
    search = second_look.MateSearch(index, np.ones(40), 0.7, 4.0)
    second_look.complete_mates(search, 0, 40, -1.0, gaps[0])
    assert np.allclose(gaps, [[2.1], [0.0]])


def widths(gaps, offsets, reach=4.0, common=0.0, both_inks=True, closed=False, alone=0.7):
    flags = np.full(len(offsets) - 1, closed)
    return stroke.stroke_widths(gaps, offsets, flags, alone, reach, 0.5, common, both_inks)


def sides(gaps):
    """Return the gaps on the dark and on the bright side of signed ones."""
    return np.stack([np.maximum(-gaps, 0.0), np.maximum(gaps, 0.0)])


def test_a_contour_is_a_line_by_its_own_mates_or_in_a_line_drawing():
    few = np.where(np.arange(20) < 3, 2.0, 0.0)
    gaps = sides(np.concatenate([np.full(30, 2.0), np.zeros(60), few]))
    offsets = np.array([0, 30, 90, 110])
    alone, count = widths(gaps, offsets)
    assert np.array_equal(alone, np.repeat([2.0, 0.0, 0.0], [30, 60, 20]))
    assert count == 30
    assert not widths(gaps, offsets, reach=1.5)[0].any()
    together, count = widths(gaps, offsets, common=2.25)
    assert np.array_equal(together, np.repeat([2.25, 0.0, 2.25], [30, 60, 20]))
    assert count == 50


def test_in_a_drawing_a_contour_may_be_a_line_of_the_other_ink():
    gaps = sides(np.repeat([2.0, -2.5, 0.0], [30, 30, 20]))
    offsets = np.array([0, 30, 60, 80])
    both, _ = widths(gaps, offsets, common=2.25)
    assert np.array_equal(both, np.repeat([2.25, -2.25, 2.25], [30, 30, 20]))
    one, _ = widths(gaps, offsets, common=2.25, both_inks=False)
    assert np.array_equal(one, np.full(80, 2.25))


def test_a_short_contour_is_a_line_by_itself_when_it_is_closed():
    gaps, offsets = sides(np.full(6, -2.0)), np.array([0, 6])
    assert not widths(gaps, offsets)[0].any()
    assert np.array_equal(widths(gaps, offsets, closed=True)[0], np.full(6, -2.0))


def test_ends_without_mates_and_gaps_at_any_distance_tell_otherwise():
    hidden = np.concatenate([np.zeros(5), np.full(30, 2.0), np.zeros(5)])
    offsets = np.array([0, 40])
    assert np.array_equal(widths(sides(hidden), offsets)[0], np.full(40, 2.0))
    assert not widths(sides(np.roll(hidden, 15)), offsets)[0].any()
    assert not widths(sides(np.linspace(0.5, 3.5, 40)), offsets)[0].any()


def evidence(share=0.6, rms=0.2, slant=0.1, length=200.0, outside=0.0, noise=(0.0, 0.0), ratio=0.5):
    weights = support.Weights(1.3, 0.0, *noise, 0.5)
    return support.evidence_of(share, rms, slant, length, 40.0, ratio, 1.0, outside, weights)


def test_more_and_better_support_is_more_evidence():
    assert evidence(length=300.0) > evidence()
    assert evidence(share=0.9) > evidence()
    assert evidence(rms=0.4) < evidence()
    assert evidence(slant=0.2) < evidence()
    assert evidence(outside=0.2) < evidence()


def test_noise_explains_scatter_up_to_its_own_and_gaps_in_whole_outlines():
    assert evidence(rms=0.4, noise=(0.3, 0.0)) > evidence(rms=0.4)
    assert evidence(rms=0.2, noise=(0.2, 0.0)) == evidence(rms=0.2, noise=(0.3, 0.0))
    assert evidence(share=0.7, noise=(0.0, 0.2)) > evidence(share=0.7)
    assert evidence(share=0.4, noise=(0.0, 0.2)) == evidence(share=0.4)
    assert evidence(rms=0.4, noise=(0.3, 0.0)) < evidence(rms=0.3, noise=(0.3, 0.0))


@given(st.floats(0.0, 0.3), st.floats(5.0, 300.0))
def test_slanted_gradients_count_on_small_outlines_only(slant, outline):
    lost = support.doubt_of_small(slant, outline, 8.0)
    assert 0.0 <= lost <= 8.0
    assert lost >= support.doubt_of_small(0.9 * slant, 1.1 * outline, 8.0)
    assert lost == 0.0 or (slant > 0.05 and outline < 60.0)
    assert lost == 8.0 or slant < 0.1 or outline > 40.0


@given(ellipses, st.floats(-0.3, 0.3))
def test_the_slant_of_the_gradients_is_that_of_most(ellipse, turn):
    points = points_of(ellipse)
    axes = np.cos(ellipse[4]), np.sin(ellipse[4])
    normals = np.array([fit.offset_of(ellipse, *axes, *p)[1:] for p in points])
    cos, sin = np.cos(turn), np.sin(turn)
    normals = normals @ np.array([[cos, sin], [-sin, cos]])
    normals[:30] = axes  # of something else that touches the ellipse
    slant = support.typical_slant(points, normals, ellipse, np.arange(80), 80)
    assert slant == pytest.approx(1.4826 * abs(sin), abs=1e-5)


def test_scatter_counts_less_on_an_outline_that_is_whole_and_round():
    assert evidence(share=0.95, rms=0.4, ratio=0.96) > evidence(share=0.95, rms=0.4, ratio=0.8)
    assert evidence(share=0.95, rms=0.4, ratio=0.8) == evidence(share=0.95, rms=0.4, ratio=0.2)
    assert evidence(share=0.6, rms=0.4, ratio=0.96) == evidence(share=0.6, rms=0.4, ratio=0.2)
    assert evidence(share=0.95, rms=0.4, ratio=1.0) < evidence(share=0.95, rms=0.2, ratio=1.0)


def test_clutter_and_ends_count_only_where_the_outline_is_extrapolated():
    for doubt in (lambda share: support.doubt_of_ends(share, 0.5, 0.5), of_clutter):
        assert doubt(1.0) == 0
        assert 0 < doubt(0.8) < doubt(0.4)


def of_clutter(share):
    return support.doubt_of_clutter(share, 0.5)


def collected(points, normals, ellipse, stride=2.0, min_cos=0.96):
    """Return the indices of the points on a 120 x 100 image that support an ellipse, and more.

    That is the sums that go with them and the share of the ends of gaps that nothing explains.
    """
    edges = index_points(points, normals, 120, 100)
    walk = outline.new_walk(edges, 100.0)
    count = outline.collect(edges, ellipse, walk, stride, outline.Band(2.0, min_cos, 0, 1))
    gaps = ends.unexplained_share(edges, ellipse, walk)
    return walk.chosen[:count], walk.sums, gaps


def upper_half(count=120):
    """Return the points and normals of the upper half of a circle, and the circle."""
    circle = np.array([60.0, 50.0, 30.0, 30.0, 0.0])
    t = np.linspace(np.pi, 2 * np.pi, count)
    normals = np.stack([np.cos(t), np.sin(t)], axis=1)
    return circle[:2] + 30 * normals, normals, circle


def continuing(points, offsets, stamp):
    """Return the share of ends at which a contour goes on, of the points that are stamped."""
    chosen = np.flatnonzero(stamp)
    links = ends.neighbours_of(points, np.array(offsets))
    return ends.continuing_share(links, stamp, 1, chosen, len(chosen))


def test_a_contour_that_goes_on_elsewhere_is_told_from_one_that_ends():
    points = np.stack([np.arange(120.0), np.zeros(120)], axis=1)
    stamp = np.ones(120, np.int32)
    stamp[100:] = 0
    assert continuing(points, [0, 120], stamp) == 0.5
    assert continuing(points, [0, 100, 120], stamp) == 0.0
    stamp[103] = 1  # a few points off the outline are no end
    assert continuing(points[:104], [0, 104], stamp[:104]) == 0.0


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 239), st.booleans(), st.integers(20, 200))
def test_the_ends_do_not_depend_on_where_a_closed_contour_starts(start, back, supported):
    t = np.linspace(0, 2 * np.pi, 240, endpoint=False)
    points = 50 + 30 * np.stack([np.cos(t), np.sin(t)], axis=1)
    stamp = (np.arange(240) < supported).astype(np.int32)
    order = np.roll(np.arange(240), start)[:: -1 if back else 1]
    assert continuing(points[order], [0, 240], stamp[order]) == 1.0


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([(-1, 1), (1, -1), (-1, -1)]))
def test_gaps_and_crossings_are_the_same_in_a_mirrored_image(seed, signs):
    generator = np.random.default_rng(seed)
    width, height = 120, 100
    ellipse = np.array([58.3, 47.2, 36.4, 21.9, generator.uniform(0.05, 3.0)])
    points = generator.uniform(2, [width - 3, height - 3], (400, 2))
    angle = generator.uniform(0, 2 * np.pi, 400)
    normals = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    figures = []
    for sx, sy in ((1, 1), signs):
        origin = np.array([width - 1 if sx < 0 else 0, height - 1 if sy < 0 else 0])
        places, across = origin + points * (sx, sy), normals * (sx, sy)
        turn = ellipse[4] if sx == sy else np.pi - ellipse[4]
        image = np.array([*(origin + ellipse[:2] * (sx, sy)), *ellipse[2:4], turn])
        index = index_points(places, across, width, height)
        _, _, gaps = collected(places, across, image, min_cos=0.83)
        claimed = np.zeros(400, bool)
        stamp = np.zeros(400, np.int64)
        count = clutter.count_crossings(index, image, claimed, stamp, 1, np.ones(400), 1.0)
        figures.append((gaps, count))
    assert figures[0] == figures[1]


def test_an_edge_across_the_end_of_a_gap_explains_it():
    points, normals, circle = upper_half()
    assert collected(points, normals, circle)[2] == 1.0
    y = np.full(20, 53.0)  # a horizontal edge under the half circle's right end
    x = np.arange(80.0, 100.0)
    crossed = np.concatenate([points, np.stack([x, y], axis=1)])
    across = np.concatenate([normals, np.tile([0.0, 1.0], (20, 1))])
    assert collected(crossed, across, circle)[2] == 0.5


def test_a_whole_outline_has_no_ends():
    t = np.linspace(0, 2 * np.pi, 240, endpoint=False)
    normals = np.stack([np.cos(t), np.sin(t)], axis=1)
    circle = np.array([60.0, 50.0, 30.0, 30.0, 0.0])
    assert collected(circle[:2] + 30 * normals, normals, circle)[2] == 0.0


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(1.0, 6.0))
def test_support_is_what_lies_near_a_place_along_the_normal(seed, stride):
    generator = np.random.default_rng(seed)
    ellipse = np.array([58.3, 47.2, 36.4, generator.uniform(8, 36), generator.uniform(0, 3.1)])
    t = generator.uniform(0, 2 * np.pi, 300)
    points = points_of(ellipse, 0.0, 6.3, 300) + generator.normal(0, 1.0, (300, 2))
    normals = np.stack([np.cos(t), np.sin(t)], axis=1)
    chosen, sums, _ = collected(points, normals, ellipse, stride)
    x, y, a, b, angle = ellipse
    places = np.empty((3, int(2 * a) + 30))
    ring = places[:, : places_of.quarter_of(a, b, stride, places)]
    u, v = np.outer([a, -a, a, -a], ring[0]), np.outer([b, b, -b, -b], ring[1])
    cos, sin = np.cos(angle), np.sin(angle)
    pixels = np.floor(np.stack([x + u * cos - v * sin, y + u * sin + v * cos], axis=-1) + 0.5)
    offsets = np.array(
        [fit.offset_of(ellipse, cos, sin, *point) for point in points]
    )  # distance, normal
    along = np.abs((offsets[:, 1:] * normals).sum(axis=1)) >= 0.96
    near = np.abs(np.floor(points + 0.5) - pixels[..., np.newaxis, :]).max(axis=-1) <= 1
    good = along & (np.abs(offsets[:, 0]) <= 2.0)
    assert sorted(chosen) == np.flatnonzero(good & near.any(axis=(0, 1))).tolist()
    assert sums[outline.COVERED] == (near & good).any(axis=-1).sum()
    assert sums[outline.STEPS] == sums[outline.IN_FRAME] == pixels[..., 0].size


def test_a_sketch_spreads_each_glance_over_the_quarter():
    places = np.empty((3, places_of.SKETCH))
    for ratio in (0.05, 0.3, 1.0):
        assert places_of.sketch_of(100.0, 100.0 * ratio, places) == places_of.SKETCH
        assert np.allclose(np.hypot(places[0], places[1]), 1.0)
        if ratio >= 0.3:  # the tip of a flat ellipse turns within a step
            assert np.isclose(places[2].sum(), np.pi / 2, rtol=0.03)
        for count in places_of.GLANCES:
            t = np.sort(np.arctan2(places[1, :count], places[0, :count]))
            path = np.interp(t, *path_of_quarter(ratio))
            assert np.diff(path, prepend=0.0, append=1.0).max() < 1.6 / count


def path_of_quarter(ratio):
    """Return parameters on a quarter of an ellipse and the share of its length up to each."""
    t = np.linspace(0, np.pi / 2, 2000)
    path = np.cumsum(np.hypot(np.sin(t), ratio * np.cos(t)))
    return t, path / path[-1]


def count_of_line_through_circle(claimed, heights, full):
    """Return what is counted of a line that crosses a circle on both sides, at x = 30 and 90."""
    circle = np.array([60.0, 50.0, 30.0, 30.0, 0.0])
    points = np.stack([np.arange(20.0, 100.0), np.full(80, 50.0)], axis=1)
    normals = np.tile([0.0, 1.0], (80, 1))
    index = index_points(points, normals, 120, 100)
    stamp = np.zeros(80, np.int64)
    return clutter.count_crossings(index, circle, claimed, stamp, 1, heights, full)


def test_only_crossing_points_that_nothing_claims_are_counted():
    claimed = np.zeros(80, bool)
    assert count_of_line_through_circle(claimed, np.ones(80), 1.0) == 6  # three pixels a side
    claimed[40:] = True
    assert count_of_line_through_circle(claimed, np.ones(80), 1.0) == 3


def test_crossing_points_count_in_proportion_to_their_height_up_to_the_full_one():
    none = np.zeros(80, bool)
    heights = np.where(np.arange(80) < 40, 2.0, 50.0)
    assert count_of_line_through_circle(none, heights, 8.0) == pytest.approx(3 * 0.25 + 3)
    assert count_of_line_through_circle(none, heights, 0.0) == 6
