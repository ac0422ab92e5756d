"""The covariance of a fit, checked by simulation: how often the truth lies within it."""

import numpy as np
import pytest

from geoprim_core.errors import InputError, ParameterError
from geoprim_core.fitting import fit_covariance, fit_ellipse, fit_ellipses, point_at
from geoprim_core.types import Ellipse

TRUTH = Ellipse(160, 120, 60, 35, 0.7)
RUNS = 1500


def row(e: Ellipse) -> np.ndarray:
    return np.array([e.x, e.y, e.semi_major, e.semi_minor, e.angle])


def deviations(method: str, extent: float) -> np.ndarray:
    """Return (runs, 5) errors over standard deviations."""
    random = np.random.default_rng(23)
    on = point_at(TRUTH, np.linspace(0.4, 0.4 + extent, 80))
    arcs = on + random.normal(0, 0.3, (RUNS, *on.shape))
    fits = fit_ellipses(list(arcs), method)
    assert fits.found.all()
    told = [
        np.sqrt(np.diag(fit_covariance(points, ellipse, method)))
        for points, ellipse in zip(arcs, fits.ellipses, strict=True)
    ]
    return (fits.ellipses.array() - row(TRUTH)) / np.array(told)


@pytest.mark.parametrize("extent", [6.2, 4.0])
@pytest.mark.parametrize("method", ["geometric", "taubin", "halir_flusser"])
def test_the_truth_lies_within_one_and_two_deviations_as_often_as_it_should(method, extent):
    off = np.abs(deviations(method, extent))
    assert np.allclose((off < 1.0).mean(axis=0), 0.68, atol=0.05)
    assert np.allclose((off < 1.96).mean(axis=0), 0.95, atol=0.03)


def test_covariance_grows_with_the_square_of_the_noise_and_falls_with_the_points():
    random = np.random.default_rng(3)
    on = point_at(TRUTH, np.linspace(0, 5, 100))
    noise = random.normal(0, 0.01, on.shape)
    for method in ("geometric", "taubin"):

        def told(points, weights=None, method=method):
            ellipse = fit_ellipse(points, method, weights=weights).ellipse
            return fit_covariance(points, ellipse, method, weights)

        small = told(on + noise)
        assert np.allclose(told(on + 3 * noise) / small, 9.0, rtol=0.05)
        twice = told(on + noise, np.full(100, 2.0))
        assert np.allclose(twice, small / 2, rtol=1e-6, atol=1e-9 * small.max())


def test_covariance_turns_with_the_ellipse():
    points = point_at(TRUTH, np.linspace(0, 4, 60)) + 0.2 * np.sin(
        9.7 * np.arange(120).reshape(60, 2)
    )
    ellipse = fit_ellipse(points, "taubin").ellipse
    covariance = fit_covariance(points, ellipse, "taubin")
    turned = np.stack([-points[:, 1], points[:, 0]], axis=1)
    other = fit_covariance(turned, fit_ellipse(turned, "taubin").ellipse, "taubin")
    quarter = np.eye(5)
    quarter[:2, :2] = [[0, -1], [1, 0]]
    assert np.allclose(quarter @ covariance @ quarter.T, other, rtol=1e-6, atol=1e-12)


def test_the_unknown_angle_of_a_circle_is_bounded():
    points = point_at(Ellipse(0, 0, 20, 20, 0), np.linspace(0, 6, 60))
    points += 0.1 * np.sin(9.7 * np.arange(120).reshape(60, 2))
    covariance = fit_covariance(points, Ellipse(0, 0, 20, 20, 0), "halir_flusser")
    assert covariance[4, 4] <= np.pi**2 / 12 * 1.0001
    assert np.isfinite(covariance).all()


def test_five_points_and_wrong_arguments():
    points = point_at(TRUTH, np.arange(5.0))
    for method in ("geometric", "taubin"):
        assert np.isnan(fit_covariance(points, TRUTH, method)).all()
    with pytest.raises(ParameterError, match="geometric, ahn, halir_flusser"):
        fit_covariance(points, TRUTH, "chaudhuri")
    with pytest.raises(InputError, match="at least five"):
        fit_covariance(points[:4], TRUTH)
