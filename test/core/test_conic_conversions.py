"""Ellipse <-> conic of thesis (4-1)."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError
from geoprim_core.fitting import conic_from_ellipse, ellipse_from_conic, point_at
from geoprim_core.types import Ellipse


def misfit(a: Ellipse, b: Ellipse) -> float:
    turn = abs((a.angle - b.angle + np.pi / 2) % np.pi - np.pi / 2)
    return max(
        np.hypot(a.x - b.x, a.y - b.y) / a.semi_major,
        abs(a.semi_major - b.semi_major) / a.semi_major,
        abs(a.semi_minor - b.semi_minor) / a.semi_major,
        turn * (a.semi_major - a.semi_minor) / a.semi_major,
    )


@given(
    x=st.floats(-1, 1),
    y=st.floats(-1, 1),
    major=st.floats(0.5, 500),
    ratio=st.floats(0.3, 1),
    angle=st.floats(0, 3.1415),
    scale=st.floats(-100, 100).filter(lambda s: abs(s) > 0.01),
)
@settings(max_examples=200, deadline=None)
def test_round_trip_at_any_scale_and_sign(x, y, major, ratio, angle, scale):
    truth = Ellipse(x * major, y * major, major, major * ratio, angle)
    fit = ellipse_from_conic(scale * conic_from_ellipse(truth))
    assert misfit(truth, fit.ellipse) < 1e-12


@given(distance=st.floats(0, 100), ratio=st.floats(1e-3, 1), angle=st.floats(0, 3.1415))
@settings(max_examples=200, deadline=None)
def test_round_trip_of_far_and_thin_ellipses_is_as_good_as_six_doubles_allow(
    distance, ratio, angle
):
    # Rounding of the coefficients alone moves the ellipse by about this much.
    truth = Ellipse(distance, -0.5 * distance, 1.0, ratio, angle)
    fit = ellipse_from_conic(conic_from_ellipse(truth))
    assert misfit(truth, fit.ellipse) < 1e-14 * (1 + distance / ratio) ** 2 / ratio**2


@given(
    x=st.floats(-1e6, 1e6),
    y=st.floats(-1e6, 1e6),
    major=st.floats(0.5, 500),
    ratio=st.floats(0.05, 1),
    angle=st.floats(0, 3.1415),
)
@settings(max_examples=200, deadline=None)
def test_about_an_origin_near_by_far_ellipses_come_back_too(x, y, major, ratio, angle):
    truth = Ellipse(x, y, major, major * ratio, angle)
    origin = (np.floor(x), np.floor(y))
    fit = ellipse_from_conic(conic_from_ellipse(truth, origin), origin)
    assert misfit(truth, fit.ellipse) < 1e-12 / ratio**2 * (1 + 1 / (major * ratio)) ** 2


@given(x=st.floats(-500, 500), y=st.floats(-500, 500), radius=st.floats(0.5, 500))
@settings(max_examples=100, deadline=None)
def test_a_circle_comes_back_with_the_angle_zero(x, y, radius):
    fit = ellipse_from_conic(conic_from_ellipse(Ellipse(x, y, radius, radius, 1.2)))
    assert fit.ellipse.angle == 0.0
    assert fit.ellipse.semi_major == fit.ellipse.semi_minor


def test_the_conic_is_zero_on_the_outline_and_minus_one_at_the_centre():
    ellipse = Ellipse(12, -7, 9, 4, 2.2)
    a, b, c, d, f, g = conic_from_ellipse(ellipse)
    for t in (0.0, 1.0, 2.0, 4.5):
        x, y = point_at(ellipse, t)
        assert abs(a * x * x + b * x * y + c * y * y + d * x + f * y + g) < 1e-12
    x, y = ellipse.x, ellipse.y
    assert a * x * x + b * x * y + c * y * y + d * x + f * y + g == pytest.approx(-1, abs=1e-12)


def test_angle_turns_from_x_towards_y():
    # x y = const > 0 bends along the diagonal: 5 x^2 - 6 x y + 5 y^2 = 8 has its axis at 45 deg.
    fit = ellipse_from_conic([5, -6, 5, 0, 0, -8])
    assert fit.ellipse.angle == pytest.approx(np.pi / 4, abs=1e-15)
    assert fit.ellipse.semi_major == pytest.approx(2.0)
    assert fit.ellipse.semi_minor == pytest.approx(1.0)


@pytest.mark.parametrize(
    "conic, reason",
    [
        ([1, 0, -1, 0, 0, -1], "hyperbola"),
        ([0, 1, 0, 0, 0, -1], "hyperbola"),
        ([1, 0, 0, 0, -1, 0], "parabola"),
        ([0, 0, 0, 1, 1, 0], "parabola"),
        ([0, 0, 0, 0, 0, 0], "parabola"),
        ([1, 0, 1, 0, 0, 1], "no real points"),
        ([1, 0, 1, 0, 0, 0], "no real points"),
    ],
)
def test_what_is_no_ellipse_is_a_value_with_a_reason(conic, reason):
    fit = ellipse_from_conic(conic)
    assert fit.ellipse is None and fit.conic is None
    assert reason in fit.reason


def test_wrong_arguments_are_named():
    with pytest.raises(InputError, match="conic"):
        ellipse_from_conic([1, 2, 3])
    with pytest.raises(InputError, match="ellipse"):
        conic_from_ellipse((1, 2, 3, 4, 5))  # type: ignore[arg-type]
