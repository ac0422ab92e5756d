"""Points on the working plane and the markers made of them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.applications.sorting import size_on_plane
from geoprim_core.errors import InputError
from geoprim_core.io.camera_message import camera_from_message, camera_record
from geoprim_core.io.definitions import serialize, typestore
from geoprim_core.io.marker_message import MarkerParams, image_marker, marker_array
from geoprim_core.io.plane_points import pixel_size_on_plane, points_on_plane
from geoprim_core.io.record import Record, header
from geoprim_core.io.shown import OverlayParams, Shown
from geoprim_core.types import Camera, Ellipses

CAMERA = Camera(fx=610.0, fy=600.0, cx=325.5, cy=238.25, distance=0.8)
SIZE = (640, 480)


def info(**changes):
    record = camera_record(CAMERA, SIZE, 7, "camera")
    return Record(record.type, {**record.fields, **changes})


def shown(*rows):
    return Shown(
        Ellipses.from_array(np.reshape(rows, (-1, 5))),
        np.full(len(rows), 0.9),
        tuple(range(len(rows))),
        ("",) * len(rows),
    )


def plumb_bob(rays, d):
    """Brown's lens, written out: radial k1, k2, k3, tangential p1, p2."""
    k1, k2, p1, p2, k3 = d
    x, y = rays.T
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    return np.stack(
        [
            x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
        ],
        axis=1,
    )


def equidistant(rays, d):
    """The fish-eye of Kannala and Brandt: the angle itself, with a polynomial."""
    r = np.hypot(*rays.T)
    t = np.arctan(r)
    bent = t * (1 + d[0] * t**2 + d[1] * t**4 + d[2] * t**6 + d[3] * t**8)
    return rays * np.divide(bent, r, out=np.ones_like(r), where=r > 0)[:, None]


def pixels(rays):
    return rays * (CAMERA.fx, CAMERA.fy) + (CAMERA.cx, CAMERA.cy)


RAYS = np.stack(np.meshgrid(np.linspace(-0.5, 0.5, 9), np.linspace(-0.4, 0.4, 7)), -1).reshape(
    -1, 2
)


@settings(max_examples=40, deadline=None)
@given(
    st.floats(-500, 1500), st.floats(-500, 1500), st.floats(0.05, 20.0), st.sampled_from([1, 2, 4])
)
def test_the_plane_is_seen_where_it_came_from(x, y, distance, binning):
    """Projecting the point again gives the pixel, in a binned part of the sensor too."""
    part = Record(
        "sensor_msgs/msg/RegionOfInterest",
        {"x_offset": 40, "y_offset": 16, "height": 0, "width": 0, "do_rectify": False},
    )
    own = info(binning_x=binning, binning_y=binning, roi=part)
    (place,) = points_on_plane(np.array([[x, y]]), own, distance)
    camera = camera_from_message(own, distance)
    assert place[2] == distance
    assert place[0] / distance * camera.fx + camera.cx == pytest.approx(x, abs=1e-6)
    assert place[1] / distance * camera.fy + camera.cy == pytest.approx(y, abs=1e-6)


@pytest.mark.parametrize(
    ("model", "lens", "d"),
    [
        ("plumb_bob", plumb_bob, [-0.28, 0.07, 0.001, -0.0007, 0.003]),
        ("plumb_bob", plumb_bob, [0.2, 0.1, 0.0, 0.002, 0.0]),
        ("equidistant", equidistant, [-0.02, 0.003, -0.001, 0.0002]),
    ],
)
def test_distortion_is_undone(model, lens, d):
    own = info(distortion_model=model, d=np.array(d))
    places = points_on_plane(pixels(lens(RAYS, d)), own, 0.8)
    np.testing.assert_allclose(places[:, :2], 0.8 * RAYS, atol=1e-6)


def test_a_point_that_the_lens_never_shows_is_nan():
    """1 + k1 r^2 turns around at r = sqrt(1 / 0.9): no ray is seen 0.71 or more from the axis."""
    own = info(distortion_model="plumb_bob", d=np.array([-0.3, 0.0, 0.0, 0.0, 0.0]))
    seen, unseen = points_on_plane(pixels(np.array([[0.69, 0.0], [0.72, 0.0]])), own, 1.0)
    assert np.isfinite(seen).all()
    assert seen[0] < np.sqrt(1 / 0.9)
    assert np.isnan(unseen[:2]).all()


