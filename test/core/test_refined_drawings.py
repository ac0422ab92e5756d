"""Line drawings: both edges of a line are one curve, however near the next line is."""

import cv2
import numpy as np
import pytest

from geoprim_core.ecc import DetectorParams, detect_ellipses
from geoprim_core.edges import EdgeParams
from geoprim_core.edges.canny import channels_of, steady_gradient
from geoprim_core.synthetic import render_ellipses
from geoprim_core.types import Ellipses

SIZE = (220, 200)


def rings(radii, width, ink=20.0, paper=225.0, noise=0.0, seed=0):
    """Return a drawing of concentric circles."""
    rows = [[108.3, 97.6, radius, radius, 0.0] for radius in radii]
    image = render_ellipses(
        Ellipses.from_array(rows), SIZE, kind="overlapping", drawing="outlines",
        levels=np.full(len(rows), ink), background=paper, stroke=width,
    )  # fmt: skip
    noisy = image + np.random.default_rng(seed).normal(0.0, noise, image.shape)
    return np.clip(np.rint(noisy), 0, 255).astype(np.uint8)


def radii_found(image, **changes):
    found = detect_ellipses(image, DetectorParams().updated(changes)).ellipses
    return np.sort(np.sqrt(found.semi_major * found.semi_minor))


@pytest.mark.parametrize("gap", [1.8, 2.2, 3.0, 4.0])
@pytest.mark.parametrize(("ink", "paper"), [(20.0, 225.0), (230.0, 40.0)])
def test_lines_nearer_to_each_other_than_they_are_wide_are_lines(gap, ink, paper):
    wanted = 25.0 + (4.0 + gap) * np.arange(4)
    found = radii_found(rings(wanted, 4.0, ink, paper))
    assert len(found) == len(wanted)
    np.testing.assert_allclose(found, wanted, atol=0.4)


@pytest.mark.parametrize("radius", [6.0, 8.0, 40.0])
def test_one_small_circle_drawn_in_noise_is_one_line(radius):
    found = [radii_found(rings([radius], 2.0, 100.0, 180.0, 12.0, seed)) for seed in range(8)]
    assert all(len(radii) == 1 and abs(radii[0] - radius) < 0.6 for radii in found)


def lines_found(**changes):
    """Return how many of 120 thin circles, drawn 3.3 times as high as the noise, are found."""
    count = 0
    for seed, radius in enumerate(6 * list(range(15, 75, 3))):
        radii = radii_found(rings([radius], 1.0, 90.0, 190.0, 30.0, seed), **changes)
        count += len(radii) == 1 and abs(radii[0] - radius) < 1.0
    return count


def test_thin_lines_that_noise_drowns_are_found_by_more_blur():
    assert lines_found() > lines_found(**{"edges.drowned_sigma": 0.0}) + 15


def blur_of(image, **changes):
    params = EdgeParams().updated(changes)
    return steady_gradient(channels_of(image, params), params).blur


def test_the_blur_grows_further_only_where_noise_drowns_the_edges():
    params, nothing = EdgeParams(), rings([40.0], 2.0, 128.0, 128.0, 30.0)
    assert blur_of(rings([40.0], 2.0, noise=25.0)) == params.noise_sigma
    assert blur_of(nothing) == params.drowned_sigma
    assert blur_of(nothing, drowned_sigma=0.0) == params.noise_sigma


@pytest.mark.parametrize("blur", [1.0, 2.0, 3.0])
@pytest.mark.parametrize("radius", [7.0, 12.0, 40.0])
def test_a_blurred_hair_line_is_one_line_however_wide_it_looks(blur, radius):
    image = cv2.GaussianBlur(rings([radius], 1.5), (0, 0), blur)
    found = radii_found(image)
    assert len(found) == 1
    assert abs(found[0] - radius) < 0.25


@pytest.mark.parametrize("gap", [6.5, 7.5, 9.0])
def test_a_broad_ring_with_sharp_edges_is_two_circles(gap):
    rows = [[108.3, 97.6, radius, radius, 0.0] for radius in (40.0, 40.0 - gap)]
    image = render_ellipses(
        Ellipses.from_array(rows), SIZE, levels=np.array([40.0, 200.0]), background=200.0
    )
    np.testing.assert_allclose(radii_found(image), [40.0 - gap, 40.0], atol=0.2)
