"""Images in every encoding, raw and compressed, and the camera_info that belongs to them."""

import math

import cv2
import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from sensor_msgs.msg import CameraInfo, CompressedImage

from geoprim_core.ecc import detect_ellipses
from geoprim_core.io.image_message import ENCODINGS, image_from_message, image_record
from geoprim_core.synthetic import disc_image
from geoprim_ros.conversions import to_message
from geoprim_ros.image_input import compressed_topic
from geoprim_ros.nodes.detector_node import DetectorNode
from geoprim_ros.nodes.edges_node import EdgesNode

CENTRE, RADIUS = (161.3, 118.7), 60.0


def _picture(encoding):
    gray = disc_image(320, 240, centre=CENTRE, radius=RADIUS)
    channels = {"rgba": 4, "bgra": 4, "rgb": 3, "bgr": 3, "8UC3": 3, "16UC3": 3}
    channels = channels.get(encoding if "UC" in encoding else encoding.rstrip("816"), 1)
    if "yuv" in encoding or "uy" in encoding:
        pair = [gray, np.full_like(gray, 128)]
        return np.dstack(pair if "yuy" in encoding else pair[::-1])
    if "16" in encoding:
        gray = gray.astype(np.uint16) * 200
    elif encoding == "32FC1":
        gray = gray.astype(np.float32) / 255
    elif encoding == "64FC1":
        gray = gray.astype(np.float64) / 255
    return gray if channels == 1 else np.repeat(gray[:, :, None], channels, axis=2)


@pytest.fixture
def detector(graph):
    return graph.add(DetectorNode(context=graph.context))


def test_every_encoding_gives_the_same_disc_with_padding_and_either_byte_order(detector, make_feed):
    feed = make_feed("ellipses")
    feed.wait("ellipses")
    for i, encoding in enumerate(ENCODINGS):
        message = to_message(image_record(_picture(encoding), 7, "camera", encoding))
        if i % 2:  # every second one as another camera sends it
            _swap(message)
        _pad(message, 6)
        found = feed.send(message, "ellipses")
        assert len(found.detections) == 1, encoding
        ellipse = found.detections[0].ellipse
        assert math.dist((ellipse.x, ellipse.y), CENTRE) < 0.5, encoding
        assert abs(ellipse.semi_major - RADIUS) < 0.5, encoding
    assert detector.statistics.bad == 0


def _swap(message):
    size = {"16": 2, "6UC1": 2, "6UC3": 2, "2FC1": 4, "4FC1": 8}
    width = next((n for end, n in size.items() if message.encoding.endswith(end)), 1)
    data = np.frombuffer(message.data, f"<u{width}").byteswap()
    message.is_bigendian, message.data = 1, data.tobytes()


def _pad(message, bytes_a_row):
    rows = np.frombuffer(message.data, np.uint8).reshape(message.height, message.step)
    message.data = np.pad(rows, ((0, 0), (0, bytes_a_row)), constant_values=99).tobytes()
    message.step += bytes_a_row


@pytest.mark.parametrize("suffix", ["png", "jpg"])
def test_compressed_images_are_read_and_the_transport_changes_live(
    detector, make_feed, disc_message, suffix
):
    feed = make_feed("ellipses")
    compressed = feed.node.create_publisher(
        CompressedImage, "image/compressed", QoSProfile(depth=5)
    )
    feed.wait("ellipses")
    assert compressed.get_subscription_count() == 0
    raw = disc_message(1)
    feed.send(raw, "ellipses")

    (change,) = detector.set_parameters([Parameter("image_transport", value="compressed")])
    assert change.successful
    feed.graph.spin_until(compressed.get_subscription_count)
    feed.graph.spin_until(lambda: not feed.images.get_subscription_count())
    feed.graph.spin_for(0.2)
    data = cv2.imencode(f".{suffix}", image_from_message(raw))[1]
    message = CompressedImage(format=f"bgr8; {suffix} compressed bgr8", data=data.tobytes())
    message.header.stamp.nanosec = 9
    compressed.publish(message)
    feed.graph.spin_until(lambda: len(feed.got["ellipses"]) == 2)
    found = feed.got["ellipses"][-1]
    assert found.header.stamp.nanosec == 9
    direct = detect_ellipses(cv2.imdecode(data, cv2.IMREAD_UNCHANGED))
    assert [d.ellipse.x for d in found.detections] == direct.ellipses.x.tolist()

    compressed.publish(CompressedImage(format="jpeg", data=b"\xff\xd8 this is no picture"))
    feed.graph.spin_until(lambda: detector.statistics.bad == 1)
    assert "JPEG, PNG" in detector.statistics.last_reason
    assert detector.statistics.dropped == 0

    assert detector.set_parameters([Parameter("image_transport", value="raw")])[0].successful
    feed.wait()
    feed.send(disc_message(10), "ellipses")
    (refused,) = detector.set_parameters([Parameter("image_transport", value="theora")])
    assert not refused.successful
    assert refused.reason == "image_transport: expected one of raw, compressed, got 'theora' (str)"


