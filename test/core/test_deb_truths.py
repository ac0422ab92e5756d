"""DEB: the chord that a circle cuts out of the curve."""

import numpy as np
import pytest

from geoprim_core.errors import ParameterError
from geoprim_core.tangent import DebParams, deb


def angle_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.abs((a - b + np.pi) % (2 * np.pi) - np.pi)


def digital_circle(radius: float, centre: tuple[float, float]) -> np.ndarray:
    t = np.linspace(0, 2 * np.pi, int(40 * radius), endpoint=False)
    pixels = np.rint(radius * np.stack([np.cos(t), np.sin(t)], axis=1) + centre)
    return pixels[(pixels != np.roll(pixels, 1, axis=0)).any(axis=1)]


def test_mean_error_on_circles_is_that_of_the_corrected_loop():
    # Errata T1: 1.2 degrees for R = 10 on circles of radius 100, 14.6 with the printed loop.
    errors = []
    for centre in [(0.0, 0.0), (0.3, 0.1), (0.5, 0.25), (0.9, 0.6)]:
        circle = digital_circle(100, centre)
        x, y = (circle - centre).T
        angle = deb(circle, closed=True, params=DebParams(radius=10.0))
        errors.append(angle_between(angle, np.arctan2(x, -y)).mean())
    assert np.degrees(np.mean(errors)) == pytest.approx(1.2, abs=0.15)


@pytest.mark.parametrize("radius", [1.0, 4.0, 7.5])
def test_ends_of_an_open_line_are_undefined_as_far_as_the_circle_reaches(radius):
    line = np.stack([np.arange(40.0), np.zeros(40)], axis=1)
    undefined = np.isnan(deb(line, params=DebParams(radius=radius)))
    reach = int(np.ceil(radius - np.sqrt(0.5)))
    assert np.flatnonzero(~undefined).tolist() == list(range(reach, 40 - reach))


def test_chord_joins_the_first_pixels_on_the_circle():
    # Radius 4: the corner's pixels at distance 4 backwards and forwards are (6, 0), (10, 4).
    corner = np.array([(i, 0) for i in range(11)] + [(10, j) for j in range(1, 11)])
    assert deb(corner)[10] == pytest.approx(np.pi / 4)
    # The first pixel beyond 4 - 1 / sqrt(2) from (9, 0) forwards is (10, 4), backwards (5, 0).
    assert deb(corner)[9] == pytest.approx(np.arctan2(4, 5))


def test_a_leftward_line_is_pi_and_never_minus_pi():
    line = np.stack([-np.arange(20.0), np.zeros(20)], axis=1)
    assert deb(line)[10] == np.pi


def test_a_closed_curve_smaller_than_the_circle_is_undefined():
    ring = digital_circle(2, (0, 0))
    assert np.isnan(deb(ring, closed=True, params=DebParams(radius=20.0))).all()


def test_a_closed_curve_is_defined_across_its_seam():
    circle = digital_circle(30, (0, 0))
    assert not np.isnan(deb(circle, closed=True)).any()
    assert np.isnan(deb(circle, closed=False)[[0, -1]]).all()


def test_a_curve_that_folds_back_onto_itself_has_no_direction_at_the_fold():
    fold = np.array([(i, 0) for i in range(11)] + [(i, 0) for i in range(9, -1, -1)])
    assert np.isnan(deb(fold)[10])


def test_radius_out_of_range_is_refused():
    with pytest.raises(ParameterError, match="radius"):
        DebParams(radius=0.0)
