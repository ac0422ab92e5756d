"""A stage reads only what somebody reads of it, and says so."""

import time

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geoprim_msgs.msg import Contours, EllipseDetections
from rclpy.parameter import Parameter
from sensor_msgs.msg import Image
from std_srvs.srv import SetBool

from geoprim_core.ecc import DetectorParams, find_polygons
from geoprim_core.io.explain import draw_arcs, draw_edges, draw_hypotheses, judged_hypotheses
from geoprim_core.io.image_message import image_from_message
from geoprim_ros import debug_images
from geoprim_ros.chain import trace_contours, trace_ellipses, work_once
from geoprim_ros.nodes.detector_node import DetectorNode
from geoprim_ros.nodes.edges_node import EdgesNode
from geoprim_ros.nodes.ellipses_node import EllipsesNode
from geoprim_ros.nodes.overlay_node import OverlayNode
from geoprim_ros.nodes.polygons_node import PolygonsNode

STAGES = (EdgesNode, PolygonsNode, EllipsesNode)


def _open_topics(node):
    return {s.topic_name for s in node.subscriptions}


@pytest.mark.parametrize("kind", [*STAGES, DetectorNode, OverlayNode])
def test_nobody_listens_so_nothing_is_read(graph, kind):
    node = graph.add(kind(context=graph.context))
    graph.spin_for(0.5)
    assert _open_topics(node) == set()
    assert node.state() == "idle"


def test_a_listener_at_the_end_wakes_the_chain_and_its_leaving_ends_it(
    graph, make_feed, disc_message
):
    stages = [graph.add(kind(context=graph.context)) for kind in STAGES]
    feed = make_feed()
    graph.spin_for(0.5)
    assert feed.images.get_subscription_count() == 0
    found = []
    listener = feed.node.create_subscription(EllipseDetections, "ellipses", found.append, 10)
    feed.wait("ellipses")
    assert [n.state() for n in stages] == ["active"] * 3
    feed.images.publish(disc_message(1))
    graph.spin_until(lambda: found)
    assert [n.statistics.frames_out for n in stages] == [1, 1, 1]
    feed.node.destroy_subscription(listener)
    graph.spin_until(lambda: not feed.images.get_subscription_count())
    graph.spin_until(lambda: not any(_open_topics(n) for n in stages))
    assert [n.state() for n in stages] == ["idle"] * 3


def test_a_listener_in_the_middle_wakes_only_what_is_upstream(graph, make_feed, disc_message):
    edges, polygons, ellipses = (graph.add(kind(context=graph.context)) for kind in STAGES)
    feed = make_feed("polygons")
    feed.wait("polygons")
    feed.send(disc_message(1), "polygons")
    assert (edges.state(), polygons.state(), ellipses.state()) == ("active", "active", "idle")
    assert _open_topics(ellipses) == set()


def test_from_the_first_answer_on_no_frame_is_lost(graph, make_feed, disc_message):
    """Images flow when a listener comes: discovery may cost some, the start of the chain none."""
    process = graph.start("geoprim_ros.nodes.pipeline")
    feed = make_feed()
    graph.spin_until(lambda: feed.node.count_publishers("ellipses"), 120.0)
    graph.spin_for(0.5)
    assert feed.images.get_subscription_count() == 0
    found = feed.collect("ellipses")
    message, sent, end = disc_message(), 0, time.monotonic() + 60.0
    while (len(found) < 10 or found[-1].header.stamp.nanosec < sent) and time.monotonic() < end:
        if len(found) < 10:
            sent += 1
            message.header.stamp.nanosec = sent
            feed.images.publish(message)
        graph.spin_for(0.1)
    stamps = [f.header.stamp.nanosec for f in found]
    assert stamps == list(range(stamps[0], sent + 1)), (stamps, process.poll())


def test_what_went_by_while_nobody_listened_is_not_called_dropped(graph, make_feed, disc_message):
    node = graph.add(EdgesNode(context=graph.context))
    feed = make_feed("contours")
    feed.wait("contours")
    feed.send(disc_message(1), "contours")
    assert feed.ask(SetBool, "edges_node/enable", SetBool.Request(data=False)).message == "disabled"
    graph.spin_until(lambda: not feed.images.get_subscription_count())
    for stamp in range(2, 7):
        feed.images.publish(disc_message(stamp))
    graph.spin_for(0.3)
    assert node.statistics.frames_in == 1
    assert feed.ask(SetBool, "edges_node/enable", SetBool.Request(data=True)).message == "active"
    feed.wait()
    feed.send(disc_message(7), "contours")
    counts = node.statistics
    assert (counts.frames_in, counts.passed, counts.dropped) == (2, 5, 0)


