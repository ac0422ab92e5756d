"""Truths of the selective fit: open conics are refused, ellipses kept, degenerate arcs survive."""

import numpy as np
import pytest

from geoprim_core.fitting import (
    TABLE,
    SelectiveParams,
    geometric,
    nsaf,
    overlap_ratio,
    point_at,
    selective,
)
from geoprim_core.fitting._kernels_selective import certainty_of, largest_gap
from geoprim_core.synthetic import elliptic_arc, noisy_ellipse, open_conic
from geoprim_core.types import Ellipse

NO_WEIGHTS = np.zeros(0)


def draw(make, count, *arguments):
    return [make(np.random.default_rng(seed), *arguments) for seed in range(count)]


@pytest.mark.parametrize("half", [90, 180])
def test_open_conics_have_no_ellipse(half):
    for points in draw(open_conic, 60, np.radians(half)):
        assert selective(points).ellipse is None
    pixels = [selective(p) for p in draw(open_conic, 60, np.radians(half), "digital")]
    assert sum(fit.ellipse is not None for fit in pixels) <= 2  # near a parabola pixels tell less


@pytest.mark.parametrize("noise", [5, 30])
def test_noise_rarely_makes_an_ellipse_of_an_open_conic(noise):
    fits = [selective(p) for p in draw(open_conic, 200, np.pi, "noisy", noise)]
    assert sum(fit.ellipse is not None for fit in fits) <= 30


def test_short_arcs_and_noisy_clusters_keep_their_ellipse():
    short = [selective(points) for _, points in draw(elliptic_arc, 100, np.pi / 2)]
    noisy = [selective(points) for _, points in draw(noisy_ellipse, 100, 20)]
    assert sum(fit.ellipse is None for fit in short) <= 4
    assert sum(fit.ellipse is None for fit in noisy) <= 2


def test_the_fit_is_the_direct_one_for_noise_all_round_and_the_geometric_one_else():
    _, noisy = noisy_ellipse(np.random.default_rng(1), 15)
    assert overlap_ratio(selective(noisy).ellipse, nsaf(noisy).ellipse) > 1 - 1e-9
    _, arc = elliptic_arc(np.random.default_rng(1), 2.0)
    assert overlap_ratio(selective(arc).ellipse, geometric(arc).ellipse) > 1 - 1e-9
    _, sector = noisy_ellipse(np.random.default_rng(3), 8, np.radians(170))
    free = SelectiveParams(certainty=0.0)
    found = selective(sector, params=free).ellipse
    assert overlap_ratio(found, geometric(sector).ellipse) > 1 - 1e-9


def test_the_certainty_is_the_same_for_sheared_points_and_grows_with_their_number():
    _, points = noisy_ellipse(np.random.default_rng(2), 6, np.radians(200))
    found = certainty_of(points, NO_WEIGHTS)
    sheared = points @ [[1.7, 0.4], [-0.9, 0.6]] + [30.0, -400.0]
    assert certainty_of(sheared, NO_WEIGHTS) == pytest.approx(found, rel=1e-6)
    _, value, error, _ = certainty_of(np.tile(points, (4, 1)), NO_WEIGHTS)
    assert value == pytest.approx(found[1], rel=1e-6)
    assert error == pytest.approx(found[2] / 2, rel=0.1)


def test_the_standard_error_is_the_scatter_of_repeated_noise():
    clean = point_at(Ellipse(0, 0, 60, 40, 0.3), np.linspace(0, 4, 60))
    random = np.random.default_rng(0)
    trials = [
        certainty_of(clean + random.normal(0, 0.5, clean.shape), NO_WEIGHTS) for _ in range(400)
    ]
    _, values, errors, _ = np.transpose(trials)
    assert errors.mean() == pytest.approx(values.std(), rel=0.25)


def test_the_largest_gap_is_that_of_the_sector():
    ellipse = Ellipse(10, 20, 30, 10, 0.4)
    points = point_at(ellipse, np.radians(np.arange(-30, 181, 10)))
    order = np.random.default_rng(0).permutation(len(points))
    row = np.array([10, 20, 30, 10, 0.4])
    assert largest_gap(points[order], row) == pytest.approx(np.radians(150))


@pytest.mark.parametrize("row", list(TABLE), ids=TABLE.names)
def test_pixels_on_two_parallel_lines_are_an_outcome(row):
    step = np.arange(7.0)
    stair = np.concatenate(
        [np.stack([-step, 0 * step], 1), np.stack([-7 - step[:3], step[:3] * 0 - 1], 1)]
    )
    fit = row.function(stair + np.array([102.0, 166.0]))
    assert fit.ellipse is None or fit.ellipse.semi_minor > 0
