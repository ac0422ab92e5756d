"""The nodes give what the core gives, and survive what they cannot use."""

import math

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geoprim_msgs.msg import Contours, Detections, EllipseDetections, Polygons
from rcl_interfaces.msg import Log
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import CameraInfo, Image

from geoprim_core.applications.sorting import classify
from geoprim_core.ecc import DetectorParams, detect_ellipses, find_polygons
from geoprim_core.edges import extract_contours
from geoprim_core.io.definitions import serialize
from geoprim_core.io.image_message import image_from_message, image_record
from geoprim_core.io.wire import from_wire, to_wire
from geoprim_core.synthetic import thesis_image
from geoprim_ros.conversions import to_message
from geoprim_ros.nodes.detector_node import DetectorNode
from geoprim_ros.nodes.edges_node import EdgesNode
from geoprim_ros.nodes.ellipses_node import EllipsesNode
from geoprim_ros.nodes.overlay_node import OverlayNode
from geoprim_ros.nodes.polygons_node import PolygonsNode

RESULTS = {
    "contours": Contours,
    "polygons": Polygons,
    "ellipses": EllipseDetections,
    "detections": Detections,
}


def test_three_stage_process_finds_the_disc(graph, feed, disc_message, disc):
    process = graph.start("geoprim_ros.nodes.pipeline")
    feed.wait(*RESULTS)
    sent = disc_message(1_000_000_007)
    found = feed.send(sent, "ellipses")
    assert found.header == sent.header
    assert (found.image_width, found.image_height) == (320, 240)
    ellipse = found.detections[0].ellipse
    assert math.dist((ellipse.x, ellipse.y), disc["centre"]) < 0.5
    assert abs(ellipse.semi_major - disc["radius"]) < 0.5
    graph.spin_until(lambda: feed.got["detections"])
    assert feed.got["detections"][0].detections[0].label == "ellipse"
    assert process.poll() is None


def _bytes_from_core(message):
    """Return topic -> serialised message as the core alone makes it, NaN and all."""
    params = DetectorParams()
    image = image_from_message(message)
    contours = extract_contours(image, params.edges)
    polygons = find_polygons(contours, params)
    found = detect_ellipses(image, params)
    stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
    frame = message.header.frame_id
    records = {
        "contours": to_wire(contours, stamp, frame),
        "polygons": to_wire(
            polygons, stamp, frame, contours=contours, method=params.polygon_method
        ),
        "ellipses": to_wire(found, stamp, frame),
        "detections": to_wire(classify(found), stamp, frame),
    }
    return {topic: serialize(record) for topic, record in records.items()}


def _assert_same(came, expected, where):
    """Compare two messages field by field; NaN equals NaN."""
    if hasattr(expected, "get_fields_and_field_types"):
        for name in expected.get_fields_and_field_types():
            _assert_same(getattr(came, name), getattr(expected, name), f"{where}.{name}")
    elif isinstance(expected, list):
        assert len(came) == len(expected), where
        for i, pair in enumerate(zip(came, expected, strict=True)):
            _assert_same(*pair, f"{where}[{i}]")
    else:
        np.testing.assert_array_equal(came, expected, err_msg=where)


def _noisy(disc_message, stamp_ns):
    message = disc_message(stamp_ns)
    noise = np.random.default_rng(stamp_ns % 97).integers(0, 25, len(message.data))
    data = np.frombuffer(message.data, np.uint8) // 2 + noise.astype(np.uint8)
    message.data = data.tobytes()
    return message


@pytest.mark.parametrize("kinds", [(EdgesNode, PolygonsNode, EllipsesNode), (DetectorNode,)])
def test_composed_and_single_node_give_what_the_core_gives(graph, feed, disc_message, kinds):
    for kind in kinds:
        graph.add(kind(context=graph.context))
    feed.wait(*RESULTS)
    for i in range(3):
        message = _noisy(disc_message, 10**18 + i)
        feed.send(message)
        graph.spin_until(lambda n=i + 1: all(len(g) == n for g in feed.got.values()))
        for topic, wanted in _bytes_from_core(message).items():
            expected = deserialize_message(wanted, RESULTS[topic])
            _assert_same(feed.got[topic][-1], expected, topic)


BAD = {
    "unknown encoding": {"encoding": "yuv_strange"},
    "step too small": {"step": 10},
    "data missing": {"data": b"\x00" * 100},
    "no pixels": {"height": 0, "width": 0, "step": 0, "data": b""},
}