@pytest.mark.parametrize(
    "name", ["edges", "polygons", "ellipses", "detector", "overlay", "markers"]
)
def test_every_stage_has_the_service_enable(graph, make_feed, told, name):
    """Disabled in its own process: no subscription, and /diagnostics says so."""
    graph.start(f"geoprim_ros.nodes.{name}_node", "--ros-args", "-p", "lazy:=false")
    feed = make_feed()
    reports = graph.collect(feed.node, DiagnosticArray, "/diagnostics")
    node = f"{name}_node"
    topics = ("image", "contours", "polygons", "ellipses", "detections", "camera_info")

    def readers():
        return sum(feed.node.count_subscribers(topic) for topic in topics)

    graph.spin_until(readers, 120.0)
    graph.spin_until(lambda: told(reports, node, "state") == "active")
    answer = feed.ask(SetBool, f"{node}/enable", SetBool.Request(data=False))
    assert (answer.success, answer.message) == (True, "disabled")
    graph.spin_until(lambda: not readers())
    graph.spin_until(lambda: told(reports, node, "state") == "disabled")
    feed.ask(SetBool, f"{node}/enable", SetBool.Request(data=True))
    graph.spin_until(readers)
    graph.spin_until(lambda: told(reports, node, "state") == "active")


def test_lazy_is_a_live_parameter(graph, make_feed, disc_message):
    node = graph.add(EdgesNode(context=graph.context))
    feed = make_feed()
    assert node.set_parameters([Parameter("lazy", value=False)])[0].successful
    feed.wait()
    feed.images.publish(disc_message(1))
    graph.spin_until(lambda: node.statistics.frames_out == 1)
    assert node.set_parameters([Parameter("lazy", value=True)])[0].successful
    graph.spin_until(lambda: not feed.images.get_subscription_count())


def test_it_opens_and_closes_again_and_again(graph, make_feed, disc_message):
    """Forty listeners that come and go leave no subscription behind, and the last is served."""
    node = graph.add(EdgesNode(context=graph.context))
    feed = make_feed()
    before = len(list(node.waitables))
    for _ in range(40):
        listener = feed.node.create_subscription(Contours, "contours", lambda m: None, 1)
        graph.spin_until(lambda: _open_topics(node) == {"/image"})
        feed.node.destroy_subscription(listener)
        graph.spin_until(lambda: not _open_topics(node))
    assert len(list(node.waitables)) == before
    got = feed.collect("contours")
    feed.wait()
    feed.images.publish(disc_message(1))
    graph.spin_until(lambda: got)


def _traces(message):
    params, image = DetectorParams(), image_from_message(message)
    edges = trace_contours(image, params)
    polygons = find_polygons(edges.contours, params)
    return image, edges, trace_ellipses(edges.contours, polygons, params)


def test_debug_topics_show_the_steps(graph, make_feed, disc_message):
    graph.add(DetectorNode(context=graph.context))
    feed = make_feed()
    names = ("edges", "arcs", "hypotheses")
    got = {n: graph.collect(feed.node, Image, f"debug/{n}") for n in names}
    feed.wait(*(f"debug/{n}" for n in names))
    sent = disc_message(5)
    feed.images.publish(sent)
    graph.spin_until(lambda: all(got.values()))
    image, edges, trace = _traces(sent)
    expected = {
        "edges": draw_edges(edges.edges),
        "arcs": draw_arcs(image, trace),
        "hypotheses": draw_hypotheses(image, judged_hypotheses(trace)),
    }
    for name, pictures in got.items():
        assert pictures[0].header == sent.header
        assert (image_from_message(pictures[0]) == expected[name]).all(), name
        assert expected[name].any()


@pytest.mark.parametrize("scheme", ["refined", "3"])
def test_the_ellipses_node_draws_its_steps_on_black(graph, make_feed, disc_message, scheme):
    work_once(DetectorParams.from_dict({"ecc.scheme": scheme}))  # its kernels may be new
    nodes = [graph.add(kind(context=graph.context)) for kind in STAGES]
    assert nodes[2].set_parameters([Parameter("ecc.scheme", value=scheme)])[0].successful
    feed = make_feed("ellipses")
    arcs = graph.collect(feed.node, Image, "debug/arcs")
    feed.wait("debug/arcs")
    found = feed.send(disc_message(5), "ellipses")
    graph.spin_until(lambda: arcs)
    assert len(found.detections) == 1
    assert (arcs[0].width, arcs[0].height) == (320, 240)
    assert image_from_message(arcs[0]).any()


def test_steps_are_not_kept_while_nobody_looks(graph, feed, disc_message, monkeypatch):
    """Without a listener the nodes run the plain functions, which keep no step."""

    def never(*args):
        raise AssertionError("a trace was made for nobody")

    monkeypatch.setattr(debug_images, "trace_contours", never)
    monkeypatch.setattr(debug_images, "trace_ellipses", never)
    node = graph.add(DetectorNode(context=graph.context))
    feed.wait("detections")
    feed.send(disc_message(1))
    assert node.statistics.bad == 0


def test_messages_that_nobody_reads_are_not_made(graph, make_feed, disc_message, monkeypatch):
    node = graph.add(DetectorNode(context=graph.context))
    feed = make_feed("contours")
    feed.wait("contours")
    monkeypatch.setattr(node._results, "publish", None)  # calling it would be a bad frame
    feed.send(disc_message(1), "contours")
    assert (node.statistics.bad, node.statistics.frames_out) == (0, 1)
