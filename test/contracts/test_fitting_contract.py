"""Laws that every ellipse fit of the table obeys."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError, ParameterError
from geoprim_core.fitting import TABLE, fit_ellipse, overlap_ratio, point_at
from geoprim_core.types import Ellipse

ROWS = pytest.mark.parametrize("row", list(TABLE), ids=TABLE.names)

ELLIPSES = st.builds(
    lambda x, y, major, ratio, angle: Ellipse(x, y, major, major * ratio, angle),
    st.floats(-500, 1500),
    st.floats(-500, 1500),
    st.floats(3, 300),
    st.floats(0.1, 1.0),
    st.floats(0, 3.14),
)


def arc(ellipse: Ellipse, start: float, extent: float, count: int = 40) -> np.ndarray:
    return point_at(ellipse, np.linspace(start, start + extent, count))


def same(a: Ellipse, b: Ellipse, tolerance: float) -> bool:
    size = max(a.semi_major, b.semi_major)
    near = np.hypot(a.x - b.x, a.y - b.y) <= tolerance * size
    near &= abs(a.semi_major - b.semi_major) <= tolerance * size
    near &= abs(a.semi_minor - b.semi_minor) <= tolerance * size
    turn = abs((a.angle - b.angle + np.pi / 2) % np.pi - np.pi / 2)
    return bool(near and turn * (a.semi_major - a.semi_minor) <= tolerance * size)


@ROWS
@given(ellipse=ELLIPSES, start=st.floats(0, 6.28), extent=st.floats(2.0, 6.2))
@settings(max_examples=80, deadline=None)
def test_points_on_an_ellipse_give_that_ellipse(row, ellipse, start, extent):
    points = arc(ellipse, start, extent)
    before = points.copy()
    fit = row.function(points, params=None)
    assert fit.reason == ""
    assert same(fit.ellipse, ellipse, 1e-7)
    assert fit.residual < 1e-9
    assert np.array_equal(points, before)


@ROWS
@given(ellipse=ELLIPSES, extent=st.floats(3.2, 6.2), seed=st.integers(0, 999))
@settings(max_examples=40, deadline=None)
def test_the_fit_moves_turns_mirrors_and_grows_with_the_points(row, ellipse, extent, seed):
    noise = np.random.default_rng(seed).normal(0, 0.01 * ellipse.semi_minor, (40, 2))
    points = arc(ellipse, 0.5, extent) + noise
    fit = row.function(points, params=None)
    found = fit.ellipse
    moved = row.function(3.0 * points + [70, -20], params=None)
    expected = Ellipse(
        3 * found.x + 70, 3 * found.y - 20, 3 * found.semi_major, 3 * found.semi_minor, found.angle
    )
    assert same(moved.ellipse, expected, 1e-6)
    assert moved.residual == pytest.approx(fit.residual, rel=1e-6)
    mirrored = row.function(points * [-1, 1], params=None).ellipse
    opposite = Ellipse(
        -found.x, found.y, found.semi_major, found.semi_minor, (np.pi - found.angle) % np.pi
    )
    assert same(mirrored, opposite, 1e-6)
    assert same(row.function(points[::-1], params=None).ellipse, found, 1e-6)


@ROWS
@given(ellipse=ELLIPSES)
@settings(max_examples=20, deadline=None)
def test_a_quarter_turn_of_exact_points_turns_the_ellipse(row, ellipse):
    points = arc(ellipse, 1.0, 4.0)
    turned = np.stack([-points[:, 1], points[:, 0]], axis=1)
    angle = (ellipse.angle + np.pi / 2) % np.pi
    expected = Ellipse(-ellipse.y, ellipse.x, ellipse.semi_major, ellipse.semi_minor, angle)
    assert same(row.function(turned, params=None).ellipse, expected, 1e-7)


@ROWS
@given(ellipse=ELLIPSES, seed=st.integers(0, 999))
@settings(max_examples=30, deadline=None)
def test_conic_and_residual_agree_with_the_ellipse(row, ellipse, seed):
    noise = np.random.default_rng(seed).normal(0, 0.02 * ellipse.semi_minor, (50, 2))
    points = arc(ellipse, 0.0, 6.0, 50) + noise
    fit = row.function(points, params=None)
    a, b, c, d, f, g = fit.conic
    x, y = points.T
    values = a * x * x + b * x * y + c * y * y + d * x + f * y + g
    assert np.sqrt((values**2).mean()) == pytest.approx(fit.residual, rel=1e-4, abs=1e-6)
    on = point_at(fit.ellipse, [0.1, 1.0, 2.5])
    at = np.array([p @ [[a, b / 2], [b / 2, c]] @ p + [d, f] @ p + g for p in on])
    assert (np.abs(at) < 1e-6).all()


@ROWS
def test_a_circle_has_the_angle_zero(row):
    fit = row.function(arc(Ellipse(310, 205, 40, 40, 0), 0.0, 6.0), params=None)
    assert fit.ellipse.angle == 0.0
    assert fit.ellipse.semi_major == pytest.approx(fit.ellipse.semi_minor, rel=1e-12)


@ROWS
@pytest.mark.parametrize("arguments", [np.int32, np.float32, list])
def test_number_types_do_not_matter(row, arguments):
    pixels = np.rint(arc(Ellipse(60, 40, 30, 20, 0.4), 0.0, 6.0))
    values = pixels.tolist() if arguments is list else pixels.astype(arguments)
    assert row.function(values, params=None).ellipse == row.function(pixels, params=None).ellipse


@ROWS
def test_ordinary_failures_are_values_with_a_reason(row):
    five = [(10, 0), (0, 5), (-10, 0), (0, -5)]
    cases = {
        "fewer than five distinct points": [np.zeros((0, 2)), [(1, 2)], five, five * 10],
        "straight line": [
            [(i, 2 * i + 1) for i in range(20)],
            [(7, i) for i in range(20)],
            [(0.1 * i, 0.3 * i + 1000) for i in range(20)],
        ],
        "more than one conic free": [[(i, 0) for i in range(5)] + [(2, 1)]],
    }
    for reason, inputs in cases.items():
        for points in inputs:
            fit = row.function(points, params=None)
            assert fit.ellipse is None and fit.conic is None and np.isnan(fit.residual)
            assert reason in fit.reason


@ROWS
def test_five_points_suffice(row):
    truth = Ellipse(20, 30, 15, 8, 0.7)
    fit = row.function(point_at(truth, [0.0, 1.0, 2.5, 3.5, 5.0]), params=None)
    assert same(fit.ellipse, truth, 1e-9)


@ROWS
def test_a_digitised_ellipse_overlaps_the_true_one(row):
    truth = Ellipse(70.3, 50.6, 45, 20, 0.9)
    pixels = np.rint(arc(truth, 0.0, 6.28, 400))
    assert overlap_ratio(row.function(pixels, params=None).ellipse, truth) > 0.97


@ROWS
def test_wrong_points_are_refused(row):
    for points in (np.zeros((3, 3)), np.zeros(4), [(0.0, np.inf), (1.0, 1.0)], None):
        with pytest.raises(InputError, match="points"):
            row.function(points, params=None)


def test_fit_ellipse_calls_the_method_of_that_name():
    points = arc(Ellipse(20, 30, 15, 8, 0.7), 0, 4) + 0.1 * np.sin(np.arange(80)).reshape(40, 2)
    for row in TABLE:
        assert fit_ellipse(points, row.name).ellipse == row.function(points).ellipse
    assert fit_ellipse(points).ellipse == fit_ellipse(points, "ellifit").ellipse
    with pytest.raises(ParameterError, match="nsaf, ellifit"):
        fit_ellipse(points, "nothing")
