"""Laws that every polygonal approximation of the table obeys."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError, ParameterError
from geoprim_core.evaluation import measure_polygon
from geoprim_core.polygon import (
    TABLE,
    OptimalParams,
    PolygonParams,
    approximate,
    deviation_bound,
    optimal,
)
from geoprim_core.types import Contours

ROWS = pytest.mark.parametrize("row", list(TABLE), ids=TABLE.names)
# Methods that end with the polygon that violates their limit (errata P7, P8): the last corner
# goes as well, unless such deletions are refused.
REFUSING = {"masood": {"refuse": True}, "carmona_mod": {"refuse": True}}
# r_i of (2-65) is a ratio of lengths: the only corner of a curve passes for any size.
WITHOUT_LAST_CORNER = {"carmona"}
# `optimal` refuses more than 40 million states, vertices times pixels: what is exact is not for
# such lengths.
LENGTHS = {"optimal": 3_000}
# Parameters under which a digital straight segment is two points. The others judge by an area
# (visvalingam), by every change of direction (break_points), by local extrema (teh_chin) or by
# r_i (carmona).
STRAIGHT = {
    "rdp": {},
    "rdp_mod": {"bound": "exact"},
    "pro": {},
    "masood": {"tolerance": 1.0, "refuse": True},
    "masood_mod": {"bound": "exact", "refuse": True},
    "carmona_mod": {"bound": "exact", "refuse": True},
    "lowe": {},
    "optimal": {},
    "blurred_segments": {"bound": "exact"},
}
# The same of a 4-connected segment, whose pixels lie up to sqrt(2) from its chord; along an axis
# it is up to 2 pixels thick.
STRAIGHT_4 = STRAIGHT | {
    "rdp": {"tolerance": 1.5},
    "masood": {"tolerance": 2.0, "refuse": True},
    "optimal": {"tolerance": 1.5},
    "blurred_segments": {"width": 2.0},
}
STEPS = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])


@st.composite
def curves(draw: st.DrawFn) -> np.ndarray:
    """Draw a curve of at most 60 points: 8- or 4-connected pixels, semi-digital, or neither.

    Coordinates off the grid are multiples of 1/16, so that a shift or a turn changes no digit.
    """
    if draw(st.booleans()):
        allowed = draw(st.sampled_from([(0, 1, 2, 3, 4, 5, 6, 7), (0, 2, 4, 6)]))
        steps = STEPS[draw(st.lists(st.sampled_from(allowed), max_size=59))]
    else:
        whole, off = st.integers(-3, 3).map(lambda k: 16 * k), st.integers(-48, 48)
        first = draw(st.sampled_from([whole, off]))
        steps = np.array(draw(st.lists(st.tuples(first, off), max_size=59))).reshape(-1, 2) / 16
    return np.vstack([np.zeros((1, 2)), steps.reshape(-1, 2).cumsum(axis=0)])


def digital_circle(radius: float) -> np.ndarray:
    t = np.linspace(0, 2 * np.pi, int(40 * radius), endpoint=False)
    pixels = np.rint(radius * np.stack([np.cos(t), np.sin(t)], axis=1))
    return pixels[(pixels != np.roll(pixels, 1, axis=0)).any(axis=1)]


@ROWS
@given(curve=curves(), closed=st.booleans())
@settings(max_examples=60, deadline=None)
def test_indices_increase_and_an_open_curve_keeps_its_ends(row, curve, closed):
    before = curve.copy()
    indices = row.function(curve, closed=closed, params=None)
    assert indices.dtype == np.int64
    assert (np.diff(indices) > 0).all()
    assert indices[0] >= 0 and indices[-1] < len(curve)
    if not closed:
        assert indices[0] == 0 and indices[-1] == len(curve) - 1
    assert np.array_equal(curve, before)


@ROWS
@given(curve=curves(), closed=st.booleans(), dx=st.integers(-500, 500), dy=st.integers(-500, 500))
@settings(max_examples=40, deadline=None)
def test_a_shift_a_quarter_turn_and_a_mirror_change_nothing(row, curve, closed, dx, dy):
    indices = row.function(curve, closed=closed, params=None)
    for moved in (
        curve + np.array([dx, dy]),
        np.stack([-curve[:, 1], curve[:, 0]], axis=1),
        curve * [-1, 1],
    ):
        assert np.array_equal(row.function(moved, closed=closed, params=None), indices)


@ROWS
@given(first=st.integers(8, 60), second=st.integers(8, 60))
@settings(max_examples=20, deadline=None)
def test_a_corner_is_found_from_both_ends(row, first, second):
    # Ties may fall differently on a reversed curve; a corner has none.
    arms = np.vstack(
        [[(i, 0) for i in range(first + 1)], [(first, j) for j in range(1, second + 1)]]
    )
    last = first + second
    if row.name in WITHOUT_LAST_CORNER:
        return
    params = row.params.from_dict(REFUSING.get(row.name, {}))
    assert row.function(arms, closed=False, params=params).tolist() == [0, first, last]
    assert row.function(arms[::-1], closed=False, params=params).tolist() == [0, second, last]


@ROWS
def test_number_types_do_not_matter(row):
    circle = digital_circle(17)
    indices = row.function(circle, closed=True, params=None)
    for values in (circle.astype(np.float32), circle.astype(np.int32), circle.tolist()):
        assert np.array_equal(row.function(values, closed=True, params=None), indices)


@ROWS
@pytest.mark.parametrize("dx, dy", [(40, 0), (0, -40), (25, 25), (-25, 25)])
def test_an_axis_or_diagonal_line_needs_two_points(row, dx, dy):
    count = max(abs(dx), abs(dy))
    line = np.arange(count + 1)[:, None] * [np.sign(dx), np.sign(dy)]
    assert row.function(line, closed=False, params=None).tolist() == [0, count]


@ROWS
@given(dx=st.integers(-200, 200), dy=st.integers(-200, 200))
@settings(max_examples=40, deadline=None)
def test_a_digital_straight_segment_of_any_slope_needs_two_points(row, dx, dy):
    if row.name not in STRAIGHT or (dx, dy) == (0, 0):
        return
    count = max(abs(dx), abs(dy))
    line = np.rint(np.arange(count + 1)[:, None] / count * [dx, dy])
    params = row.params.from_dict(STRAIGHT[row.name])
    assert row.function(line, closed=False, params=params).tolist() == [0, count]


@ROWS
@given(dx=st.integers(-150, 150), dy=st.integers(-150, 150))
@settings(max_examples=40, deadline=None)
def test_a_4_connected_straight_segment_of_any_slope_needs_two_points(row, dx, dy):
    if row.name not in STRAIGHT_4 or (dx, dy) == (0, 0):
        return
    # Of two steps the one that leaves the pixel nearer to the line, in whole numbers.
    x = y = 0
    line = [(0, 0)]
    while (x, y) != (abs(dx), abs(dy)):
        if x < abs(dx) and (y == abs(dy) or (2 * y + 1) * abs(dx) >= (2 * x + 1) * abs(dy)):
            x += 1
        else:
            y += 1
        line.append((x, y))
    line = np.array(line) * [np.sign(dx), np.sign(dy)]
    params = row.params.from_dict(STRAIGHT_4[row.name])
    assert row.function(line, closed=False, params=params).tolist() == [0, len(line) - 1]


def pieces(curve, indices, closed):
    """Yield the part of a curve of every edge of its polygon, both ends included."""
    for i, j in itertools.pairwise(indices):
        yield curve[i : j + 1]
    if closed:
        yield np.vstack([curve[indices[-1] :], curve[: indices[0] + 1]])


def deviations(piece):
    chord = piece[-1] - piece[0]
    away = piece - piece[0]
    length = np.hypot(*chord)
    if length == 0:
        return np.hypot(*away.T)
    return np.abs(chord[0] * away[:, 1] - chord[1] * away[:, 0]) / length


# What a method promises of each edge: largest deviation in pixels. (PRO promises means, blurred
# segments a thickness: core/test_polygon_truths.py, core/test_blurred_segments.py.)
PROMISES = {
    "optimal": ({"tolerance": 1.3}, lambda a, b: 1.3),
    "rdp": ({"tolerance": 1.5}, lambda a, b: 1.5),
    "rdp_mod": ({"bound": "exact"}, lambda a, b: deviation_bound(a, b, "exact")),
    "masood": ({"refuse": True}, lambda a, b: np.sqrt(0.9)),
    "masood_mod": (
        {"bound": "exact", "refuse": True},
        lambda a, b: deviation_bound(a, b, "exact"),
    ),
    "carmona_mod": (
        {"bound": "exact", "refuse": True},
        lambda a, b: deviation_bound(a, b, "exact"),
    ),
    "break_points": ({}, lambda a, b: 0.0),
}


@ROWS
@given(curve=curves(), closed=st.booleans(), scale=st.sampled_from([1.0, 0.37, 12.3]))
@settings(max_examples=60, deadline=None)
def test_the_promised_tolerance_holds(row, curve, closed, scale):
    if row.name not in PROMISES:
        return
    values, limit = PROMISES[row.name]
    curve = curve * [scale, 1.0]  # digital, and digital in y only
    indices = row.function(curve, closed=closed, params=row.params.from_dict(values))
    for piece in pieces(curve, indices, closed):
        # two neighbouring points are an edge under any bound; so is a break of direction
        if len(piece) > 2:
            assert deviations(piece).max() <= limit(piece[0], piece[-1]) + 1e-9


@ROWS
@given(curve=curves().filter(lambda c: len(c) > 2), closed=st.booleans())
@settings(max_examples=40, deadline=None)
def test_no_row_beats_the_optimal_polygon_of_as_many_vertices(row, curve, closed):
    rival = row.function(curve, closed=closed, params=None)
    if len(rival) < 2:  # a closed curve that is one point
        return
    error = measure_polygon(curve, rival, closed=closed)
    for measure, name in (("ise", "ise"), ("max_deviation", "max_deviation")):
        best = optimal(curve, closed=closed, params=OptimalParams(len(rival), measure=measure))
        least = getattr(measure_polygon(curve, best, closed=closed), name)
        assert least <= getattr(error, name) * (1 + 1e-6) + 1e-6
        assert len(best) <= len(rival)


def zigzag(count):
    k = np.arange(count)
    return np.stack([k, k % 2 * np.minimum(k, 40)], axis=1).astype(float)


def wave(count):
    k = np.arange(count)
    return np.stack([k, np.rint(300 * np.sin(k / 500.0))], axis=1)


@ROWS
@pytest.mark.parametrize("curve", [zigzag, wave])
def test_long_curves_are_no_recursion(row, curve):
    count = LENGTHS.get(row.name, 100_000)
    indices = row.function(curve(count), closed=False, params=None)
    assert indices[0] == 0 and indices[-1] == count - 1
    assert (np.diff(indices) > 0).all()


@ROWS
def test_repeated_points_and_collinear_closed_curves(row):
    arm = [(x, 0) for x in range(20) for _ in range(3)]
    indices = row.function(arm, closed=False, params=None)
    assert indices[0] == 0 and indices[-1] == len(arm) - 1
    assert {tuple(arm[i]) for i in indices} == {(0, 0), (19, 0)}
    for closed in (False, True):
        assert row.function([(0, 0), (1, 0), (1, 1)], closed=closed, params=None)[0] == 0
    assert row.function([(3, 4)] * 5, closed=True, params=None).tolist() == [0]
    there_and_back = [(x, x) for x in range(30)] + [(x, x) for x in range(28, 0, -1)]
    assert row.function(there_and_back, closed=True, params=None).tolist() == [0, 29]


@ROWS
def test_degenerate_curves(row):
    call = row.function
    for closed in (False, True):
        assert call(np.zeros((0, 2)), closed=closed, params=None).tolist() == []
        assert call([(3, 4)], closed=closed, params=None).tolist() == [0]
        assert call([(3, 4), (4, 4)], closed=closed, params=None).tolist() == [0, 1]
    assert call([(3, 4)] * 5, closed=False, params=None).tolist() == [0, 4]
    there_and_back = [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (3, 0), (2, 0), (1, 0)]
    assert call(there_and_back, closed=True, params=None).tolist() == [0, 4]


@ROWS
def test_wrong_points_are_refused(row):
    for points in (np.zeros((3, 3)), np.zeros(4), [(0.0, np.nan), (1.0, 1.0)], "abc", None):
        with pytest.raises(InputError, match="points"):
            row.function(points, closed=False, params=None)


@ROWS
@given(parts=st.lists(st.tuples(curves(), st.booleans()), max_size=5))
@settings(max_examples=30, deadline=None)
def test_approximate_is_the_method_on_each_contour(row, parts):
    offsets = np.cumsum([0, *(len(curve) for curve, _ in parts)])
    points = np.concatenate([np.zeros((0, 2)), *(curve for curve, _ in parts)])
    contours = Contours(points, offsets, np.array([c for _, c in parts], bool), (640, 480))
    polygons = approximate(contours, row.name)
    assert polygons.image_size == (640, 480)
    assert len(polygons) == len(parts)
    for k, (curve, closed) in enumerate(parts):
        alone = row.function(curve, closed=closed, params=row.params())
        assert np.array_equal(polygons[k], alone)
        assert bool(polygons.closed[k]) == closed


def test_empty_contours_inside_a_set_give_empty_polygons():
    contours = Contours([(0, 0), (1, 0)], [0, 0, 2, 2], [True, False, False])
    polygons = approximate(contours)
    assert polygons.offsets.tolist() == [0, 0, 2, 2]


def test_every_method_has_its_group_of_parameters():
    for row in TABLE:
        assert type(PolygonParams().of(row.name)) is row.params


def test_unknown_methods_and_foreign_arguments_are_refused():
    contours = Contours([(0, 0)], [0, 1], [False])
    with pytest.raises(ParameterError, match="rdp_mod"):
        approximate(contours, "nothing")
    with pytest.raises(InputError, match="contours"):
        approximate(np.zeros((4, 2)))  # type: ignore[arg-type]
