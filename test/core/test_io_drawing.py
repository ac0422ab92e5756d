"""Overlays: drawn where they belong, and nowhere else."""

import numpy as np
import pytest

from geoprim_core.errors import InputError
from geoprim_core.io.drawing import draw_overlay
from geoprim_core.types import Contours, Detections, EllipseDetections, Ellipses, Polygons


def found(rows, score):
    count = len(rows)
    return EllipseDetections(
        Ellipses.from_array(np.reshape(rows, (count, 5))),
        np.full(count, score),
        *np.zeros((3, count)),
        np.full((count, 5, 5), np.nan),
    )


def test_the_outline_lies_on_the_ellipse_and_the_rest_is_untouched():
    image = np.full((120, 160, 3), 40, np.uint8)
    x, y, a, b, angle = 80.3, 59.6, 50.25, 30.5, 0.7
    overlay = draw_overlay(image, ellipses=found([[x, y, a, b, angle]], 1.0), labels=False)
    rows, columns = np.nonzero((overlay != image).any(axis=2))
    dx, dy = columns - x, rows - y
    u = dx * np.cos(angle) + dy * np.sin(angle)
    v = dy * np.cos(angle) - dx * np.sin(angle)
    level = np.hypot(u / a, v / b)
    distance = np.abs(level - 1) * level / np.hypot(u / a**2, v / b**2)
    assert len(rows) > 2 * np.pi * b
    assert distance.max() < 1.6
    weight = np.abs(overlay[rows, columns].astype(float) - 40).sum(axis=1)
    assert (weight * distance).sum() / weight.sum() < 0.5


@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.float32])
@pytest.mark.parametrize("channels", [(), (3,), (4,)])
def test_the_argument_is_never_written_into(kind, channels):
    image = np.random.default_rng(0).integers(0, 200, (60, 80, *channels)).astype(kind)
    before = image.copy()
    points = np.array([[10, 10], [11, 11], [12, 11]], float)
    contours = Contours(points, [0, 3], [False])
    overlay = draw_overlay(
        image,
        contours,
        Polygons([0, 2], [0, 2], [False]),
        ellipses=found([[40, 30, 20, 10, 0]], 0.5),
        caption="1 ellipse",
    )
    np.testing.assert_array_equal(image, before)
    assert overlay.shape == (60, 80, 3)
    assert overlay.dtype == np.uint8


def test_contour_pixels_are_coloured_and_those_outside_left_out():
    points = np.array([[2, 3], [3, 4], [4, 5], [900, 3]], float)
    overlay = draw_overlay(np.zeros((8, 8), np.uint8), Contours(points, [0, 4], [False]))
    assert np.argwhere(overlay.any(axis=2)).tolist() == [[3, 2], [4, 3], [5, 4]]


def test_better_scores_are_greener():
    def colour(score):
        circle = found([[20, 20, 15, 15, 0]], score)
        return draw_overlay(np.zeros((40, 40), np.uint8), ellipses=circle, labels=False)[20, 35]

    ranks = [int(c[1]) - int(c[2]) for c in (colour(0.0), colour(0.5), colour(1.0))]
    assert ranks == sorted(ranks)
    assert ranks[0] < 0 < ranks[2]


def test_an_ellipse_that_is_a_detection_too_is_drawn_once():
    image = np.zeros((80, 100), np.uint8)
    both = found([[30, 40, 20, 15, 0.4], [70, 40, 20, 15, 0.4]], 1.0)
    one = Detections(("a",), np.ones(1), np.zeros((1, 4)), both.ellipses.select([0]))
    apart = draw_overlay(image, ellipses=both, labels=False)
    together = draw_overlay(image, ellipses=both, detections=one, labels=False)
    np.testing.assert_array_equal(together, apart)


def test_labels_stay_inside_and_ellipses_may_reach_far_outside():
    rows = [[0, 0, 9, 9, 0], [79, 59, 9, 9, 0], [1e7, 30, 1e7, 1e6, 0.1], [40, -1e5, 1e5, 1e5, 0]]
    objects = Detections(
        ("a_long_label",) * 4, np.ones(4), np.zeros((4, 4)), Ellipses.from_array(rows)
    )
    overlay = draw_overlay(np.zeros((60, 80), np.uint8), detections=objects)
    assert overlay.any()


def test_a_one_pixel_image_can_be_drawn_on():
    overlay = draw_overlay(np.zeros((1, 1), np.uint8), ellipses=found([[0, 0, 3, 2, 0]], 1.0))
    assert overlay.shape == (1, 1, 3)


def test_polygons_without_their_contours_are_refused():
    with pytest.raises(InputError, match="contours"):
        draw_overlay(np.zeros((8, 8), np.uint8), polygons=Polygons([0, 1], [0, 2], [False]))
