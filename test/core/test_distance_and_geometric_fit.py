"""Orthogonal distance to an ellipse, and the fit that minimises it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError
from geoprim_core.fitting import (
    distance_to_ellipse,
    fit_ellipse,
    fit_geometric,
    outline_points,
    perimeter,
    point_at,
)
from geoprim_core.types import Ellipse

ELLIPSES = st.builds(
    lambda x, y, major, ratio, angle: Ellipse(x, y, major, major * ratio, angle),
    st.floats(-40, 40),
    st.floats(-40, 40),
    st.floats(5, 60),
    st.floats(0.05, 1.0),
    st.floats(0, 3.1415),
)


def row(e: Ellipse) -> np.ndarray:
    return np.array([e.x, e.y, e.semi_major, e.semi_minor, e.angle])


def normals(e: Ellipse, t: np.ndarray) -> np.ndarray:
    u, v = np.cos(t) / e.semi_major, np.sin(t) / e.semi_minor
    cos, sin = np.cos(e.angle), np.sin(e.angle)
    outward = np.stack([cos * u - sin * v, sin * u + cos * v], axis=1)
    return outward / np.hypot(u, v)[:, None]


@given(ellipse=ELLIPSES, outside=st.floats(0, 100), inside=st.floats(0, 1))
@settings(max_examples=100, deadline=None)
def test_a_step_along_the_normal_is_the_distance(ellipse, outside, inside):
    t = np.linspace(0, 2 * np.pi, 65)  # both axes among them
    foot, normal = point_at(ellipse, t), normals(ellipse, t)
    assert np.allclose(distance_to_ellipse(foot + outside * normal, ellipse), outside, atol=1e-10)
    # Inwards it holds up to the smallest radius of curvature, b^2 / a.
    depth = inside * ellipse.semi_minor**2 / ellipse.semi_major
    assert np.allclose(distance_to_ellipse(foot - depth * normal, ellipse), depth, atol=1e-10)


@given(ellipse=ELLIPSES, seed=st.integers(0, 999))
@settings(max_examples=40, deadline=None)
def test_no_point_of_the_outline_is_nearer(ellipse, seed):
    points = np.random.default_rng(seed).uniform(-100, 100, (20, 2))
    outline = outline_points(ellipse, 20_000)
    nearest = np.sqrt(((points[:, None] - outline[None]) ** 2).sum(axis=-1).min(axis=1))
    distance = distance_to_ellipse(points, ellipse)
    assert (distance <= nearest + 1e-10).all()
    assert (distance >= nearest - perimeter(ellipse) / 20_000 * 2).all()


def test_centre_axes_and_circle():
    ellipse = Ellipse(10, 20, 5, 3, 0)
    points = [(10, 20), (15, 20), (20, 20), (10, 23), (10, 30), (10, 21), (10.5, 20), (14.9, 20)]
    u = 0.5 * 5 / 16  # foot of (0.5, 0) on x = 5 u, y = 3 sqrt(1 - u^2)
    near_centre = np.hypot(5 * u - 0.5, 3 * np.sqrt(1 - u * u))
    expected = [3, 0, 5, 0, 7, 2, near_centre, 0.1]
    assert np.allclose(distance_to_ellipse(points, ellipse), expected, atol=1e-12)
    circle = Ellipse(0, 0, 5, 5, 0)
    assert np.allclose(distance_to_ellipse([(0, 0), (3, 4), (6, 8)], circle), [5, 0, 5])


@given(ellipse=ELLIPSES, t=st.floats(0.01, 1.56), depth=st.floats(0, 1))
@settings(max_examples=60, deadline=None)
def test_on_the_evolute_the_distance_is_the_radius_of_curvature(ellipse, t, depth):
    a, b = ellipse.semi_major, ellipse.semi_minor
    radius = (a * a * np.sin(t) ** 2 + b * b * np.cos(t) ** 2) ** 1.5 / (a * b)
    foot, normal = point_at(ellipse, [t]), normals(ellipse, np.array([t]))
    inside = foot - min(depth * radius, b * b / a) * normal
    expected = min(depth * radius, b * b / a)
    assert distance_to_ellipse(inside, ellipse)[0] == pytest.approx(expected, abs=1e-10)
    # On the evolute itself the foot is one still, unless the axis between has a nearer one.
    centre = foot - radius * normal
    assert distance_to_ellipse(centre, ellipse)[0] <= radius + 1e-10


@pytest.mark.parametrize("exponent", range(1, 300, 23))
def test_a_hair_off_the_major_axis_is_like_on_it(exponent):
    ellipse = Ellipse(0, 0, 50, 0.5, 0)
    x = np.linspace(0, 60, 31)
    near = np.stack([x, np.full(31, 10.0**-exponent)], axis=1)
    on = np.stack([x, np.zeros(31)], axis=1)
    gap = np.abs(distance_to_ellipse(near, ellipse) - distance_to_ellipse(on, ellipse))
    assert (gap <= 1.01 * 10.0**-exponent + 1e-12).all()


def test_the_geometric_fit_recovers_exact_ellipses_from_a_rough_start():
    rng = np.random.default_rng(5)
    for _ in range(50):
        major = rng.uniform(10, 80)
        truth = Ellipse(
            *rng.uniform(0, 500, 2), major, major * rng.uniform(0.3, 0.9), rng.uniform(0.2, 2.9)
        )
        points = point_at(truth, np.linspace(0, 4.5, 60))
        start = Ellipse(
            truth.x + 0.03 * major,
            truth.y,
            1.05 * major,
            0.95 * truth.semi_minor,
            truth.angle + 0.05,
        )
        fit = fit_geometric(points, start)
        assert np.allclose(row(fit.ellipse), row(truth), atol=1e-6)
        assert fit.settled and fit.rms < 1e-6


def test_the_covariance_is_the_scatter_of_repeated_fits():
    rng = np.random.default_rng(6)
    truth = Ellipse(60, 40, 30, 18, 0.6)
    on = point_at(truth, np.linspace(0.3, 4.5, 100))
    found, told = [], []
    for _ in range(300):
        points = on + rng.normal(0, 0.2, on.shape)
        fit = fit_geometric(points, fit_ellipse(points, "nsaf").ellipse)
        found.append(row(fit.ellipse))
        told.append(fit.covariance)
        assert np.allclose(fit.covariance, fit.covariance.T)
    scatter, expected = np.cov(np.array(found).T), np.median(told, axis=0)
    assert np.allclose(np.sqrt(np.diag(scatter)), np.sqrt(np.diag(expected)), rtol=0.15)
    assert np.allclose(np.mean(found, axis=0), row(truth), atol=0.02)


def test_the_geometric_fit_has_less_distance_than_both_algebraic_ones():
    rng = np.random.default_rng(7)
    points = point_at(Ellipse(0, 0, 40, 15, 1), np.linspace(0, 3.5, 80)) + rng.normal(0, 1, (80, 2))
    for method in ("nsaf", "ellifit"):
        start = fit_ellipse(points, method).ellipse
        fit = fit_geometric(points, start)
        before = np.sqrt((distance_to_ellipse(points, start) ** 2).mean())
        after = np.sqrt((distance_to_ellipse(points, fit.ellipse) ** 2).mean())
        assert after < before
        assert fit.rms == pytest.approx(after, rel=1e-9)


def test_the_unknown_angle_of_a_circle_has_the_variance_of_a_half_turn():
    rng = np.random.default_rng(8)
    t = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    radius = 20 + np.tile([0.1, -0.1], 30)
    points = np.stack([radius * np.cos(t), radius * np.sin(t)], axis=1)
    fit = fit_geometric(points + 0 * rng.normal(), Ellipse(0.5, 0, 21, 19, 0.4))
    assert fit.ellipse.semi_major == pytest.approx(20, abs=1e-3)
    assert fit.covariance[4, 4] == pytest.approx(np.pi**2 / 12, rel=1e-3)
    assert fit.covariance[0, 0] == pytest.approx(2 * 0.01 / 55, rel=0.05)


def test_huber_and_weights_tame_outliers():
    truth = Ellipse(60, 40, 30, 18, 0.6)
    points = point_at(truth, np.linspace(0, 6, 100))
    points[::10] += 4.0
    start = fit_ellipse(points, "nsaf").ellipse
    plain = fit_geometric(points, start).ellipse
    robust = fit_geometric(points, start, huber=0.1, iterations=60).ellipse
    weights = np.ones(100)
    weights[::10] = 0.0
    chosen = fit_geometric(points, start, weights).ellipse
    assert np.abs(row(robust) - row(truth)).max() < 0.1 * np.abs(row(plain) - row(truth)).max()
    assert np.allclose(row(chosen), row(truth), atol=1e-6)


def test_five_points_have_no_known_covariance():
    truth = Ellipse(20, 30, 15, 8, 0.7)
    fit = fit_geometric(point_at(truth, [0.0, 1.0, 2.5, 3.5, 5.0]), truth)
    assert np.allclose(row(fit.ellipse), row(truth)) and np.isnan(fit.covariance).all()


def test_wrong_arguments_are_named():
    disc = Ellipse(0, 0, 1, 1, 0)
    points = outline_points(disc, 8)
    with pytest.raises(InputError, match="at least five"):
        fit_geometric(points[:4], disc)
    with pytest.raises(InputError, match="weights"):
        fit_geometric(points, disc, -np.ones(8))
    with pytest.raises(InputError, match="huber"):
        fit_geometric(points, disc, huber=0.0)
    with pytest.raises(InputError, match="iterations"):
        fit_geometric(points, disc, iterations=-1)
    with pytest.raises(InputError, match="start"):
        fit_geometric(points, None)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="ellipse"):
        distance_to_ellipse(points, "disc")  # type: ignore[arg-type]
