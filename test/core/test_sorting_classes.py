"""Sorting: which class an ellipse gets, and its size on the working plane."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.applications import ClassParams, SortingParams, classify, size_on_plane
from geoprim_core.errors import InputError, ParameterError
from geoprim_core.types import Camera, EllipseDetections, Ellipses


def detections(rows, score=1.0, coverage=1.0):
    count = len(rows)
    full = np.ones(count)
    return EllipseDetections(
        Ellipses.from_array(np.reshape(rows, (count, 5))),
        full * score,
        full * coverage,
        full,
        full,
        np.full((count, 5, 5), np.nan),
        (640, 480),
    )


def projected(points, camera):
    """Return pixels of points (X, Y) in metres on the plane: the pinhole equation."""
    return np.stack(
        [
            camera.cx + camera.fx * points[:, 0] / camera.distance,
            camera.cy + camera.fy * points[:, 1] / camera.distance,
        ],
        axis=1,
    )


def conic_ellipse(points):
    """Return x, y, a, b, angle of the ellipse through 5 or more points, from its conic."""
    x, y = points.T
    mx, my, s = x.mean(), y.mean(), np.abs(points - points.mean(axis=0)).max()
    x, y = (x - mx) / s, (y - my) / s
    matrix = np.stack([x * x, x * y, y * y, x, y, np.ones_like(x)], axis=1)
    a, b, c, d, e, f = np.linalg.svd(matrix)[2][-1]
    centre = np.linalg.solve([[2 * a, b], [b, 2 * c]], [-d, -e])
    level = -(f + (d * centre[0] + e * centre[1]) / 2)
    values, vectors = np.linalg.eigh(np.array([[a, b / 2], [b / 2, c]]) / level)
    axes = s / np.sqrt(values)  # ascending values: the major axis first
    angle = math.atan2(vectors[1, 0], vectors[0, 0]) % math.pi
    return [centre[0] * s + mx, centre[1] * s + my, axes[0], axes[1], angle]


@given(
    length=st.floats(0.01, 0.3),
    ratio=st.floats(0.2, 0.95),
    angle=st.floats(0.0, 3.1),
    fx=st.floats(300, 2000),
    stretch=st.floats(0.7, 1.4),
    distance=st.floats(0.2, 3.0),
)
@settings(max_examples=40, deadline=None)
def test_sizes_are_those_of_the_projected_object(length, ratio, angle, fx, stretch, distance):
    """An object on the plane, projected by the pinhole equation, measures what it is."""
    camera = Camera(fx, fx * stretch, 320.0, 240.0, distance)
    t = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    u, v = length / 2 * np.cos(t), length * ratio / 2 * np.sin(t)
    x = u * math.cos(angle) - v * math.sin(angle) + 0.02
    y = u * math.sin(angle) + v * math.cos(angle) - 0.01
    seen = Ellipses.from_array([conic_ellipse(projected(np.stack([x, y], axis=1), camera))])
    np.testing.assert_allclose(size_on_plane(seen, camera), [[length, length * ratio]], rtol=1e-6)


def test_the_first_class_that_fits_wins():
    sorting = SortingParams.from_dict(
        {
            "labels": ["small", "round", "any"],
            "small": {"max_length": 50.0},
            "round": {"min_axis_ratio": 0.9},
        }
    )
    found = detections([[9, 9, 20, 20, 0], [9, 9, 40, 38, 0], [9, 9, 40, 20, 0], [9, 9, 25, 9, 0]])
    assert classify(found, sorting).labels == ("small", "round", "any", "small")


@pytest.mark.parametrize(
    ("limits", "fits"),
    [
        ({"min_length": 60.0, "max_length": 60.0}, True),
        ({"min_length": 60.1}, False),
        ({"max_length": 59.9}, False),
        ({"min_width": 30.0, "max_width": 30.0}, True),
        ({"min_width": 30.1}, False),
        ({"max_width": 29.9}, False),
        ({"min_axis_ratio": 0.5, "max_axis_ratio": 0.5}, True),
        ({"min_axis_ratio": 0.51}, False),
        ({"max_axis_ratio": 0.49}, False),
        ({"min_coverage": 0.4}, True),
        ({"min_coverage": 0.41}, False),
        ({"min_score": 0.7}, True),
        ({"min_score": 0.71}, False),
    ],
)
def test_every_limit_is_one_of_full_axes_and_includes_its_value(limits, fits):
    found = detections([[50, 50, 30, 15, 1]], score=0.7, coverage=0.4)
    sorting = SortingParams({"thing": ClassParams(**limits)})
    assert classify(found, sorting).labels == (("thing",) if fits else ())


def test_millimetres_come_from_the_camera():
    camera = Camera(fx=800.0, fy=800.0, cx=320.0, cy=240.0, distance=0.4)  # 2 px a mm
    sorting = SortingParams.from_dict(
        {"labels": ["disc"], "disc": {"unit": "mm", "min_length": 23.9, "max_length": 24.1}}
    )
    found = detections([[99, 99, 24, 24, 0], [99, 99, 12, 12, 0]])
    objects = classify(found, sorting, camera)
    assert objects.labels == ("disc",)
    np.testing.assert_allclose(objects.size, [[0.024, 0.024]])


def test_a_class_in_millimetres_without_a_camera_is_refused():
    sorting = SortingParams({"disc": ClassParams(unit="mm")})
    assert sorting.needs_camera
    with pytest.raises(InputError, match=r"camera.*'disc' is in mm"):
        classify(detections([[9, 9, 5, 5, 0]]), sorting)


def test_sizes_without_a_camera_are_not_numbers():
    assert np.isnan(classify(detections([[9, 9, 5, 5, 0]])).size).all()


def test_what_fits_no_class_is_left_out_or_gets_the_other_label():
    found = detections([[9, 9, 5, 5, 0], [9, 9, 50, 50, 0]])
    small = {"coin": ClassParams(max_length=20.0)}
    assert classify(found, SortingParams(small)).labels == ("coin",)
    assert classify(found, SortingParams(small, other="reject")).labels == ("coin", "reject")
    assert classify(found).labels == ("ellipse", "ellipse")


@given(
    x=st.floats(-50, 700),
    major=st.floats(2, 300),
    ratio=st.floats(0.05, 1.0),
    angle=st.floats(0.0, 3.14),
)
@settings(max_examples=40, deadline=None)
def test_boxes_touch_the_outline_and_polygons_lie_on_it(x, major, ratio, angle):
    objects = classify(detections([[x, 70.0, major, major * ratio, angle]]))
    t = np.linspace(0, 2 * np.pi, 20_000)
    u, v = major * np.cos(t), major * ratio * np.sin(t)
    px = x + u * math.cos(angle) - v * math.sin(angle)
    py = 70 + u * math.sin(angle) + v * math.cos(angle)
    expected = [px.min(), py.min(), px.max(), py.max()]
    np.testing.assert_allclose(objects.boxes[0], expected, atol=1e-4)
    du, dv = (objects.polygons - [x, 70]).T
    along = (du * math.cos(angle) + dv * math.sin(angle)) / major
    across = (dv * math.cos(angle) - du * math.sin(angle)) / (major * ratio)
    np.testing.assert_allclose(along**2 + across**2, 1, atol=1e-3)
    assert (objects.polygons == objects.polygons.astype(np.float32)).all()


def test_order_and_scores_stay():
    found = detections([[9, 9, 5, 5, 0], [9, 9, 50, 50, 0], [9, 9, 6, 6, 0]], score=0.5)
    found = EllipseDetections(
        found.ellipses, [0.9, 0.8, 0.7], [1, 1, 1], [1, 1, 1], [1, 1, 1], found.covariance
    )
    objects = classify(found, SortingParams({"coin": ClassParams(max_length=20.0)}))
    assert objects.score.tolist() == [0.9, 0.7]
    assert objects.ellipses.semi_major.tolist() == [5, 6]


def test_nothing_found_is_nothing_sorted():
    objects = classify(EllipseDetections.empty((64, 48)))
    assert objects.labels == ()
    assert objects.image_size == (64, 48)


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ({"labels": "can"}, "labels.*list"),
        ({"labels": ["a", "a"]}, "labels.*differ"),
        ({"labels": ["two words"]}, "labels.*letters"),
        ({"labels": ["a"], "b": {"min_score": 0.1}}, r"b: .*one of the labels: a"),
        ({"labels": ["a"], "a": {"min_scores": 0.1}}, r"a.min_scores.*'min_score'"),
        ({"labels": ["a"], "a.min_score": 1.5}, r"a.min_score.*from 0.0 to 1.0"),
        ({"labels": ["a"], "a": {"unit": "m"}}, r"a.unit.*px, mm"),
        ({"labels": ["a"], "a": {"min_length": 9.0, "max_length": 8.0}}, r"a.min_length.*8.0"),
        ({"labels": ["a"], "a": 3}, "a: expected the parameters"),
        ({"other": 3}, "other.*text"),
    ],
)
def test_wrong_classes_are_refused(values, text):
    with pytest.raises(ParameterError, match=text):
        SortingParams.from_dict(values)


def test_parameters_survive_a_dictionary():
    sorting = SortingParams({"b": ClassParams(max_length=3.0), "a": ClassParams()}, other="rest")
    again = SortingParams.from_dict(sorting.to_dict())
    assert again == sorting
    assert list(again.classes) == ["b", "a"]
