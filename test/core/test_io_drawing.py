"""Overlays: drawn where they belong, and nowhere else."""

import numpy as np
import pytest

from geoprim_core.errors import InputError, ParameterError
from geoprim_core.io.drawing import draw_overlay, overlay_scale
from geoprim_core.io.lettering import Page
from geoprim_core.io.score_colours import score_colours
from geoprim_core.io.shown import OverlayParams, to_show
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
    touched = distance_to_ellipse(columns, rows, x, y, a, b, angle)
    assert touched.max() < 3.0  # with the black edge
    lit = overlay.max(axis=2).astype(float) - 40
    rows, columns = np.nonzero(lit > 0)
    distance = distance_to_ellipse(columns, rows, x, y, a, b, angle)
    weight = lit[rows, columns]
    assert len(rows) > 2 * np.pi * b
    assert distance.max() < 1.6
    assert (weight * distance).sum() / weight.sum() < 0.5


def distance_to_ellipse(columns, rows, x, y, a, b, angle):
    dx, dy = columns - x, rows - y
    u = dx * np.cos(angle) + dy * np.sin(angle)
    v = dy * np.cos(angle) - dx * np.sin(angle)
    level = np.hypot(u / a, v / b)
    return np.abs(level - 1) * level / np.hypot(u / a**2, v / b**2)


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


def lightness(colours):
    """Return CIE L* (n,) of red, green, blue (n, 3) in [0, 1]."""
    linear = np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)
    return 116 * np.cbrt(linear @ [0.2126, 0.7152, 0.0722]) - 16


def test_colours_of_scores_grow_lighter_and_never_dark():
    light = lightness(score_colours(np.linspace(0, 1, 101)))
    assert (np.diff(light) > 0.2).all()
    assert light[0] > 35  # told from the black edge
    assert light[-1] > 90


def test_colours_outside_the_scale_are_those_of_its_ends():
    ends = score_colours(np.array([0.5, 1.0]), 0.5, 1.0)
    np.testing.assert_array_equal(score_colours(np.array([0.0, 7.0]), 0.5, 1.0), ends)
    with pytest.raises(ParameterError, match="score_low"):
        OverlayParams(score_low=0.7, score_high=0.7)


def test_better_scores_are_lighter_on_the_picture():
    def colour(score):
        circle = found([[20, 20, 15, 15, 0]], score)
        drawn = draw_overlay(np.zeros((40, 40), np.uint8), ellipses=circle, labels=False)
        return drawn[20, 35, ::-1] / 255

    light = lightness(np.array([colour(score) for score in (0.5, 0.75, 1.0)]))
    assert (np.diff(light) > 10).all()


def test_a_picture_of_contours_and_polygons_has_no_legend_of_ellipses():
    square = Contours([(40, 40), (60, 40), (60, 60), (40, 60)], [0, 4], [True])
    polygon = Polygons([0, 1, 2, 3], [0, 4], [True])
    overlay = draw_overlay(np.zeros((200, 300), np.uint8), square, polygon)
    y, x = np.nonzero(overlay.any(axis=2))
    assert x.min() >= 36 and x.max() <= 64 and y.min() >= 36 and y.max() <= 64


def test_the_legend_lies_where_nothing_is_drawn_and_can_be_left_out():
    ground = np.full((480, 640), 90, np.uint8)  # fonts of OpenCV 4.6 need more of a small one
    nothing = OverlayParams(legend=False, ids=False, scores=False)
    for x, y in ((120, 90), (520, 90), (120, 390), (520, 390)):  # in each corner
        one = found([[x, y, 100, 60, 0]], 0.9)
        plain = draw_overlay(ground, ellipses=one, params=OverlayParams(legend=False))
        legend = draw_overlay(ground, ellipses=one, scheme="refined")
        drawn, added = (plain != 90).any(axis=2), (plain != legend).any(axis=2)
        assert drawn.any() and added.any()
        assert not (drawn & added).any()
    outlines = draw_overlay(ground, ellipses=one, labels=False)
    np.testing.assert_array_equal(outlines, draw_overlay(ground, ellipses=one, params=nothing))


def test_a_caption_is_whole_or_left_out():
    wide, narrow = np.zeros((40, 300), np.uint8), np.zeros((40, 60), np.uint8)
    assert draw_overlay(wide, caption="rdp_mod: 12 vertices").any()
    assert not draw_overlay(narrow, caption="rdp_mod: 12 vertices").any()


def test_texts_do_not_lie_on_each_other():
    page = Page(np.zeros((200, 200, 3), np.uint8), 1.0)
    turn = np.linspace(0, 2 * np.pi, 90)
    circle = 100 + 30 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    written = []
    while True:  # on one circle, until there is no more room
        before = page.canvas.copy()
        if not page.write_at(circle, "#0 coin 1.00", "#0", (255.0, 255.0, 255.0)):
            break
        written.append((page.canvas != before).any(axis=2))
    assert len(written) >= 5
    assert (np.sum(written, axis=0) <= 1).all()


@pytest.mark.parametrize("size", [(480, 640), (1500, 2000)])
def test_letters_are_of_a_readable_size(size):
    page = Page(np.zeros((*size, 3), np.uint8), overlay_scale(size))
    assert 12 <= page.size_of("#0 1.00")[1] <= 0.04 * size[0]


def test_numbers_are_places_in_the_message_of_the_ellipses():
    three = found([[30, 40, 20, 15, 0.4], [70, 40, 20, 15, 0.4], [90, 90, 9, 9, 0]], 1.0)
    last = Detections(("a",), np.ones(1), np.zeros((1, 4)), three.ellipses.select([2]))
    shown = to_show(three, last)
    assert shown.ids == (0, 1, 2)
    assert shown.labels == ("", "", "a")
    only = to_show(three, last, OverlayParams(ellipses=False))
    assert (only.ids, only.labels) == ((2,), ("a",))
    np.testing.assert_array_equal(only.ellipses.array(), last.ellipses.array())


def test_an_object_that_is_no_ellipse_of_the_frame_is_shown_too():
    one = found([[30, 40, 20, 15, 0.4]], 0.9)
    other = Detections(("a",), np.ones(1), np.zeros((1, 4)), Ellipses.from_array([[9, 9, 5, 5, 0]]))
    shown = to_show(one, other)
    assert (shown.ids, shown.labels) == ((0, 1), ("", "a"))
    assert shown.score.tolist() == [0.9, 1.0]


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
