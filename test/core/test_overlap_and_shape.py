"""Exact overlap of ellipses, and the small functions on their shape."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError
from geoprim_core.fitting import (
    angular_span,
    eccentric_angles,
    ellipse_boxes,
    outline_points,
    overlap_matrix,
    overlap_ratio,
    perimeter,
    point_at,
    tangent_at,
)
from geoprim_core.types import Ellipse, Ellipses

ELLIPSES = st.builds(
    lambda x, y, major, ratio, angle: Ellipse(x, y, major, major * ratio, angle),
    st.floats(-40, 40),
    st.floats(-40, 40),
    st.floats(5, 60),
    st.floats(0.02, 1.0),
    st.floats(0, 3.1415),
)


def chords(e: Ellipse, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return where vertical lines enter and leave an ellipse (equal where they miss it)."""
    cos, sin = np.cos(e.angle), np.sin(e.angle)
    p, q = e.semi_major**-2, e.semi_minor**-2
    a, b, c = sin * sin * p + cos * cos * q, 2 * cos * sin * (p - q), cos * cos * p + sin * sin * q
    u = x - e.x
    root = np.sqrt(np.maximum((b * u) ** 2 - 4 * a * (c * u * u - 1), 0))
    return e.y + (-b * u - root) / (2 * a), e.y + (-b * u + root) / (2 * a)


def fine_raster(a: Ellipse, b: Ellipse) -> float:
    """Return the overlap ratio by columns much finer than a pixel, exact along each."""
    boxes = ellipse_boxes(
        Ellipses(*np.array([(e.x, e.y, e.semi_major, e.semi_minor, e.angle) for e in (a, b)]).T)
    )
    left, right = max(boxes[:, 0]), min(boxes[:, 2])
    if right <= left:
        return 0.0
    count = 50_000
    # Columns crowd towards both ends, where a chord's length changes like a square root.
    s = (np.arange(count) + 0.5) * np.pi / count
    x = 0.5 * (left + right) - 0.5 * (right - left) * np.cos(s)
    width = 0.5 * (right - left) * np.sin(s) * np.pi / count
    (low_a, high_a), (low_b, high_b) = chords(a, x), chords(b, x)
    shared = np.maximum(0, np.minimum(high_a, high_b) - np.maximum(low_a, low_b)) @ width
    union = np.pi * (a.semi_major * a.semi_minor + b.semi_major * b.semi_minor) - shared
    return float(shared / union)


@given(a=ELLIPSES, b=ELLIPSES)
@settings(max_examples=50, deadline=None)
def test_overlap_is_that_of_a_fine_raster_and_symmetric(a, b):
    ratio = overlap_ratio(a, b)
    assert ratio == pytest.approx(fine_raster(a, b), abs=1e-6)
    assert overlap_ratio(b, a) == pytest.approx(ratio, abs=1e-9)


@given(a=ELLIPSES, exponent=st.integers(-16, 0), seed=st.integers(0, 999))
@settings(max_examples=50, deadline=None)
def test_nearly_equal_ellipses(a, exponent, seed):
    q = 10.0**exponent * a.semi_minor * np.random.default_rng(seed).uniform(0, 1, 5)
    b = Ellipse(
        a.x + q[0],
        a.y - q[1],
        a.semi_major + q[2],
        a.semi_minor - 0.5 * q[3],
        (a.angle + q[4] / a.semi_major) % np.pi,
    )
    assert overlap_ratio(a, b) == pytest.approx(fine_raster(a, b), abs=1e-6)
    assert overlap_ratio(a, a) == pytest.approx(1.0, abs=1e-12)


@given(a=ELLIPSES, factor=st.floats(0.05, 1.0))
@settings(max_examples=50, deadline=None)
def test_concentric_similar_ellipses_overlap_by_their_ratio_of_areas(a, factor):
    inner = Ellipse(a.x, a.y, factor * a.semi_major, factor * a.semi_minor, a.angle)
    assert overlap_ratio(a, inner) == pytest.approx(factor**2, abs=1e-9)


def test_closed_forms():
    # Two unit discs at distance 1 share 2 pi / 3 - sqrt(3) / 2.
    lens = 2 * np.pi / 3 - np.sqrt(3) / 2
    discs = Ellipse(0, 0, 1, 1, 0), Ellipse(1, 0, 1, 1, 0)
    assert overlap_ratio(*discs) == pytest.approx(lens / (2 * np.pi - lens), abs=1e-12)
    # A cross of equal ellipses shares 4 a b atan(b / a).
    a, b = 9.0, 2.0
    shared = 4 * a * b * np.arctan(b / a)
    cross = Ellipse(3, 4, a, b, 0), Ellipse(3, 4, a, b, np.pi / 2)
    assert overlap_ratio(*cross) == pytest.approx(shared / (2 * np.pi * a * b - shared), abs=1e-12)


def test_touching_nested_and_separate_ellipses():
    disc = Ellipse(0, 0, 10, 10, 0)
    assert overlap_ratio(disc, Ellipse(20, 0, 10, 10, 0)) == 0.0
    assert overlap_ratio(disc, Ellipse(100, 0, 10, 10, 0)) == 0.0
    assert overlap_ratio(disc, Ellipse(5, 0, 5, 5, 0)) == pytest.approx(0.25, abs=1e-9)
    assert overlap_ratio(disc, Ellipse(0, 0, 10, 5, 0)) == pytest.approx(0.5, abs=1e-9)
    # Boxes that cross although the ellipses do not.
    thin = Ellipse(0, 0, 20, 1, np.pi / 4), Ellipse(6, -6, 20, 1, np.pi / 4)
    assert overlap_ratio(*thin) == 0.0


