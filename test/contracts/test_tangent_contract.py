"""Laws that every tangent estimator of the table obeys."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError, ParameterError
from geoprim_core.tangent import TABLE, estimate_tangents
from geoprim_core.types import Contours

ROWS = pytest.mark.parametrize("row", list(TABLE), ids=TABLE.names)
STEPS = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])


@st.composite
def curves(draw: st.DrawFn) -> np.ndarray:
    """Draw an 8-connected digital curve that turns by at most 45 degrees a step."""
    turns = draw(st.lists(st.integers(-1, 1), min_size=1, max_size=60))
    codes = (draw(st.integers(0, 7)) + np.cumsum(turns)) % 8
    return np.vstack([np.zeros((1, 2)), STEPS[codes].cumsum(axis=0)])


def angle_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.abs((a - b + np.pi) % (2 * np.pi) - np.pi)


def digital_circle(radius: float, centre: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    t = np.linspace(0, 2 * np.pi, int(40 * radius), endpoint=False)
    pixels = np.rint(radius * np.stack([np.cos(t), np.sin(t)], axis=1) + centre)
    return pixels[(pixels != np.roll(pixels, 1, axis=0)).any(axis=1)]


def check_turned(found: np.ndarray, expected: np.ndarray) -> None:
    assert np.array_equal(np.isnan(found), np.isnan(expected))
    known = ~np.isnan(found)
    assert (angle_between(found[known], expected[known]) < 1e-12).all()


@ROWS
@given(curve=curves(), closed=st.booleans(), dx=st.integers(-500, 500))
@settings(max_examples=60, deadline=None)
def test_angles_follow_a_shift_a_turn_a_mirror_and_a_reversal(row, curve, closed, dx):
    before = curve.copy()
    angle = row.function(curve, closed=closed, params=None)
    assert angle.shape == (len(curve),)
    known = angle[~np.isnan(angle)]
    assert ((known > -np.pi) & (known <= np.pi)).all()
    check_turned(row.function(curve + np.array([dx, -dx]), closed=closed, params=None), angle)
    turned = np.stack([-curve[:, 1], curve[:, 0]], axis=1)
    check_turned(row.function(turned, closed=closed, params=None), angle + np.pi / 2)
    check_turned(row.function(curve * [-1, 1], closed=closed, params=None), np.pi - angle)
    backwards = row.function(curve[::-1], closed=closed, params=None)[::-1]
    check_turned(backwards, angle + np.pi)
    assert np.array_equal(curve, before)


@ROWS
@pytest.mark.parametrize("code", range(8))
def test_a_line_has_the_direction_of_travel(row, code):
    line = np.arange(41)[:, None] * STEPS[code]
    angle = row.function(line, closed=False, params=None)
    expected = np.arctan2(STEPS[code][1], STEPS[code][0])
    assert abs(angle[20] - expected) < 1e-12
    assert (angle_between(angle[~np.isnan(angle)], expected) < 1e-12).all()


@ROWS
def test_a_circle_is_followed_all_round(row):
    centre = (50.3, 40.8)
    circle = digital_circle(60, centre)
    angle = row.function(circle, closed=True, params=None)
    offset = circle - centre
    truth = np.arctan2(offset[:, 0], -offset[:, 1])
    assert angle_between(angle, truth).mean() < np.radians(6)


@ROWS
def test_number_types_do_not_matter(row):
    circle = digital_circle(17)
    angle = row.function(circle, closed=True, params=None)
    for values in (circle.astype(np.float32), circle.astype(np.int32), circle.tolist()):
        assert np.array_equal(row.function(values, closed=True, params=None), angle)


@ROWS
def test_degenerate_curves_are_undefined(row):
    for closed in (False, True):
        assert row.function(np.zeros((0, 2)), closed=closed, params=None).shape == (0,)
        for points in ([(3, 4)], [(3, 4), (4, 4)], [(3, 4)] * 6):
            assert np.isnan(row.function(points, closed=closed, params=None)).all()


@ROWS
def test_wrong_points_are_refused(row):
    for points in (np.zeros((3, 3)), np.zeros(4), [(0.0, np.nan), (1.0, 1.0)], None):
        with pytest.raises(InputError, match="points"):
            row.function(points, closed=False, params=None)


@ROWS
@given(parts=st.lists(st.tuples(curves(), st.booleans()), max_size=5))
@settings(max_examples=30, deadline=None)
def test_estimate_tangents_is_the_method_on_each_contour(row, parts):
    offsets = np.cumsum([0, *(len(curve) for curve, _ in parts)])
    points = np.concatenate([np.zeros((0, 2)), *(curve for curve, _ in parts)])
    contours = Contours(points, offsets, np.array([c for _, c in parts], bool))
    tangents = estimate_tangents(contours, row.name)
    alone = [row.function(curve, closed=closed, params=row.params()) for curve, closed in parts]
    assert np.array_equal(tangents.offsets, offsets)
    assert np.array_equal(tangents.angle, np.concatenate([np.zeros(0), *alone]), equal_nan=True)


def test_unknown_methods_and_foreign_arguments_are_refused():
    with pytest.raises(ParameterError, match="deb"):
        estimate_tangents(Contours([(0, 0)], [0, 1], [False]), "nothing")
    with pytest.raises(InputError, match="contours"):
        estimate_tangents(np.zeros((4, 2)))  # type: ignore[arg-type]
