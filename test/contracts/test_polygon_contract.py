"""Laws that every polygonal approximation of the table obeys."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError, ParameterError
from geoprim_core.polygon import TABLE, approximate
from geoprim_core.types import Contours

ROWS = pytest.mark.parametrize("row", list(TABLE), ids=TABLE.names)
STEPS = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])


@st.composite
def curves(draw: st.DrawFn) -> np.ndarray:
    """Draw an 8-connected digital curve of at most 60 pixels."""
    codes = draw(st.lists(st.integers(0, 7), min_size=0, max_size=59))
    return np.vstack([np.zeros((1, 2)), STEPS[codes].cumsum(axis=0)]) if codes else np.zeros((1, 2))


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
    assert row.function(arms, closed=False, params=None).tolist() == [0, first, last]
    assert row.function(arms[::-1], closed=False, params=None).tolist() == [0, second, last]


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


def test_unknown_methods_and_foreign_arguments_are_refused():
    contours = Contours([(0, 0)], [0, 1], [False])
    with pytest.raises(ParameterError, match="rdp_mod"):
        approximate(contours, "nothing")
    with pytest.raises(InputError, match="contours"):
        approximate(np.zeros((4, 2)))  # type: ignore[arg-type]
