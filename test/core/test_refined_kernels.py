"""The fitting kernels of the `refined` scheme against analytic results."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.ecc import _kernels_refined_final as final
from geoprim_core.ecc import _kernels_refined_fit as fit
from geoprim_core.ecc import _kernels_refined_stroke as stroke
from geoprim_core.ecc import _kernels_refined_support as support

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
    assert fit.refit(points, np.arange(200), 200, row, 8, 3.0)
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


def test_the_edges_of_a_line_are_mates_across_its_width():
    x = np.arange(10.0, 40.0)
    points = np.concatenate([np.stack([x, 0 * x + y], axis=1) for y in (20.0, 22.25)])
    normals = np.repeat([[0.0, -1.0], [0.0, 1.0]], len(x), axis=0)
    head, following = support.index_points(points, 60, 40)
    gaps = stroke.find_mates(head, following, points, normals, 4.0)
    assert np.allclose(gaps, -2.25)


def test_more_support_is_more_evidence():
    base = support.evidence_of(0.6, 0.2, 0.1, 200.0, 40.0)
    assert support.evidence_of(0.9, 0.2, 0.1, 300.0, 40.0) > base
    assert support.evidence_of(0.6, 0.4, 0.1, 200.0, 40.0) < base
    assert support.evidence_of(0.6, 0.2, 0.3, 200.0, 40.0) < base
    whole = support.evidence_of(1.0, 0.2, 0.1, 200.0, 40.0)
    assert support.evidence_of(1.0, 0.9, 0.9, 200.0, 40.0) == whole
