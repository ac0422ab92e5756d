"""The data types refuse what contradicts itself and keep what they were given."""

from dataclasses import replace

import numpy as np
import pytest

from geoprim_core import _check
from geoprim_core.errors import ImageError, InputError
from geoprim_core.types import Contours, Ellipse, EllipseDetections, Ellipses, Polygons, Tangents


def two_contours():
    points = [[0, 0], [1, 0], [2, 1], [5, 5], [6, 5]]
    return Contours(points=points, offsets=[0, 3, 5], closed=[False, False], image_size=(9, 8))


def test_contours_are_sliced_by_their_offsets():
    contours = two_contours()
    assert [c.tolist() for c in contours] == [[[0, 0], [1, 0], [2, 1]], [[5, 5], [6, 5]]]
    np.testing.assert_array_equal(contours[-1], contours[1])
    with pytest.raises(IndexError):
        contours[2]


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"points": [[0, 0, 0]]}, "points: expected"),
        ({"points": [[0, np.nan]] * 5}, "points: expected finite numbers, got nan at \\[0, 1\\]"),
        ({"offsets": [0, 3, 4]}, "offsets: expected offsets that start at 0"),
        ({"offsets": [1, 3, 5]}, "offsets: expected offsets that start at 0"),
        ({"offsets": [0, 6, 5]}, "offsets: expected offsets that start at 0"),
        ({"closed": [True]}, "closed: expected 2 flags"),
        ({"image_size": (0, 4)}, "image_size: expected a width and a height of at least 1"),
        ({"subpixel": np.zeros((4, 2))}, "subpixel: expected"),
        ({"gradient_angle": np.zeros(4)}, "gradient_angle: expected"),
    ],
)
def test_contours_that_contradict_themselves_are_refused(change, text):
    good = two_contours()
    fields = {"points": good.points, "offsets": good.offsets, "closed": good.closed}
    with pytest.raises(InputError, match=text):
        Contours(**{**fields, **change})


def test_polygon_vertices_are_looked_up_in_their_own_contour():
    contours = two_contours()
    polygons = Polygons(indices=[0, 2, 0, 1], offsets=[0, 2, 4], closed=[False, False])
    assert polygons.vertices(contours).tolist() == [[0, 0], [2, 1], [5, 5], [6, 5]]


@pytest.mark.parametrize("indices", [[0, 0, 0, 1], [2, 1, 0, 1], [-1, 2, 0, 1]])
def test_polygon_indices_have_to_increase(indices):
    with pytest.raises(InputError, match="increase"):
        Polygons(indices=indices, offsets=[0, 2, 4], closed=False)


def test_empty_polygons_between_others_are_fine():
    polygons = Polygons(indices=[3, 5, 0, 1], offsets=[0, 2, 2, 4], closed=False)
    assert [p.tolist() for p in (polygons[0], polygons[1], polygons[2])] == [[3, 5], [], [0, 1]]


@pytest.mark.parametrize(
    "values", [(0, 0, 1, 2, 0), (0, 0, 1, 0, 0), (0, 0, 2, 1, np.pi), (np.inf, 0, 2, 1, 0)]
)
def test_impossible_ellipses_are_refused(values):
    with pytest.raises(InputError):
        Ellipse(*values)
    with pytest.raises(InputError):
        Ellipses.from_array([values])


def test_arguments_are_copied_or_shared_but_never_written():
    points = np.array([[0, 0], [1, 0]], np.int32)
    before = points.copy()
    contours = Contours(points=points, offsets=[0, 2], closed=[False])
    contours.points[0, 0] = 7.0
    np.testing.assert_array_equal(points, before)


@pytest.mark.parametrize(
    "image",
    [
        None,
        "photo.png",
        np.zeros((0, 5), np.uint8),
        np.zeros((5, 0, 3), np.uint8),
        np.zeros((5, 5, 2), np.uint8),
        np.zeros(5, np.uint8),
        np.zeros((5, 5), np.int64),
        np.zeros((5, 5), complex),
        np.full((5, 5), np.nan),
        np.full((5, 5), np.inf, np.float32),
    ],
    ids=str,
)
def test_what_is_no_image_is_refused_in_one_sentence(image):
    with pytest.raises(ImageError, match=r"^image: expected .*, got "):
        _check.image(image)


def test_detections_keep_what_was_left_out_and_a_complete_result_has_no_reason():
    found = replace(EllipseDetections.empty((9, 8)), complete=False, reason="max_pairs = 1")
    assert found.select(slice(0, 0)).reason == "max_pairs = 1"
    assert not found.select(slice(0, 0)).complete
    assert EllipseDetections.empty().complete
    with pytest.raises(InputError, match="reason: expected no text where the result is complete"):
        replace(found, complete=True)


def test_angles_are_sliced_as_the_contours_are():
    contours = two_contours()
    tangents = Tangents(angle=np.arange(5.0), offsets=contours.offsets)
    assert [angles.tolist() for angles in tangents] == [[0, 1, 2], [3, 4]]
    assert len(tangents) == 2 and tangents[-1].tolist() == [3, 4]
    with pytest.raises(IndexError, match="contour 2 of 2"):
        tangents[2]


def test_contours_are_built_from_curves():
    contours = two_contours()
    again = Contours.from_curves(list(contours), contours.closed, contours.image_size)
    for name in ("points", "offsets", "closed"):
        np.testing.assert_array_equal(getattr(again, name), getattr(contours, name))
    assert len(Contours.from_curves([])) == 0
    with pytest.raises(InputError, match=r"curves\[1\]: expected a numeric array of shape"):
        Contours.from_curves([[(0, 0)], [1, 2, 3]])


def test_long_arrays_are_shown_by_their_shape():
    contours = Contours.from_curves([np.zeros((700, 2)), np.ones((2, 2))], image_size=(9, 8))
    text = repr(contours)
    assert "points=<float64 (702, 2)>" in text
    assert "offsets=array([  0, 700, 702])" in text and "image_size=(9, 8)" in text
