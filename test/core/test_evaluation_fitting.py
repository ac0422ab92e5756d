"""Truths of the metrics of ellipse fits and of the point sets that they are taken on."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError
from geoprim_core.evaluation.fitting import (
    DetectionCounts,
    accepted,
    confocal_distance,
    detection_counts,
    fit_errors,
    focal_bisector_distance,
)
from geoprim_core.fitting import distance_to_ellipse, nsaf, point_at
from geoprim_core.synthetic import elliptic_arc, noisy_ellipse, open_conic
from geoprim_core.types import Ellipse

ELLIPSES = st.builds(
    lambda major, ratio, angle: Ellipse(40, -7, major, major * ratio, angle),
    st.floats(3, 300),
    st.floats(0.05, 1.0),
    st.floats(0, 3.14),
)
SPOTS = st.lists(st.tuples(st.floats(-400, 400), st.floats(-400, 400)), min_size=1, max_size=20)
MEASURES = pytest.mark.parametrize("measure", [focal_bisector_distance, confocal_distance])


@MEASURES
@given(ellipse=ELLIPSES, spots=SPOTS)
@settings(max_examples=100, deadline=None)
def test_both_measures_reach_the_outline_and_so_are_no_less_than_the_distance(
    measure, ellipse, spots
):
    found = measure(spots, ellipse)
    least = distance_to_ellipse(spots, ellipse)
    assert (found >= least - 1e-9 * (1 + least)).all()


@MEASURES
@given(ellipse=ELLIPSES, angle=st.floats(0, 6.28))
@settings(max_examples=60, deadline=None)
def test_both_measures_agree_with_the_distance_near_the_outline(measure, ellipse, angle):
    tangent = point_at(ellipse, angle + 1e-7) - point_at(ellipse, angle - 1e-7)
    normal = np.array([-tangent[1], tangent[0]]) / np.hypot(*tangent)
    step = 1e-3 * ellipse.semi_minor**2 / ellipse.semi_major
    for side in (step, -step):
        spot = point_at(ellipse, angle) + side * normal
        assert measure([spot], ellipse)[0] == pytest.approx(step, rel=2e-3)


@MEASURES
def test_both_measures_are_the_distance_on_circles_and_axes(measure):
    circle = Ellipse(3, 4, 10, 10, 0)
    assert measure([(3, 4), (3, 20), (9, 12)], circle) == pytest.approx([10, 6, 0])
    thin = Ellipse(0, 0, 5, 3, 0)  # foci at -4 and 4
    assert measure([(0, 0), (0, 7), (0, -1), (4.5, 0)], thin) == pytest.approx([3, 4, 2, 0.5])
    assert measure([(5, 0), (0, 3)], thin) == pytest.approx([0, 0], abs=1e-12)


def test_the_confocal_point_of_a_point_between_the_foci():
    # cosine 2 u / (r + s) = u / c, so (2, 0) meets the ellipse at (5 / 2, 3 sqrt(3) / 2).
    found = confocal_distance([(2, 0)], Ellipse(0, 0, 5, 3, 0))[0]
    assert found == pytest.approx(np.hypot(0.5, 1.5 * np.sqrt(3)))
    upright = focal_bisector_distance([(2, 0)], Ellipse(0, 0, 5, 3, 0))[0]
    assert upright == pytest.approx(3 * np.sqrt(1 - 4 / 25))


@MEASURES
def test_the_measures_turn_and_move_with_the_ellipse(measure):
    spots = np.array([(9.0, 2.0), (-1.0, 1.0), (3.0, -8.0)])
    c, s = np.cos(0.7), np.sin(0.7)
    turned = spots @ [[c, s], [-s, c]] + [100, 50]
    here = measure(spots, Ellipse(0, 0, 6, 2, 0))
    assert measure(turned, Ellipse(100, 50, 6, 2, 0.7)) == pytest.approx(here)


def test_detections_are_counted_as_the_thesis_says():
    assert not accepted(Ellipse(0, 0, 100, 10, 0)) and accepted(Ellipse(0, 0, 100, 10.01, 0))
    one, far = Ellipse(50, 50, 20, 10, 0), Ellipse(200, 50, 20, 10, 0)
    quite = Ellipse(50, 50, 20, 8.01, 0)
    less = Ellipse(50, 50, 20, 7.99, 0)
    assert detection_counts([quite, less, far], [one]) == DetectionCounts(1, 3, 1, 1)
    total = detection_counts([quite], [one]) + detection_counts([], [one])
    assert (total.recall, total.precision) == (0.5, 1.0)
    assert np.isnan(detection_counts([one], []).recall)
    with pytest.raises(InputError):
        fit_errors(np.zeros((0, 2)), one)


@given(seed=st.integers(0, 9999), span=st.floats(1.0, 2 * np.pi))
@settings(max_examples=40, deadline=None)
def test_digital_arcs_are_connected_pixels_within_half_a_pixel(seed, span):
    ellipse, pixels = elliptic_arc(np.random.default_rng(seed), span)
    assert (np.abs(np.diff(pixels, axis=0)).max(axis=1) == 1).all()
    assert distance_to_ellipse(pixels, ellipse).max() <= np.sqrt(0.5) + 1e-9


def test_noisy_points_scatter_by_the_share_of_the_extent():
    shares = []
    for seed in range(200):
        ellipse, points = noisy_ellipse(np.random.default_rng(seed), 10, 1.5 * np.pi)
        assert len(points) == 28
        exact = noisy_ellipse(np.random.default_rng(seed), 0, 1.5 * np.pi)[1]
        assert distance_to_ellipse(exact, ellipse).max() < 1e-9
        shares.append((points - exact).std(axis=0) / np.abs(exact - 150).max(axis=0))
    assert np.mean(shares, axis=0) == pytest.approx([0.1, 0.1], rel=0.05)


@given(seed=st.integers(0, 9999), half=st.floats(np.pi / 2, np.pi))
@settings(max_examples=60, deadline=None)
def test_open_conics_keep_to_one_branch_and_to_the_image(seed, half):
    exact = open_conic(np.random.default_rng(seed), half)
    pixels = open_conic(np.random.default_rng(seed), half, "digital")
    assert min(exact.min(), pixels.min()) >= 0 and max(exact.max(), pixels.max()) <= 299
    assert (np.abs(np.diff(pixels, axis=0)).max(axis=1) == 1).all()
    assert len(open_conic(np.random.default_rng(seed), half, "noisy", 30.0)) >= 10
    # (4-61): the distance from the focus is latus + e (x - x0), so it is linear in x.
    radius = np.hypot(*(exact - 150).T)
    slope, latus = np.polyfit(exact[:, 0] - 150, radius, 1)
    assert np.abs(latus + slope * (exact[:, 0] - 150) - radius).max() < 1e-6
    assert slope + 1e-9 >= 1 and slope <= 2 + 1e-9 and 20 - 1e-6 <= latus <= 150 + 1e-6


def test_the_sets_refuse_what_makes_no_sense():
    random = np.random.default_rng(0)
    for wrong in (
        lambda: elliptic_arc(random, 7.0),
        lambda: noisy_ellipse(random, -1),
        lambda: open_conic(random, 4.0),
        lambda: open_conic(random, 2.0, "other"),
    ):
        with pytest.raises(InputError):
            wrong()


def test_a_fit_of_exact_points_has_no_error():
    points = point_at(Ellipse(20, 30, 15, 6, 1.0), np.linspace(0, 4, 30))
    errors = fit_errors(points, nsaf(points).ellipse)
    assert max(errors.mean_distance, errors.e13, errors.e14) < 1e-8
