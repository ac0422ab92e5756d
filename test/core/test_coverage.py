"""Whether the covariances of detections hold, and whether the measure of that does."""

from __future__ import annotations

import numpy as np
import pytest

from geoprim_core.errors import InputError
from geoprim_core.evaluation import measure_coverage
from geoprim_core.evaluation.coverage import LEVELS, squared_distance
from geoprim_core.synthetic import single_ellipses


@pytest.fixture(scope="module")
def coverage():
    return measure_coverage(500, seed=20)


def test_the_regions_hold_as_often_as_they_say(coverage):
    """68 +- 5 % and 95 +- 3 %, and what chance adds to a sample of this size (99.5 %)."""
    for level, tolerance in zip(LEVELS, (0.05, 0.03), strict=True):
        chance = 2.6 * np.sqrt(level * (1 - level) / len(coverage.squares))
        assert abs(coverage.joint_share(level) - level) < tolerance + chance


def test_every_parameter_holds_by_itself(coverage):
    row = coverage.rows[0]
    assert row.regime == "all"
    assert row.count == len(coverage.squares) > 200
    assert np.all(np.abs(row.single - LEVELS) < 0.15)
    assert np.all(row.single[:, 0] < row.single[:, 1])


def test_every_picture_is_accounted_for(coverage):
    assert len(coverage.squares) + coverage.missed + coverage.unresolved == 500
    assert coverage.markdown().count("\n") == len(coverage.rows) + 3


def test_the_same_seed_gives_the_same_figures():
    one, other = (measure_coverage(12, seed=5) for _ in range(2))
    assert one.squares.tobytes() == other.squares.tobytes()


def drawn(truth, deviation, count, seed=0):
    """Draw ellipses whose smooth parameters err by a standard deviation, and their covariances."""
    x, y, a, b, angle = truth
    half = 0.5 * (a - b)
    smooth = np.array([x, y, 0.5 * (a + b), half * np.cos(2 * angle), half * np.sin(2 * angle)])
    for sample in np.random.default_rng(seed).normal(smooth, deviation, (count, 5)):
        half, angle = np.hypot(sample[3], sample[4]), 0.5 * np.arctan2(sample[4], sample[3])
        row = np.array([*sample[:2], sample[2] + half, sample[2] - half, angle % np.pi])
        spread = np.array([1, 1, 2, 2, 1 / (4 * half**2)]) * deviation**2
        yield row, np.diag(spread)


@pytest.mark.parametrize("truth", [[50, 40, 30, 20, 0.4], [50, 40, 30, 30, 0.0]])
def test_the_distance_of_normal_errors_follows_chi_square_also_at_a_circle(truth):
    truth = np.array(truth, float)
    squares = [squared_distance(row, c, truth) for row, c in drawn(truth, 0.05, 2000)]
    assert np.mean(squares) == pytest.approx(5, abs=0.3)
    assert np.mean(np.array(squares) < 5.861) == pytest.approx(0.68, abs=0.03)


def test_the_angle_of_a_circle_does_not_matter():
    covariance = np.diag([0.01, 0.01, 0.02, 0.02, 0.3])
    row, truth = np.array([50, 40, 30.1, 29.9, 0.2]), np.array([50, 40, 30, 30, 0.0])
    turned = truth + np.array([0, 0, 0, 0, 1.3])
    one, other = (squared_distance(row, covariance, circle) for circle in (truth, turned))
    assert one == pytest.approx(other)


def test_pictures_of_one_ellipse_keep_to_their_bounds():
    for one in single_ellipses(60, seed=1):
        row = one.scene.ellipses.array()[0]
        width, height = one.scene.image_size
        assert 8 <= row[2] <= 150
        assert 4 <= row[3] <= row[2]
        assert row[2] < min(row[0], row[1], width - 1 - row[0], height - 1 - row[1])
        assert 0.3 <= one.visible <= 1
        assert 30 <= one.contrast <= 200
        assert 1 <= one.noise <= 15
        assert 0 <= one.blur <= 1.5


def test_a_picture_does_not_depend_on_how_many_are_made():
    first = next(single_ellipses(1, seed=9))
    again = next(single_ellipses(50, seed=9))
    assert first.scene.image.tobytes() == again.scene.image.tobytes()
    with pytest.raises(InputError, match="seed"):
        single_ellipses(1, seed=-1)
