"""Laws that every tangent estimator of the table obeys."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError, ParameterError
from geoprim_core.synthetic.boundaries import trace_boundary
from geoprim_core.tangent import TABLE, estimate_tangents, lambda_mst
from geoprim_core.types import Contours

ROWS = pytest.mark.parametrize("row", list(TABLE), ids=TABLE.names)
SEGMENT_ROWS = {"lambda_mst", "lambda_msg"}
STEPS = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])


@st.composite
def curves(draw: st.DrawFn) -> tuple[np.ndarray, bool]:
    """Draw an 8-connected digital curve that turns by at most 45 degrees a step, or a closed one.

    The second half of a closed one is the first turned by 180 degrees, which leads back.
    """
    turns = draw(st.lists(st.integers(-1, 1), min_size=1, max_size=60))
    codes = (draw(st.integers(0, 7)) + np.cumsum(turns)) % 8
    closed = draw(st.booleans())
    if closed:
        codes = np.concatenate([codes, (codes + 4) % 8])
    curve = np.vstack([np.zeros((1, 2)), STEPS[codes].cumsum(axis=0)])
    return (curve[:-1] if closed else curve), closed


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
@given(drawn=curves(), dx=st.integers(-500, 500))
@settings(max_examples=60, deadline=None)
def test_angles_follow_a_shift_a_turn_a_mirror_and_a_reversal(row, drawn, dx):
    curve, closed = drawn
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
def test_degenerate_curves_have_no_direction(row):
    for closed in (False, True):
        assert row.function(np.zeros((0, 2)), closed=closed, params=None).shape == (0,)
        for points in ([(3, 4)], [(3, 4)] * 6):
            assert np.isnan(row.function(points, closed=closed, params=None)).all()
    there_and_back = row.function([(3, 4), (4, 4)], closed=True, params=None)
    assert np.isnan(there_and_back).all()


@ROWS
def test_two_or_three_pixels_have_the_direction_of_their_line_or_none(row):
    for points in ([(3, 4), (4, 4)], [(3, 4), (4, 4), (5, 4)], [(3, 4), (3, 4), (4, 4)]):
        angle = row.function(points, closed=False, params=None)
        assert (angle[~np.isnan(angle)] == 0.0).all()


@ROWS
def test_a_tiny_closed_curve_is_followed_or_undefined(row):
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    angle = row.function(square, closed=True, params=None)
    before = row.function(np.roll(square, 1, axis=0), closed=True, params=None)
    assert angle.shape == before.shape == (4,)
    known = ~np.isnan(angle)
    steps = np.roll(square, -1, axis=0) - np.roll(square, 1, axis=0)
    expected = np.arctan2(steps[:, 1], steps[:, 0])
    assert (angle_between(angle[known], expected[known]) < np.pi / 4 + 1e-9).all()


@ROWS
def test_a_repeated_pixel_is_no_error(row):
    line = np.repeat(np.arange(60)[:, None] * [1, 0], 2, axis=0)
    angle = row.function(line, closed=False, params=None)
    assert (angle_between(angle[~np.isnan(angle)], 0.0) < 1e-12).all()
    assert not np.isnan(angle[60])


@ROWS
def test_wrong_points_are_refused(row):
    for points in (np.zeros((3, 3)), np.zeros(4), [(0.0, np.nan), (1.0, 1.0)], None):
        with pytest.raises(InputError, match="points"):
            row.function(points, closed=False, params=None)


@ROWS
@given(parts=st.lists(curves(), max_size=4))
@settings(max_examples=30, deadline=None)
def test_estimate_tangents_is_the_method_on_each_contour(row, parts):
    offsets = np.cumsum([0, *(len(curve) for curve, _ in parts)])
    points = np.concatenate([np.zeros((0, 2)), *(curve for curve, _ in parts)])
    contours = Contours(points, offsets, np.array([c for _, c in parts], bool))
    tangents = estimate_tangents(contours, row.name)
    alone = [row.function(curve, closed=closed, params=row.params()) for curve, closed in parts]
    assert np.array_equal(tangents.offsets, offsets)
    assert np.array_equal(tangents.angle, np.concatenate([np.zeros(0), *alone]), equal_nan=True)


def test_there_are_the_73_methods_of_the_thesis():
    """3.6.1: DEB; ten methods with a window, each with six choices of it; two of segments."""
    hybrids = [name for name in TABLE.names if "_h1" in name or name[-3:-1] == "_h"]
    plain = [name for name in TABLE.names if name not in hybrids]
    assert (len(TABLE), len(plain), len(hybrids)) == (73, 13, 60)
    assert {name.rpartition("_h")[0] for name in hybrids} == set(plain) - SEGMENT_ROWS - {"deb"}


@pytest.mark.parametrize("name", sorted(SEGMENT_ROWS))
@pytest.mark.parametrize(("rise", "run"), [(0, 1), (1, 1), (1, 2), (2, 3), (3, 7), (5, 13)])
def test_maximal_segments_are_exact_on_digital_lines(name, rise, run):
    """Two periods of a digital line fix its slope: the segment is the whole line."""
    x = np.arange(3 * run + 1)
    line = np.stack([x, (rise * x) // run], axis=1)
    angle = TABLE[name].function(line, closed=False, params=None)
    assert (angle_between(angle, np.arctan2(rise, run)) < 1e-12).all()


@given(
    st.floats(3.0, 60.0), st.floats(3.0, 60.0), st.floats(0.0, 3.1),
    st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)),
)  # fmt: skip
@settings(max_examples=40, deadline=None)
def test_lambda_mst_keeps_a_convex_curve_convex(a, b, turn, centre):
    """Lachaud, Vialard and de Vieilleville 2007: directions along a convex contour turn one way."""
    y, x = np.mgrid[-65:66, -65:66]
    u, v = x - centre[0], y - centre[1]
    u, v = u * np.cos(turn) + v * np.sin(turn), v * np.cos(turn) - u * np.sin(turn)
    border = trace_boundary((u / a) ** 2 + (v / b) ** 2 <= 1.0)
    assume(len(np.unique(border, axis=0)) == len(border))  # not walked on both sides
    angle = lambda_mst(border, closed=True)
    turns = (np.diff(angle, append=angle[:1]) + np.pi) % (2 * np.pi) - np.pi
    way = np.sign(turns.sum())
    assert abs(turns.sum()) == pytest.approx(2 * np.pi)
    assert (way * turns > -1e-9).all()


def test_unknown_methods_and_foreign_arguments_are_refused():
    with pytest.raises(ParameterError, match="deb"):
        estimate_tangents(Contours([(0, 0)], [0, 1], [False]), "nothing")
    with pytest.raises(InputError, match="contours"):
        estimate_tangents(np.zeros((4, 2)))  # type: ignore[arg-type]
