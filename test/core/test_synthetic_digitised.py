"""Digitised curves: thin, 8-connected, near the curve, with the tangent at the nearest point."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.digital import is_digital_straight
from geoprim_core.errors import InputError
from geoprim_core.synthetic import digital_circle, digital_ellipse, digitise, flower_curve

CENTRES = st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))


def steps(curve):
    return np.abs(np.diff(np.vstack([curve.points, curve.points[:1]]), axis=0)).max(axis=1)


@given(radius=st.floats(3.0, 60.0), centre=CENTRES)
@settings(max_examples=40, deadline=None)
def test_a_circle_is_thin_and_its_tangents_are_those_of_the_foot_points(radius, centre):
    circle = digital_circle(radius, centre)
    assert (steps(circle) == 1).all()
    x, y = (circle.points - centre).T
    assert np.abs(np.hypot(x, y) - radius).max() <= 0.5
    turn = circle.tangent - np.arctan2(x, -y)
    assert np.abs((turn + np.pi) % (2 * np.pi) - np.pi).max() < 1e-7


@given(
    axes=st.tuples(st.floats(20.0, 60.0), st.floats(20.0, 60.0)),
    angle=st.floats(0.0, np.pi),
    centre=CENTRES,
)
@settings(max_examples=30, deadline=None)
def test_an_ellipse_is_met_at_right_angles_by_the_way_to_its_pixels(axes, angle, centre):
    ellipse = digital_ellipse(*axes, angle, centre)
    assert (steps(ellipse) == 1).all()
    t, (a, b) = ellipse.parameter, axes
    c, s = np.cos(angle), np.sin(angle)
    foot = np.stack([a * np.cos(t) * c - b * np.sin(t) * s, a * np.cos(t) * s + b * np.sin(t) * c])
    way = ellipse.points - (foot.T + centre)
    assert (np.hypot(*way.T) <= 0.5 + 1e-9).all()
    along = way[:, 0] * np.cos(ellipse.tangent) + way[:, 1] * np.sin(ellipse.tangent)
    assert np.abs(along).max() < 1e-3


@pytest.mark.parametrize("lobes", [1, 4, 7])
def test_a_flower_has_its_lobes_and_the_tangent_of_its_formula(lobes):
    flower = flower_curve(lobes, centre=(0.2, -0.4))
    assert (steps(flower) == 1).all()
    t, step = flower.parameter, 1e-6

    def point(t):
        r = 100 * (1 - 0.5 * np.sin(lobes * t)) / 1.5
        return np.stack([r * np.cos(t), r * np.sin(t)], axis=1)

    dx, dy = (point(t + step) - point(t - step)).T
    turn = flower.tangent - np.arctan2(dy, dx)
    assert np.abs((turn + np.pi) % (2 * np.pi) - np.pi).max() < 1e-6
    r, place = np.hypot(*(flower.points - (0.2, -0.4)).T), flower.parameter
    for k in range(lobes):
        for start, length in ((1.5, 100.0), (0.5, 100.0 / 3)):  # outermost and innermost points
            where = (start * np.pi + 2 * np.pi * k) / lobes
            assert r[np.argmin(np.abs(place - where))] == pytest.approx(length, abs=1.0)


def test_straight_pieces_are_digital_straight_segments():
    corners = np.array([(0.3, 0.2), (61.7, 17.4), (20.1, 70.6)])
    sides = np.roll(corners, -1, axis=0) - corners

    def side_of(t):
        return np.minimum((t % (2 * np.pi)) * 3 / (2 * np.pi), 3 - 1e-12)

    def curve(t):
        place = side_of(t)
        k = place.astype(int)
        return corners[k] + (place - k)[:, None] * sides[k]

    triangle = digitise(curve, lambda t: sides[side_of(t).astype(int)] * 3 / (2 * np.pi))
    side = side_of(triangle.parameter).astype(int)
    for k in range(3):
        inner = np.flatnonzero(side == k)[2:-2]
        assert len(inner) > 30
        assert is_digital_straight(triangle.points[inner])
        assert triangle.tangent[inner] == pytest.approx(np.arctan2(sides[k, 1], sides[k, 0]))


def test_a_shift_by_whole_pixels_shifts_the_pixels():
    here, there = (
        digital_ellipse(30, 17, 0.4, (0.3, 0.1)),
        digital_ellipse(30, 17, 0.4, (7.3, -4.9)),
    )
    assert np.array_equal(here.points + np.array([7.0, -5.0]), there.points)
    assert there.tangent == pytest.approx(here.tangent, abs=1e-6)


def test_no_pixel_is_lost_where_the_seam_lies_on_a_line_of_the_grid():
    circle = digital_circle(9.0)
    assert [9.0, 0.0] in circle.points.tolist()
    assert {tuple(-p) for p in circle.points} == {tuple(p) for p in circle.points}


def test_wrong_arguments_are_named():
    with pytest.raises(InputError, match="semi_minor"):
        digital_ellipse(10.0, 0.5)
    with pytest.raises(InputError, match="depth"):
        flower_curve(3, depth=1.0)
    with pytest.raises(InputError, match="lobes"):
        flower_curve(0)
