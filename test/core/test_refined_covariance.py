"""The covariance kernels of the `refined` scheme against errors whose law is known."""

from __future__ import annotations

import numpy as np
import pytest

from geoprim_core.ecc.refined import _kernels_covariance as spread
from geoprim_core.ecc.refined import _kernels_final as final

TURN = np.linspace(-np.pi, np.pi, 400, endpoint=False)
DISC = np.array([50.0, 40.0, 40.0, 40.0, 0.0])


def claimed_for(errors, ellipse=DISC):
    """Return the covariance claimed for a circle with these errors along its normals."""
    radius = ellipse[2] + errors
    turn = np.linspace(-np.pi, np.pi, len(errors), endpoint=False)
    points = np.stack([50 + radius * np.cos(turn), 40 + radius * np.sin(turn)], axis=1)
    return spread.covariance_of(points, ellipse, 2.0, 1.0)


def test_the_covariance_of_independent_errors_is_the_textbook_one_and_a_margin():
    # n points with variance s^2 all round: the centre has the variance 2 s^2 / n.
    errors = 0.1 * np.random.default_rng(1).standard_normal((30, 400))
    covariance = np.mean([claimed_for(each) for each in errors], axis=0)
    ratio = np.diag(covariance)[:2] / (2 * 0.1**2 / 400)
    assert np.all(ratio > 1.1) and np.all(ratio < 1.9)
    assert 0.5 < np.sqrt(covariance[4, 4]) < np.pi / np.sqrt(12) + 1e-6
    assert np.array_equal(covariance, covariance.T)


@pytest.mark.parametrize("count, radius", [(30, 5.0), (44, 7.0), (120, 19.0)])
def test_what_a_small_ellipse_takes_up_of_the_errors_is_claimed_for(count, radius):
    # Errors of which the low frequencies hold 2.9 times the variance, as neighbours err alike.
    turn = np.linspace(-np.pi, np.pi, count, endpoint=False)
    bends = [wave(m * turn) for m in (1, 2) for wave in (np.cos, np.sin)]
    waves = np.stack([turn**0, *bends], axis=1)
    apart = np.minimum(np.arange(count), count - np.arange(count))
    alike = np.fft.rfft(np.exp(-0.5 * (apart / 0.82) ** 2))
    white = np.random.default_rng(5).standard_normal((200, count))
    errors = 0.05 * np.fft.irfft(np.fft.rfft(white) * alike, count)
    taken = np.linalg.lstsq(waves, errors.T, rcond=None)[0]
    circle = np.array([50.0, 40.0, radius, radius, 0.0])
    left = errors - (waves @ taken).T
    claimed = np.mean([claimed_for(each, circle)[0, 0] for each in left])
    assert 1.0 < claimed / np.mean(taken[1] ** 2) < 2.0


def test_errors_that_go_together_widen_the_covariance():
    # Means of eight neighbours: the variance per point at low frequencies is eight times theirs.
    white = np.random.default_rng(2).standard_normal(407)
    together = np.convolve(white, np.ones(8) / 8, mode="valid")
    errors = 0.1 * together / together.std()
    ratio = np.diag(claimed_for(errors))[:2] / (2 * 0.1**2 / 400)
    assert np.all(ratio > 4) and np.all(ratio < 12)


def test_a_circle_without_errors_is_in_doubt_by_an_unknown_blur():
    for radius in (10.0, 80.0):
        covariance = claimed_for(np.zeros(400), np.array([50.0, 40.0, radius, radius, 0.0]))
        mean = np.array([0, 0, 0.5, 0.5, 0])
        doubt = np.sqrt(mean @ covariance @ mean)
        assert doubt == pytest.approx(0.5 * spread.BLUR_DOUBT / radius, rel=0.05)
        assert np.all(np.diag(covariance)[:2] < 1e-6)


def test_five_points_and_fewer_determine_no_covariance():
    points = DISC[:2] + np.array([[40.0, 0.0], [40.0, 0.0], [40.0, 0.0]])
    assert np.isnan(spread.covariance_of(points, DISC, 1.0, 1.0)).all()


def test_points_beside_a_gap_are_left_out_and_a_whole_outline_is_kept():
    assert len(final.support_inside(TURN, DISC, final.GAP)) == 400
    half = TURN[TURN < 0]
    assert len(final.support_inside(half, DISC, 40 * np.pi + 1)) == len(half)
    kept = half[final.support_inside(half, DISC, final.GAP)]
    lost = 40 * np.array([kept[0] - half[0], half[-1] - kept[-1]])
    step = 40 * (TURN[1] - TURN[0])
    assert np.all(lost >= final.TRIM - step) and np.all(lost <= final.TRIM + step)


def test_noise_may_leave_gaps_that_end_no_arc():
    step = TURN[1] - TURN[0]
    ten = TURN[: -int(10 / (40 * step))]
    assert len(final.support_inside(ten, DISC, final.NOISE_GAP)) == len(ten)
    assert len(final.support_inside(ten, DISC, final.GAP)) < len(ten)
