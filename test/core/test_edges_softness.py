"""How softly edges rise: measured from the gradient, whatever their height and direction."""

import math

import cv2
import numpy as np
import pytest

from geoprim_core.edges import EdgeParams, extract_contours
from geoprim_core.errors import InputError
from geoprim_core.synthetic import ellipse_image, render_ellipses
from geoprim_core.types import Contours, Ellipse, Ellipses

OWN = 0.5 + 1.0 / 12.0  # px^2: of the Sobel filter, of a pixel


def blurred(image, blur):
    return cv2.GaussianBlur(image, (0, 0), blur) if blur > 0.0 else image


def ring(radius, inside=200):
    truth = Ellipses.from_array([[100.3, 89.6, radius, radius, 0.0]])
    levels = np.array([float(inside)])
    return render_ellipses(
        truth, (200, 180), drawing="outlines", levels=levels, background=40.0, stroke=1.0
    )


@pytest.mark.parametrize("blur", [0.0, 0.7, 1.5, 3.0])
@pytest.mark.parametrize("inside", [200, 70])
def test_the_softness_of_a_blurred_step_is_that_of_all_its_smoothing(blur, inside):
    disc = ellipse_image(200, 180, Ellipse(100.3, 89.6, 60.0, 45.0, 0.6), inside=inside)
    contours = extract_contours(blurred(disc, blur))
    assert contours.softness == pytest.approx(math.sqrt(blur**2 + contours.blur**2 + OWN), rel=0.05)


@pytest.mark.parametrize("blur", [1.5, 2.0, 3.0])
def test_either_edge_of_a_hair_line_shows_half_of_the_variance(blur):
    contours = extract_contours(blurred(ring(60.0), blur))
    whole = blur**2 + contours.blur**2 + OWN
    assert contours.softness == pytest.approx(math.sqrt(0.5 * whole), rel=0.05)


@pytest.mark.parametrize("turn", [np.rot90, np.fliplr, np.transpose])
def test_the_softness_does_not_turn_with_the_image(turn):
    image = blurred(ring(50.0), 1.0)
    turned = extract_contours(np.ascontiguousarray(turn(image))).softness
    assert turned == pytest.approx(extract_contours(image).softness, rel=0.02)


def test_without_edges_there_is_no_softness():
    assert math.isnan(extract_contours(np.full((40, 50), 90, np.uint8)).softness)
    assert math.isnan(Contours(np.zeros((0, 2)), [0], []).softness)


def test_a_softness_below_zero_is_refused():
    with pytest.raises(InputError, match="softness"):
        Contours(np.zeros((0, 2)), [0], [], softness=-1.0)


def test_the_softness_is_measured_before_the_linking_and_kept_by_either():
    image = blurred(ring(40.0), 2.0)
    both = [extract_contours(image, EdgeParams(linking=way)) for way in ("direction", "junctions")]
    assert both[0].softness == both[1].softness