@pytest.mark.parametrize("kind", [EdgesNode, DetectorNode])
def test_bad_frames_are_counted_and_the_node_goes_on(graph, feed, disc_message, kind):
    node = graph.add(kind(context=graph.context))
    reports = graph.collect(feed.node, DiagnosticArray, "/diagnostics")
    feed.wait("contours")
    nan = to_message(image_record(np.zeros((20, 30), np.float32), 1, "camera"))
    nan.data = np.full((20, 30), np.nan, np.float32).tobytes()
    bad = [disc_message(5, **change) for change in BAD.values()]
    for count, message in enumerate([*bad, nan], 1):
        feed.images.publish(message)
        graph.spin_until(lambda n=count: node.statistics.bad == n)
    assert "NaN" in node.statistics.last_reason
    assert feed.send(disc_message(6), "contours").header.stamp.nanosec == 6
    assert (node.statistics.frames_in, node.statistics.frames_out) == (6, 1)
    graph.spin_until(lambda: _value(reports, node, "bad") == "5")
    graph.spin_until(lambda: _value(reports, node, "frames in") == "6")
    assert "NaN" in _value(reports, node, "last reason")
    assert float(_value(reports, node, "stage time p95 [ms]")) > 0


def _value(reports, node, key):
    for report in reversed(reports):
        for status in report.status:
            if status.name.startswith(node.get_name()):
                return next((v.value for v in status.values if v.key == key), None)
    return None


def test_every_encoding_of_a_picture_gives_the_same_disc(graph, feed, disc_message, disc):
    graph.add(DetectorNode(context=graph.context))
    feed.wait("ellipses")
    gray = image_from_message(disc_message())[:, :, 0]
    stack = np.repeat(gray[:, :, None], 3, axis=2)
    for image, encoding in (
        (gray, "mono8"), (stack, "rgb8"), (gray.astype(np.uint16) * 200, "mono16"),
        (gray.astype(np.float32) / 255, "32FC1"),
    ):  # fmt: skip
        message = to_message(image_record(image, 7, "camera", encoding))
        ellipse = feed.send(message, "ellipses").detections[0].ellipse
        assert math.dist((ellipse.x, ellipse.y), disc["centre"]) < 0.5, encoding


def test_dropped_frames_are_counted(graph, feed, disc_message):
    node = graph.add(EdgesNode(context=graph.context))
    feed.wait("contours")
    feed.send(disc_message(1), "contours")
    for stamp in range(2, 6):
        feed.images.publish(disc_message(stamp))  # nobody spins: only the newest is kept
    graph.spin_until(lambda: len(feed.got["contours"]) == 2)
    assert feed.got["contours"][-1].header.stamp.nanosec == 5
    assert (node.statistics.frames_in, node.statistics.dropped) == (2, 3)


def test_a_result_cut_short_says_so_and_is_counted(graph, feed, disc_message):
    bound = [Parameter("ecc.refined.max_candidates", value=2)]
    node = graph.add(DetectorNode(context=graph.context, parameter_overrides=bound))
    reports = graph.collect(feed.node, DiagnosticArray, "/diagnostics")
    feed.wait("ellipses")
    assert feed.send(disc_message(1), "ellipses").complete
    busy = thesis_image(8, seed=3, kind="overlapping").image
    message = feed.send(to_message(image_record(busy, 2, "camera")), "ellipses")
    assert not message.complete
    assert message.reason.startswith("max_candidates = 2: ")
    assert node.statistics.cut_short == 1
    graph.spin_until(lambda: _value(reports, node, "cut short") == "1")


def test_messages_without_counterpart_are_counted_and_bounded(graph, feed):
    node = graph.add(EllipsesNode(context=graph.context))
    contours = feed.node.create_publisher(Contours, "contours", 50)
    graph.spin_until(contours.get_subscription_count)
    graph.spin_for(0.2)
    for stamp in range(14):
        message = Contours(offsets=[0], image_width=20, image_height=10)
        message.header.stamp.nanosec = stamp
        contours.publish(message)
        graph.spin_until(lambda n=stamp: node.statistics.frames_in == n + 1)
    assert node.statistics.unpaired == 4
    polygons = feed.node.create_publisher(Polygons, "polygons", 50)
    graph.spin_until(polygons.get_subscription_count)
    graph.spin_for(0.2)
    message = Polygons(offsets=[0], image_width=20, image_height=10)
    message.header.stamp.nanosec = 9
    polygons.publish(message)
    graph.spin_until(lambda: feed.got["ellipses"])
    assert feed.got["ellipses"][0].header.stamp.nanosec == 9
    assert node.statistics.bad == 0


def test_contradicting_messages_are_refused_not_fatal(graph, feed, disc_message):
    node = graph.add(PolygonsNode(context=graph.context))
    contours = feed.node.create_publisher(Contours, "contours", 50)
    graph.spin_until(contours.get_subscription_count)
    graph.spin_for(0.2)
    contours.publish(Contours(points=[1.0, 2.0, 3.0], offsets=[0, 7], closed=[0]))
    graph.spin_until(lambda: node.statistics.bad == 1)
    assert "points" in node.statistics.last_reason
    contours.publish(Contours(offsets=[0]))
    graph.spin_until(lambda: feed.got["polygons"])


