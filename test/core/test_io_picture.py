"""Pictures of results: at any size the letters are read and the legend hides little."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from geoprim_core.io.drawing import draw_overlay
from geoprim_core.io.picture import draw_picture, enlargement
from geoprim_core.io.shown import OverlayParams
from geoprim_core.types import Detections, EllipseDetections, Ellipses

PLAIN = OverlayParams(legend=False, ids=False, scores=False)


def found(rows, score=1.0):
    count = len(rows)
    return EllipseDetections(
        Ellipses.from_array(np.reshape(rows, (count, 5))),
        np.full(count, score),
        *np.zeros((3, count)),
        np.full((count, 5, 5), np.nan),
    )


def grown(image, times):
    return np.repeat(image.repeat(times, axis=0).repeat(times, axis=1)[:, :, None], 3, axis=2)


@given(height=st.integers(1, 700), width=st.integers(1, 700))
def test_the_picture_begins_with_the_image_each_pixel_a_square(height, width):
    image = np.random.default_rng(height).integers(0, 255, (height, width)).astype(np.uint8)
    picture = draw_picture(image, found([]), params=PLAIN)
    np.testing.assert_array_equal(picture, grown(image, enlargement(image.shape)))


@pytest.mark.parametrize(("height", "width"), [(480, 640), (1200, 1600)])
def test_a_large_image_is_drawn_on_as_it_is(height, width):
    image = np.full((height, width), 90, np.uint8)
    one = found([[200, 150, 80, 60, 0.3]])
    np.testing.assert_array_equal(draw_picture(image, one), draw_overlay(image, ellipses=one))


def test_the_outline_grows_with_the_image():
    image = np.zeros((60, 80), np.uint8)  # eight times as large
    picture = draw_picture(image, found([[30.25, 25, 20, 12, 0]]), params=PLAIN)
    lit = picture.max(axis=2) > 100
    y, x = np.nonzero(lit)
    # the centre of pixel 0 lies in the middle of its square, at 3.5
    assert (x.min() + x.max()) / 2 == pytest.approx(8 * 30.25 + 3.5, abs=0.6)
    assert (x.max() - x.min()) / 2 == pytest.approx(160, abs=1.5)
    assert (y.min() + y.max()) / 2 == pytest.approx(8 * 25 + 3.5, abs=0.6)


def test_an_object_that_is_an_ellipse_too_is_drawn_once():
    image = np.zeros((60, 80), np.uint8)
    both = found([[30, 25, 10, 8, 0.4], [60, 35, 10, 8, 0.4]])
    one = Detections(("a",), np.ones(1), np.zeros((1, 4)), both.ellipses.select([0]))
    apart, together = draw_picture(image, both, params=PLAIN), draw_picture(image, both, one)
    named = OverlayParams(legend=False, ids=False, scores=False, classes=False)
    np.testing.assert_array_equal(draw_picture(image, both, one, params=named), apart)
    assert (together != apart).any(), "its class is written"


@pytest.mark.parametrize(
    "size", [(30, 40), (80, 100), (240, 320), (480, 640), (60, 640), (640, 50)]
)
def test_the_legend_is_there_and_covers_little_of_the_image(size):
    image = np.full(size, 90, np.uint8)
    with_legend = draw_picture(image, found([]), scheme="refined")
    plain = draw_picture(image, found([]), params=PLAIN)
    height, width = plain.shape[:2]
    covered = (with_legend[:height, :width] != plain).any(axis=2).mean()
    assert covered <= 0.06
    assert covered or with_legend.size > plain.size
    violet = (np.abs(with_legend.astype(int) - with_legend[..., :1]) > 60).any(axis=2)
    assert violet.sum() > 200, "the scale of colours"


def test_pictures_of_one_size_stay_of_one_size():
    image = np.full((30, 40), 90, np.uint8)
    sizes = {draw_picture(image, found([[20, 15, 9, 9, 0]] * n)).shape for n in (0, 1, 9, 10, 100)}
    assert len(sizes) == 1


def test_an_overlay_keeps_the_size_of_the_image_and_has_no_legend_that_hides_it():
    image = np.full((80, 100), 90, np.uint8)
    overlay = draw_overlay(image, ellipses=found([]), scheme="refined")
    np.testing.assert_array_equal(overlay, np.repeat(image[:, :, None], 3, axis=2))