@pytest.mark.parametrize(
    ("rules", "topic"),
    [
        ([], "/image/compressed"),
        (["image:=/camera/image_raw"], "/camera/image_raw/compressed"),
        (["image/compressed:=/small"], "/small"),
        (["image:=/camera/image_raw", "image/compressed:=/small"], "/small"),
        (["__ns:=/left"], "/left/image/compressed"),
    ],
)
def test_the_compressed_topic_follows_the_image(graph, rules, topic):
    words = ["--ros-args", *(w for rule in rules for w in ("-r", rule))]
    words += ["-p", "image_transport:=compressed", "-p", "lazy:=false"]
    node = graph.add(EdgesNode(context=graph.context, cli_args=words))
    assert node.resolve_topic_name(compressed_topic(node)) == topic
    assert {s.topic_name for s in node.subscriptions} == {topic}


def _info(stamp, focal):
    info = CameraInfo(k=[focal, 0.0, 160.0, 0.0, focal, 120.0, 0.0, 0.0, 1.0])
    info.header.stamp.nanosec = stamp
    return info


def _length(focal):
    return pytest.approx(2 * RADIUS * 0.3 / focal, rel=0.01)


@pytest.fixture
def metric(graph, detector, make_feed):
    """A feed of a detector that knows the plane."""
    (done,) = detector.set_parameters([Parameter("plane_distance", value=0.3)])
    assert done.successful
    feed = make_feed("detections", "ellipses")
    feed.wait("detections")
    graph.spin_until(feed.infos.get_subscription_count)
    return feed


def test_a_frame_takes_the_camera_info_with_its_stamp(graph, metric, disc_message):
    """A zoom lens: every frame has its own focal length, and they come in any order."""
    for stamp, focal in ((2, 600.0), (1, 300.0), (3, 450.0)):
        metric.infos.publish(_info(stamp, focal))
    graph.spin_for(0.2)
    for stamp, focal in ((1, 300.0), (2, 600.0), (3, 450.0)):
        assert metric.send(disc_message(stamp)).detections[0].length == _length(focal)


def test_a_frame_waits_for_the_camera_info_that_comes_after_it(graph, metric, disc_message):
    metric.infos.publish(_info(1, 300.0))
    graph.spin_for(0.1)
    metric.send(disc_message(2), "ellipses")
    graph.spin_for(0.2)
    assert metric.got["detections"] == []
    metric.infos.publish(_info(2, 600.0))
    graph.spin_until(lambda: metric.got["detections"])
    assert metric.got["detections"][0].header.stamp.nanosec == 2
    assert metric.got["detections"][0].detections[0].length == _length(600.0)


def test_frames_whose_camera_info_never_comes_are_counted(
    graph, detector, metric, disc_message, told
):
    reports = graph.collect(metric.node, DiagnosticArray, "/diagnostics")
    metric.infos.publish(_info(99, 600.0))
    graph.spin_for(0.1)
    for stamp in range(1, 13):
        metric.send(disc_message(stamp), "ellipses")
    graph.spin_until(lambda: len(metric.got["detections"]) == 2)  # ten wait, no more
    assert detector.statistics.without_camera == 2
    assert [m.header.stamp.nanosec for m in metric.got["detections"]] == [1, 2]
    assert math.isnan(metric.got["detections"][0].detections[0].length)
    graph.spin_until(lambda: told(reports, "detector_node", "without camera_info") == "2")


def test_a_class_in_mm_says_why_it_cannot_be_told_and_what_helps(
    graph, detector, metric, disc_message
):
    changes = [Parameter("ellipse.unit", value="mm")]
    assert detector.set_parameters(changes)[0].successful
    metric.infos.publish(_info(99, 600.0))
    graph.spin_for(0.1)
    for stamp in range(1, 12):
        metric.send(disc_message(stamp), "ellipses")
    graph.spin_until(lambda: metric.got["detections"])
    assert metric.got["detections"][0].detections == []
    reason = detector.statistics.last_reason
    assert "no camera_info with the stamp of the image" in reason
    assert "camera_info_sync: latest" in reason

    changes = [Parameter("camera_info_sync", value="latest")]
    assert detector.set_parameters(changes)[0].successful
    assert metric.send(disc_message(20)).detections[0].length == _length(600.0)


def test_nobody_waits_for_a_camera_that_is_not_there(graph, make_feed, detector, disc_message):
    feed = make_feed("detections")
    feed.node.destroy_publisher(feed.infos)
    (done,) = detector.set_parameters([Parameter("plane_distance", value=0.3)])
    assert done.successful
    feed.wait("detections")
    graph.spin_until(lambda: not detector.count_publishers("camera_info"))
    assert math.isnan(feed.send(disc_message(1)).detections[0].length)
    assert detector.statistics.without_camera == 1
