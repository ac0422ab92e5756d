"""Markers: ellipses on the plane where the camera sees them, or nothing and the reason."""

import math

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.parameter import Parameter
from visualization_msgs.msg import ImageMarker, Marker, MarkerArray

from geoprim_core.io.camera_message import camera_record
from geoprim_core.types import Camera
from geoprim_ros.conversions import to_message
from geoprim_ros.nodes.detector_node import DetectorNode
from geoprim_ros.nodes.markers_node import MarkersNode

CAMERA = Camera(fx=400.0, fy=400.0, cx=160.0, cy=120.0, distance=0.5)


def info(stamp_ns):
    return to_message(camera_record(CAMERA, (320, 240), stamp_ns, "camera"))


@pytest.fixture
def watched(graph, feed):
    """A detector, the marker node, and what comes out of it."""
    graph.add(DetectorNode(context=graph.context))
    node = graph.add(MarkersNode(context=graph.context))
    got = graph.collect(feed.node, MarkerArray, "markers")
    feed.wait("detections", "markers")
    graph.spin_until(lambda: feed.infos.get_subscription_count() == 2)
    graph.spin_until(lambda: feed.node.count_subscribers("ellipses") == 2)
    graph.spin_for(0.3)
    return node, got


def test_the_disc_lies_on_the_plane_where_the_camera_sees_it(
    graph, feed, watched, disc_message, disc
):
    node, got = watched
    assert node.set_parameters([Parameter("plane_distance", value=0.5)])[0].successful
    feed.infos.publish(info(1))
    sent = disc_message(1)
    feed.send(sent)
    graph.spin_until(lambda: got)
    first, line, text = got[0].markers
    assert first.action == Marker.DELETEALL
    assert line.header == sent.header
    assert (line.type, line.ns, line.id) == (Marker.LINE_STRIP, "ellipses", 0)
    assert (text.type, text.ns, text.id) == (Marker.TEXT_VIEW_FACING, "texts", 0)
    assert text.text.startswith("#0 ellipse 0.9") or text.text == "#0 ellipse 1.00"
    assert line.lifetime.sec == 1
    assert line.pose.orientation.w == 1.0
    points = np.array([(p.x, p.y, p.z) for p in line.points])
    assert points[0].tolist() == points[-1].tolist()  # closed
    assert (points[:, 2] == 0.5).all()
    centre = (np.array(disc["centre"]) - (CAMERA.cx, CAMERA.cy)) / CAMERA.fx * 0.5
    radius = disc["radius"] / CAMERA.fx * 0.5
    np.testing.assert_allclose(np.hypot(*(points[:, :2] - centre).T), radius, atol=0.001)


def test_without_a_plane_or_a_camera_nothing_goes_out_and_diagnostics_say_why(
    graph, feed, watched, disc_message, told
):
    node, got = watched
    reports = graph.collect(feed.node, DiagnosticArray, "/diagnostics")

    def reason():
        return told(reports, "markers_node", "last reason") or ""

    feed.send(disc_message(1))
    graph.spin_until(lambda: "plane_distance" in reason())
    node.set_parameters([Parameter("plane_distance", value=0.5)])
    for stamp in range(2, 15):  # camera_info never comes
        feed.send(disc_message(stamp))
    graph.spin_until(lambda: "no camera_info" in reason())
    assert got == []
    node.set_parameters([Parameter("camera_info_sync", value="latest")])
    feed.infos.publish(info(20))
    graph.spin_for(0.3)
    feed.send(disc_message(21))
    graph.spin_until(lambda: got)


def test_an_empty_frame_takes_the_old_markers_away(graph, feed, watched, disc_message):
    node, got = watched
    node.set_parameters([Parameter("plane_distance", value=0.5)])
    blank = disc_message(2)
    blank.data = bytes(len(blank.data))
    for stamp, message in ((1, disc_message(1)), (2, blank)):
        feed.infos.publish(info(stamp))
        feed.send(message)
    graph.spin_until(lambda: len(got) == 2)
    assert [len(array.markers) for array in got] == [3, 1]
    assert got[1].markers[0].action == Marker.DELETEALL


def test_image_markers_need_no_camera_and_start_at_the_corner(graph, feed, disc_message, disc):
    graph.add(DetectorNode(context=graph.context))
    graph.add(MarkersNode(context=graph.context))
    got = graph.collect(feed.node, ImageMarker, "image_markers")
    feed.wait("detections", "image_markers")
    graph.spin_until(lambda: feed.node.count_subscribers("ellipses") == 2)
    graph.spin_for(0.3)
    feed.send(disc_message(1))
    graph.spin_until(lambda: got)
    marker = got[0]
    points = np.array([(p.x, p.y) for p in marker.points])
    assert marker.type == ImageMarker.LINE_LIST
    assert len(marker.outline_colors) * 2 == len(points)
    np.testing.assert_allclose(points.mean(axis=0), np.array(disc["centre"]) + 0.5, atol=0.1)
    distance = math.dist(points[0], np.array(disc["centre"]) + 0.5)
    assert abs(distance - disc["radius"]) < 0.5