def test_a_needle_through_a_disc_is_not_missed():
    disc, needle = Ellipse(0, 0, 10, 10, 0), Ellipse(15, 0, 10, 1e-4, 0)
    assert overlap_ratio(disc, needle) == pytest.approx(fine_raster(disc, needle), rel=1e-4)


def test_the_matrix_holds_every_pair():
    rng = np.random.default_rng(3)
    rows = np.column_stack(
        [rng.uniform(0, 60, (9, 2)), np.sort(rng.uniform(3, 30, (9, 2)))[:, ::-1]]
    )
    all_nine = Ellipses.from_array(np.column_stack([rows, rng.uniform(0, 3.1, 9)]))
    first, second = all_nine.select(slice(0, 4)), all_nine.select(slice(4, 9))
    table = overlap_matrix(first, second)
    assert table.tolist() == [[overlap_ratio(a, b) for b in second] for a in first]
    none = all_nine.select(slice(0, 0))
    assert overlap_matrix(none, second).shape == (0, 5)


@given(a=ELLIPSES)
@settings(max_examples=40, deadline=None)
def test_the_box_touches_the_outline_on_all_sides(a):
    box = ellipse_boxes(Ellipses([a.x], [a.y], [a.semi_major], [a.semi_minor], [a.angle]))[0]
    outline = outline_points(a, 20_000)
    assert np.allclose(box, [*outline.min(axis=0), *outline.max(axis=0)], atol=1e-5)
    assert (outline >= box[:2] - 1e-9).all() and (outline <= box[2:] + 1e-9).all()


@pytest.mark.parametrize("major, minor", [(1, 1), (5, 4.9), (50, 20), (100, 0.1)])
def test_perimeter_is_the_complete_elliptic_integral(major, minor):
    t = (np.arange(200_000) + 0.5) * 2 * np.pi / 200_000
    expected = np.hypot(major * np.sin(t), minor * np.cos(t)).mean() * 2 * np.pi
    assert perimeter(Ellipse(3, 4, major, minor, 1)) == pytest.approx(expected, rel=1e-9)


def test_point_at_turns_from_x_towards_y():
    ellipse = Ellipse(10, 20, 5, 2, np.pi / 2)
    assert np.allclose(point_at(ellipse, 0.0), [10, 25])
    assert np.allclose(point_at(ellipse, [np.pi / 2]), [[8, 20]])


def test_wrong_arguments_are_named():
    disc = Ellipse(0, 0, 1, 1, 0)
    with pytest.raises(InputError, match="b: expected an Ellipse"):
        overlap_ratio(disc, None)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="a: expected an Ellipses"):
        overlap_matrix(disc, disc)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="count"):
        outline_points(disc, 0)
    with pytest.raises(InputError, match="parameter"):
        point_at(disc, [np.nan])


@pytest.mark.parametrize("angle", [0.0, 7.6e-274, 1e-17, 1e-9, 1.0, np.nextafter(np.pi, 0)])
def test_an_ellipse_that_touches_a_circle_from_inside_at_both_ends(angle):
    """The sign half-way between two common points was taken at the second touch: 1 came out."""
    circle, inner = Ellipse(0, 0, 5, 5, 0), Ellipse(0, 0, 5, 2.5, angle)
    assert overlap_ratio(circle, inner) == pytest.approx(0.5, abs=1e-9)
    assert overlap_ratio(inner, circle) == pytest.approx(0.5, abs=1e-9)


@given(a=ELLIPSES, start=st.floats(-7, 7), extent=st.floats(0, 6))
@settings(max_examples=50, deadline=None)
def test_eccentric_angles_are_the_way_back_and_span_their_range(a, start, extent):
    t = np.linspace(start, start + extent, 60)  # neighbours closer than what is left of the turn
    points = point_at(a, t)
    turns = (eccentric_angles(points, a) - t) / (2 * np.pi)
    assert np.allclose(turns, np.round(turns), atol=1e-9)
    assert angular_span(points, a) == pytest.approx(extent, abs=1e-9)
    stretched = np.array([a.x, a.y]) + 1.5 * (points - [a.x, a.y])
    assert angular_span(stretched, a) == pytest.approx(extent, abs=1e-9)


@given(a=ELLIPSES, t=st.floats(-7, 7))
@settings(max_examples=50, deadline=None)
def test_the_tangent_is_the_direction_of_a_small_step(a, t):
    step = point_at(a, t + 1e-6) - point_at(a, t - 1e-6)
    tangent = tangent_at(a, t)
    assert np.hypot(*tangent) == pytest.approx(1.0, abs=1e-12)
    assert np.allclose(step / np.hypot(*step), tangent, atol=1e-4)
    assert (tangent_at(a, [t, t + 1])[0] == tangent).all()


def test_span_and_tangent_refuse_what_is_none():
    disc = Ellipse(0, 0, 1, 1, 0)
    with pytest.raises(InputError, match="at least one point"):
        angular_span(np.zeros((0, 2)), disc)
    with pytest.raises(InputError, match="parameter"):
        tangent_at(disc, np.inf)
    assert eccentric_angles([(0, 0)], disc).tolist() == [0.0]
    assert angular_span([(1, 0)], disc) == 0.0
