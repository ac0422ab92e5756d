"""Outlines drawn without grey levels in between: the blur grows, small circles are found whole."""

import numpy as np
import pytest

from geoprim_core.ecc import DetectorParams, detect_ellipses
from geoprim_core.edges import EdgeParams, extract_contours
from geoprim_core.edges.canny import channels_of, find_edges, steady_gradient
from geoprim_core.edges.stairs import hard_share, smooth_edges
from geoprim_core.synthetic import circles_image, thesis_image

PLAIN = EdgeParams(stair_sigma=0.0)


def hard_disc(radius, size=120, low=30, high=220):
    """Return a disc of two levels only around the middle pixel."""
    y, x = np.mgrid[:size, :size] - size // 2
    return np.where(np.hypot(x, y) <= radius, high, low).astype(np.uint8)


def share_of(image):
    """Return the share of hard steps of an image."""
    channels = channels_of(image, PLAIN)
    return hard_share(channels, find_edges(steady_gradient(channels, PLAIN), PLAIN))


def test_all_steps_of_an_image_of_two_levels_are_hard():
    random = np.random.default_rng(3)
    for radius in random.uniform(4, 50, 8):
        assert share_of(hard_disc(radius)) == 1.0


def test_rendered_images_keep_their_blur():
    for seed in (1, 2, 3):
        for kind in ("occluded", "overlapping"):
            for drawing in ("filled", "outlines"):
                image = thesis_image(12, seed, kind=kind, drawing=drawing).image
                assert smooth_edges(image, EdgeParams()).gradient.blur == EdgeParams().sigma


@pytest.mark.parametrize("radius", [4.5, 5, 8.5, 9, 10.5, 13, 17])
def test_a_small_hard_disc_is_one_contour_and_one_circle(radius):
    image = hard_disc(radius)
    assert extract_contours(image).closed.sum() == 1
    assert not extract_contours(image, PLAIN).closed.any()  # what this is for
    found = detect_ellipses(image).ellipses
    assert len(found) == 1
    axes = [found.semi_major[0], found.semi_minor[0]]
    np.testing.assert_allclose(axes, radius, atol=0.5)
    np.testing.assert_allclose([found.x[0], found.y[0]], 60, atol=0.1)


def discs_found(draws, **changes):
    """Return how many hard discs of 4.5 to 9 pixels radius at any place are found as they are."""
    params = DetectorParams().updated(changes)
    y, x = np.mgrid[:60, :60] - 30
    count = 0
    for draw in range(draws):
        random = np.random.default_rng(draw)
        radius, (cx, cy) = random.uniform(4.5, 9), random.uniform(-0.5, 0.5, 2)
        image = np.where(np.hypot(x - cx, y - cy) <= radius, 220, 30).astype(np.uint8)
        found = detect_ellipses(image, params).ellipses
        count += len(found) == 1 and abs(found.semi_major[0] - radius) < 0.5
    return count


def test_small_hard_discs_are_found_wherever_they_lie_between_pixels():
    assert discs_found(100) == 100
    assert discs_found(100, **{"edges.max_jerk": 0.0}) < 98  # what the step is for


def test_without_the_step_such_discs_are_missed():
    params = DetectorParams().updated({"edges.stair_sigma": 0.0})
    assert len(detect_ellipses(hard_disc(13), params).ellipses) == 0


@pytest.mark.parametrize("colours", [False, True])
def test_turned_and_mirrored_images_have_the_same_share(colours):
    random = np.random.default_rng(5)
    image = circles_image(5, seed=4, noise=10).image[:300, :280]
    image = np.where(random.random(image.shape) < 0.01, 255, image).astype(np.uint8)
    if colours:
        image = np.stack([image, 255 - image, image], axis=2)
    share = share_of(image)
    assert 0.0 < share < 1.0
    for turned in (np.rot90(image), image[::-1], image[:, ::-1], np.rot90(image, 2)):
        assert share_of(np.ascontiguousarray(turned)) == share


def test_grey_levels_of_any_type_have_the_same_share():
    image = circles_image(5, seed=6, noise=10).image
    image[0, 0], image[0, 1] = 0, 255  # what other types are stretched to
    assert share_of(image) == share_of(image.astype(np.uint16)) == share_of(image.astype(float))


def test_an_image_without_edges_has_no_hard_steps():
    assert share_of(np.full((40, 40), 7, np.uint8)) == 0.0
