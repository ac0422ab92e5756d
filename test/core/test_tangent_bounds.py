"""Bounds of DEB: the corrected analytic error, a bound that holds, and digitised conics."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError
from geoprim_core.evaluation.reproduce_tangent_bounds import (
    bound_row,
    bound_rows,
    chord_ends,
    conic_points,
    line_angle,
    printed_bound,
    sensitivities,
)
from geoprim_core.evaluation.reproduce_tangent_walk import walk_row
from geoprim_core.tangent.bounds import (
    analytic_bound,
    circle_radius,
    conic_analytic_error,
    conic_curvature,
    conic_radius,
)

CONICS = st.tuples(st.floats(0.0, 3.0), st.floats(20.0, 500.0))


def places(eccentricity, count=90):
    """Return polar angles on the conic's branch about theta = pi, away from asymptotes."""
    reach = np.pi if eccentricity < 0.9 else 1.4
    return np.pi + np.linspace(-reach, reach, count) * 0.98


def true_error(conic, theta, radius):
    back, ahead = chord_ends(*conic, theta, radius)
    chord = conic_points(*conic, ahead) - conic_points(*conic, back)
    step = 1e-6
    slope = conic_points(*conic, theta + step) - conic_points(*conic, theta - step)
    return line_angle(chord, np.arctan2(slope[:, 1], slope[:, 0])), back, ahead


@given(conic=CONICS)
@settings(max_examples=40, deadline=None)
def test_closed_form_is_the_derivative_of_the_curvature(conic):
    theta = places(conic[0])
    step = 1e-5
    ahead, behind = (conic_curvature(*conic, theta + way * step)[0] for way in (1, -1))
    points = [conic_points(*conic, theta + way * step) for way in (1, -1)]
    length = np.hypot(*(points[0] - points[1]).T)
    slope = conic_curvature(*conic, theta)[1]
    assert np.abs((ahead - behind) / length - slope).max() < 1e-5 * np.abs(slope).max() + 1e-12


def test_curvature_is_that_of_three_points_on_the_conic():
    conic, theta, step = (0.8, 80.0), np.array([2.0, 2.9, 4.0]), 1e-3
    p, q, r = (conic_points(*conic, theta + k * step) for k in (-1, 0, 1))
    (ax, ay), (bx, by), (cx, cy) = (q - p).T, (r - q).T, (r - p).T
    menger = 2 * (ax * by - ay * bx) / np.sqrt((ax**2 + ay**2) * (bx**2 + by**2) * (cx**2 + cy**2))
    assert conic_curvature(*conic, theta)[0] == pytest.approx(menger, rel=1e-4)


@pytest.mark.parametrize("conic", [(0.5, 100.0), (1.0, 60.0), (2.0, 200.0)])
def test_analytic_error_is_of_second_order_with_the_constant_of_errata_t2(conic):
    theta = np.pi + np.array([-0.9, 0.4, 1.1])
    for radius in (4.0, 2.0):
        error = true_error(conic, theta, radius)[0]
        assert error == pytest.approx(conic_analytic_error(*conic, theta, radius), rel=5e-3)
    assert error == pytest.approx(true_error(conic, theta, 4.0)[0] / 4, rel=1e-2)


@given(conic=CONICS, radius=st.floats(2.0, 15.0))
@settings(max_examples=60, deadline=None)
def test_analytic_bound_is_never_exceeded(conic, radius):
    theta = places(conic[0])
    error, back, ahead = true_error(conic, theta, radius)
    between = back + np.linspace(0, 1, 65)[:, None] * (ahead - back)
    curvature, slope = conic_curvature(*conic, between)
    limit = analytic_bound(np.abs(slope).max(axis=0), np.abs(curvature).max(axis=0), radius)
    assert (error <= limit * (1 + 1e-3) + 1e-8).all()


def test_printed_bound_lies_below_the_true_error():
    # Errata T2: in 730 of 772 cases.
    theta = places(0.6)
    error = true_error((0.6, 120.0), theta, 10.0)[0]
    assert (printed_bound(0.6, 120.0, theta, 10.0) < error).mean() > 0.8


def test_no_error_of_the_families_exceeds_its_total_bound():
    rows = list(bound_rows(8))
    assert len(rows) == 3 * 8 * 4
    assert sum(row.exceeded for row in rows) == 0
    assert all(row.analytic <= row.analytic_limit + 1e-7 for row in rows)
    assert all(row.digital <= row.digital_limit + 1e-7 for row in rows)
    # The bound is no empty one: parts of it are nearly reached.
    assert max(row.digital / row.digital_limit for row in rows) > 0.85
    assert max(row.analytic / row.analytic_limit for row in rows if row.analytic_limit > 1e-4) > 0.9
    assert all(row.analytic < 1e-6 for row in rows if row.family == "circles")


def test_figures_of_the_thesis_for_its_families():
    # Printed: 0.035 degrees (3.5.1.1), and 0.3913 (3.5.1.2), which is (3-27) and not the error.
    conic = bound_row("conics", 0.1, (0.1, 20.0), 10.0, places=720)
    assert conic.analytic == pytest.approx(0.0355, abs=2e-4)
    parabola = bound_row("parabolae", 30.0, (1.0, 30.0), 10.0, places=720)
    assert parabola.printed == pytest.approx(0.3913, abs=2e-4)
    assert parabola.analytic == pytest.approx(0.803, abs=2e-3)


@pytest.mark.parametrize("rho, radius", [(20.0, 10.0), (60.0, 4.0), (150.0, 10.0)])
def test_deb_along_pixels_stays_below_the_bound_of_the_walk(rho, radius):
    row = walk_row(rho, radius, seed=5, count=4)
    assert row.pixels > 4 * 5 * rho
    assert row.beyond_walk == 0


def test_radius_rules_keep_the_thesis_parameter_at_its_tolerance():
    for e, a, tolerance in ((0.3, 100.0, 0.2), (1.0, 50.0, 0.5), (20.0, 200.0, 0.5)):
        radius = conic_radius(e, a, tolerance)
        assert (1 + 1 / e) * radius / a == pytest.approx(tolerance)  # D_max of (3-26)
    assert circle_radius(20.0, 0.5) == 10.0
    with pytest.raises(InputError, match="smallest"):
        circle_radius(-1.0)
    with pytest.raises(InputError, match="eccentricity"):
        conic_radius(np.nan, 1.0)


def test_yuen_centre_is_exact_without_turn_and_worse_in_test_two():
    exact = [each for each in sensitivities() if not each.digitised]
    assert all(each.errors[30] < 1e-9 for each in exact)
    assert exact[1].mean > exact[0].mean
