"""Rendered discs and ellipses are where, and as large as, they are said to be."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError
from geoprim_core.fitting.shape import perimeter, point_at
from geoprim_core.synthetic import (
    disc_image,
    ellipse_image,
    render_ellipses,
    render_parity,
    visible_shares,
)
from geoprim_core.synthetic._kernels import signed_distance
from geoprim_core.types import Ellipse, Ellipses

CENTRES = st.floats(48, 52)
ELLIPSES = st.builds(
    lambda x, y, a, ratio, angle: Ellipse(x, y, a, a * ratio, angle),
    CENTRES,
    CENTRES,
    st.floats(12, 40),
    st.floats(0.3, 1.0),
    st.floats(0, 3.14),
)


def interpolate(image, points):
    """Return bilinear grey values at points (n, 2)."""
    x, y = points.T
    j, i = np.floor(x).astype(int), np.floor(y).astype(int)
    u, v = x - j, y - i
    upper = (1 - u) * image[i, j] + u * image[i, j + 1]
    lower = (1 - u) * image[i + 1, j] + u * image[i + 1, j + 1]
    return (1 - v) * upper + v * lower


def normals(ellipse, parameter):
    """Return unit outward normals (n, 2) at eccentric angles."""
    u = np.cos(parameter) / ellipse.semi_major
    v = np.sin(parameter) / ellipse.semi_minor
    c, s = np.cos(ellipse.angle), np.sin(ellipse.angle)
    outward = np.stack([u * c - v * s, u * s + v * c], axis=1)
    return outward / np.linalg.norm(outward, axis=1, keepdims=True)


@settings(max_examples=30, deadline=None)
@given(CENTRES, CENTRES, st.floats(15, 45))
def test_the_area_of_a_disc_is_pi_r_squared(x, y, radius):
    image = disc_image(101, 101, centre=(x, y), radius=radius, inside=255, outside=0)
    assert image.sum() / 255.0 == pytest.approx(np.pi * radius**2, rel=2e-3)


@settings(max_examples=30, deadline=None)
@given(ELLIPSES)
def test_the_area_of_an_ellipse_is_pi_a_b(ellipse):
    image = ellipse_image(101, 101, ellipse, inside=255, outside=0)
    area = np.pi * ellipse.semi_major * ellipse.semi_minor
    # of a small ellipse the borders of single pixels show
    assert abs(image.sum() / 255.0 - area) < max(2e-3 * area, 1.0)


@settings(max_examples=30, deadline=None)
@given(ELLIPSES.filter(lambda e: e.semi_minor >= 6))
def test_half_of_the_step_is_reached_on_the_outline(ellipse):
    image = ellipse_image(101, 101, ellipse, inside=200, outside=0).astype(float)
    levels = interpolate(image, point_at(ellipse, np.linspace(0, 2 * np.pi, 200)))
    # 200 grey levels a pixel; where an outline bends, the pixels between which one
    # interpolates lie a little outside of it
    assert abs(np.median(levels) - 100) < 200 * 0.05
    assert np.abs(levels - 100).mean() < 200 * 0.08


@settings(max_examples=40, deadline=None)
@given(st.floats(-45, 45), st.floats(-45, 45), st.floats(5, 30), st.floats(0.2, 1.0))
@example(16.5859375, 14.5859375, 22.96875, 0.91796875)  # a point on the outline
def test_the_distance_is_that_of_the_nearest_outline_point(u, v, a, ratio):

    def far(t):
        return np.hypot(a * np.cos(t) - u, a * ratio * np.sin(t) - v)

    t = np.linspace(0, 2 * np.pi, 4001)
    first = t[far(t).argmin()]
    nearest = far(np.linspace(first - t[1], first + t[1], 20001)).min()
    inside = (u / a) ** 2 + (v / (a * ratio)) ** 2 < 1
    found = signed_distance(u, v, a, a * ratio)
    assert abs(found) == pytest.approx(nearest, abs=1e-5 * a)
    assert nearest < 1e-5 or (found < 0) == inside


@settings(max_examples=15, deadline=None)
@given(ELLIPSES, st.floats(1.0, 3.0))
def test_a_line_holds_as_much_ink_as_its_length_times_its_width(ellipse, width):
    # the pixel grid takes a line of one place now thicker, now thinner
    x, y = (np.repeat(np.arange(4) / 4, 4), np.tile(np.arange(4) / 4, 4))
    inks = []
    for k in range(16):
        one = Ellipses.from_array([np.add(_row(ellipse), [x[k], y[k], 0, 0, 0])])
        image = render_ellipses(
            one, (101, 101), drawing="outlines", levels=0.0, background=255.0, stroke=width
        )
        inks.append((255.0 - image).sum() / 255.0)
    assert np.mean(inks) == pytest.approx(perimeter(ellipse) * width, rel=0.005)


def _row(e):
    return [e.x, e.y, e.semi_major, e.semi_minor, e.angle]


PAIR = Ellipses.from_array([[40, 40, 30, 20, 0.4], [60, 44, 28, 18, 2.5]])


def test_the_later_ellipse_lies_on_top():
    image = render_ellipses(PAIR, (100, 90), levels=np.array([100.0, 200.0]), background=10)
    assert image[42, 50] == 200  # within both
    assert image[40, 20] == 100
    assert image[80, 5] == 10


def test_a_covered_outline_is_not_drawn_and_an_overlapping_one_is():
    shared = {"drawing": "outlines", "levels": 0.0, "background": 255.0}
    size = (100, 90)
    hidden = render_ellipses(PAIR, size, kind="occluded", **shared)
    open_ = render_ellipses(PAIR, size, kind="overlapping", **shared)
    points = point_at(PAIR[0], np.linspace(0, 2 * np.pi, 400))
    inside = _inside(PAIR[1], points, 0.7)
    assert inside.any()
    assert (interpolate(hidden.astype(float), points[inside]) == 255).all()
    assert (interpolate(open_.astype(float), points[inside]) < 128).all()


def _inside(ellipse, points, share=1.0):
    d = points - np.array([ellipse.x, ellipse.y])
    c, s = np.cos(ellipse.angle), np.sin(ellipse.angle)
    u, v = d @ [c, s], d @ [-s, c]
    return (u / ellipse.semi_major) ** 2 + (v / ellipse.semi_minor) ** 2 < share - 1e-9


@pytest.mark.parametrize("k", [0, 1])
def test_the_step_across_an_overlapping_outline_is_the_same_everywhere(k):
    levels = np.array([90.0, 25.0])
    image = render_ellipses(PAIR, (100, 90), kind="overlapping", levels=levels, background=60.0)
    t = np.linspace(0, 2 * np.pi, 300)
    points, outward = point_at(PAIR[k], t), normals(PAIR[k], t)
    other = PAIR[1 - k]
    clear = _inside(other, points, 0.7) | ~_inside(other, points, 1.4)
    assert _inside(other, points, 0.7).any()
    values = image.astype(float)
    step = interpolate(values, points - 2 * outward) - interpolate(values, points + 2 * outward)
    assert np.abs(step[clear] - (levels[k] - 60)).max() <= 1


def test_parity_has_the_full_contrast_at_every_outline():
    image = render_parity(PAIR, (100, 90), inside=200, outside=50)
    assert image[42, 50] == 50
    assert image[40, 20] == 200
    assert set(np.unique(image[40, 55:60])) <= set(range(50, 201))


@settings(max_examples=20, deadline=None)
@given(st.lists(ELLIPSES, min_size=2, max_size=5))
def test_the_visible_share_is_that_of_densely_sampled_outlines(ellipses):
    size = (80, 70)
    rows = Ellipses.from_array([_row(e) for e in ellipses])
    shares = visible_shares(rows, size)
    t = np.arange(4000) * (2 * np.pi / 4000)
    for k, ellipse in enumerate(ellipses):
        points = point_at(ellipse, t)
        speed = np.hypot(ellipse.semi_major * np.sin(t), ellipse.semi_minor * np.cos(t))
        seen = (np.abs(points + 0.5) <= np.array(size)).all(axis=1) & (points >= -0.5).all(axis=1)
        for later in ellipses[k + 1 :]:
            seen &= ~_inside(later, points)
        assert shares[k] == pytest.approx(speed[seen].sum() / speed.sum(), abs=0.005)


def test_nothing_hides_an_overlapping_outline_within_the_frame():
    assert visible_shares(PAIR, (100, 90), kind="overlapping").tolist() == [1.0, 1.0]


@pytest.mark.parametrize(
    "call",
    [
        lambda: disc_image(10, 10, centre=(5, 5), radius=0),
        lambda: disc_image(0, 10, centre=(5, 5), radius=3),
        lambda: render_ellipses(PAIR, (50, 50), kind="hidden"),
        lambda: render_ellipses(PAIR, (50, 50), drawing="dotted"),
        lambda: render_ellipses(PAIR, (50, 50), levels=np.zeros(3)),
        lambda: render_ellipses(PAIR, (50, 50), stroke=0.0),
        lambda: visible_shares(PAIR, None),
    ],
)
def test_wrong_arguments_are_refused(call):
    with pytest.raises(InputError):
        call()