def test_sizes_are_metric_where_camera_and_plane_are_known(graph, feed, disc_message, disc):
    node = graph.add(DetectorNode(context=graph.context))
    feed.wait("detections")
    graph.spin_until(feed.infos.get_subscription_count)
    assert math.isnan(feed.send(disc_message(1)).detections[0].length)

    info = CameraInfo(k=[600.0, 0.0, 160.0, 0.0, 600.0, 120.0, 0.0, 0.0, 1.0])
    info.header.stamp.nanosec = 2
    feed.infos.publish(info)
    graph.spin_for(0.1)
    values = {"labels": ["lid"], "plane_distance": 0.3}
    assert all(r.successful for r in node.set_parameters(_named(values)))
    assert all(r.successful for r in node.set_parameters(_named({"lid.unit": "mm"})))
    lid = feed.send(disc_message(2)).detections[0]
    expected = 2 * disc["radius"] * 0.3 / 600
    assert lid.label == "lid"
    assert lid.length == pytest.approx(expected, rel=0.01)
    assert lid.width == pytest.approx(expected, rel=0.01)

    # Without the plane, a class in mm cannot be told: the ellipses still come, with the reason.
    assert all(r.successful for r in node.set_parameters(_named({"plane_distance": 0.0})))
    assert feed.send(disc_message(3)).detections == []
    assert len(feed.got["ellipses"]) == 3
    assert "plane_distance" in node.statistics.last_reason


def _named(values):
    return [Parameter(name, value=value) for name, value in values.items()]


def test_overlay_draws_only_while_somebody_looks(graph, feed, disc_message, disc):
    graph.add(DetectorNode(context=graph.context))
    overlay = graph.add(OverlayNode(context=graph.context))
    feed.wait("detections", "overlay")
    feed.send(disc_message(1))
    graph.spin_for(0.2)
    assert feed.images.get_subscription_count() == 1
    assert overlay.statistics.frames_in == 0
    pictures = graph.collect(feed.node, Image, "overlay")
    graph.spin_until(lambda: feed.images.get_subscription_count() == 2)
    graph.spin_for(0.3)
    sent = disc_message(2)
    feed.send(sent)
    graph.spin_until(lambda: pictures)
    assert pictures[0].header == sent.header
    drawn = image_from_message(pictures[0]).astype(int)
    changed = np.argwhere(np.abs(drawn - image_from_message(sent)).sum(axis=2) > 150)[:, ::-1]
    distance = np.hypot(*(changed - disc["centre"]).T)
    assert (np.abs(distance - disc["radius"]) < 3).sum() > 200  # the outline lies on the rim


def test_core_values_come_back_from_the_messages(graph, feed, disc_message):
    graph.add(DetectorNode(context=graph.context))
    feed.wait("ellipses")
    message = disc_message(3)
    found = from_wire(feed.send(message, "ellipses"))
    direct = detect_ellipses(image_from_message(message))
    np.testing.assert_array_equal(found.ellipses.array(), direct.ellipses.array())


def test_diagnostics_of_a_process_tell_everything(graph, make_feed, disc_message, told):
    graph.start("geoprim_ros.nodes.detector_node")
    feed = make_feed("ellipses")
    reports = graph.collect(feed.node, DiagnosticArray, "/diagnostics")
    warnings = graph.collect(feed.node, Log, "/rosout", depth=100)
    feed.wait("ellipses")
    for stamp in range(1, 6):
        feed.send(disc_message(stamp), "ellipses")
    change = Parameter("edges.sigma", value=1.5).to_parameter_msg()
    answer = feed.ask(
        SetParameters, "detector_node/set_parameters", SetParameters.Request(parameters=[change])
    )
    assert answer.results[0].successful
    for stamp in range(6, 26):
        feed.images.publish(disc_message(stamp, encoding="yuv_strange"))
        graph.spin_for(0.02)
    graph.spin_until(lambda: int(told(reports, "detector_node", "bad") or 0) > 10)

    def value(key):
        return told(reports, "detector_node", key)

    graph.spin_until(lambda: int(value("frames in")) + int(value("dropped")) == 25)
    assert value("state") == "active"
    assert value("frames out") == "5"
    assert int(value("bad")) == int(value("frames in")) - 5
    assert "encoding: expected one of" in value("last reason")
    for name in ("stage time", "hop latency"):
        assert 0 < float(value(f"{name} p50 [ms]")) <= float(value(f"{name} p95 [ms]"))
    assert float(value("kernel warm-up [s]")) > 0
    assert value("parameter revision") == "1"
    reasons = [m.msg for m in warnings if "yuv_strange" in m.msg]
    assert len(reasons) == 1, "a series of bad frames is one warning in five seconds"
    assert reasons[0].startswith("frame 0.0000000")


def test_a_warning_level_stands_only_while_frames_are_bad(graph, feed, disc_message):
    node = graph.add(EdgesNode(context=graph.context))
    reports = graph.collect(feed.node, DiagnosticArray, "/diagnostics")
    feed.wait("contours")

    def level():
        return [s.level for r in reports for s in r.status if s.name.startswith("edges_node")][-1:]

    graph.spin_until(lambda: level() == [DiagnosticStatus.OK])
    feed.images.publish(disc_message(1, encoding="yuv_strange"))
    graph.spin_until(lambda: level() == [DiagnosticStatus.WARN])
    graph.spin_until(lambda: level() == [DiagnosticStatus.OK])
    assert node.statistics.bad == 1