def test_a_rectified_image_uses_p_and_no_distortion():
    p = np.array([500.0, 0, 300.0, -50.0, 0, 500.0, 200.0, 0, 0, 0, 1, 0])
    own = info(distortion_model="plumb_bob", d=np.array([-0.3, 0.1, 0, 0, 0]), p=p)
    (place,) = points_on_plane(np.array([[310.0, 240.0]]), own, 2.0, rectified=True)
    u = (p.reshape(3, 4) @ [*place, 1.0])[:2] / place[2]
    np.testing.assert_allclose(u, [310.0, 240.0], atol=1e-9)


@pytest.mark.parametrize(
    ("changes", "distance", "named"),
    [
        ({}, 0.0, "plane_distance"),
        ({"k": np.zeros(9)}, 1.0, "camera_info.k"),
        ({"distortion_model": "strange", "d": np.ones(5)}, 1.0, "camera_info.distortion_model"),
        ({"distortion_model": "plumb_bob", "d": np.ones(3)}, 1.0, "camera_info.distortion_model"),
    ],
)
def test_what_cannot_be_placed_is_refused(changes, distance, named):
    with pytest.raises(InputError, match=named):
        points_on_plane(np.zeros((1, 2)), info(**changes), distance)


def test_markers_have_the_size_that_sorting_gives():
    ellipses = shown([300, 200, 60, 40, 0.4], [100, 380, 25, 25, 0.0])
    array, beyond = marker_array(ellipses, header(7, "camera"), info(), CAMERA.distance)
    lines = [m for m in array.markers if m.ns == "ellipses"]
    assert ([m.id for m in lines], beyond) == ([0, 1], 0)
    for line, (length, width) in zip(
        lines, size_on_plane(ellipses.ellipses, CAMERA).tolist(), strict=True
    ):
        points = np.array([(p.x, p.y) for p in line.points])
        (x, y), (u, v) = points[:-1].T, points[1:].T
        area = 0.5 * abs(np.sum(x * v - y * u))
        corners = len(points) - 1  # of an inscribed polygon
        share = np.sin(2 * np.pi / corners) * corners / (2 * np.pi)
        assert area == pytest.approx(np.pi / 4 * length * width * share, rel=1e-5)


def test_an_ellipse_that_the_lens_does_not_show_whole_is_left_out_and_counted():
    own = info(distortion_model="plumb_bob", d=np.array([-0.3, 0.0, 0.0, 0.0, 0.0]))
    ellipses = shown([320, 240, 50, 40, 0.0], [320, 240, 600, 40, 0.0])
    array, beyond = marker_array(ellipses, header(7, "camera"), own, 1.0)
    assert {m.id for m in array.markers if m.ns} == {0}
    assert beyond == 1


def test_the_message_can_be_written_and_read():
    """As visualization_msgs has it: every field there, in its type."""
    one = shown([300, 200, 60, 40, 0.4])
    array, _ = marker_array(
        one, header(7, "camera"), info(), 0.8, params=MarkerParams(lifetime=2.5)
    )
    read = typestore().deserialize_cdr(serialize(array), "visualization_msgs/msg/MarkerArray")
    first, line, text = read.markers
    assert (first.action, line.action) == (first.DELETEALL, line.ADD)
    assert (line.type, text.type) == (line.LINE_STRIP, line.TEXT_VIEW_FACING)
    assert (line.lifetime.sec, line.lifetime.nanosec) == (2, 500_000_000)
    assert line.scale.x == pytest.approx(2 * pixel_size_on_plane(info(), 0.8))
    assert text.text == "#0 0.90"
    marker = image_marker(one, header(7, "camera"), OverlayParams())
    read = typestore().deserialize_cdr(serialize(marker), "visualization_msgs/msg/ImageMarker")
    assert len(read.points) == 2 * len(read.outline_colors)


def test_no_ellipses_are_no_error():
    array, beyond = marker_array(shown(), header(7, "camera"), info(), 0.8)
    assert (len(array.markers), beyond) == (1, 0)
    assert image_marker(shown(), header(7, "camera")).points == []
