"""Quality of service: what does not match is told once, with the remedy; the newest is served."""

import doctest
import time

import pytest
from geoprim_msgs.msg import Contours
from rcl_interfaces.msg import Log
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from geoprim_core.errors import ParameterError
from geoprim_ros import qos
from geoprim_ros.nodes.edges_node import EdgesNode
from geoprim_ros.nodes.polygons_node import PolygonsNode
from geoprim_ros.qos import mismatches, result_qos, sensor_qos, sentence

ALWAYS = ["--ros-args", "-p", "lazy:=false"]


@pytest.fixture
def logged(graph):
    """The log texts of a stage with the word "nothing"."""
    messages = graph.collect(graph.node("listener"), Log, "/rosout", QoSProfile(depth=100))

    def read():
        return [m.msg for m in messages if m.msg.startswith("nothing")]

    return read


def test_a_publisher_that_does_not_match_is_told_once_with_the_remedy(graph, logged):
    node = graph.add(PolygonsNode(context=graph.context, cli_args=ALWAYS))
    camera = graph.node("cheap_camera", namespace="/cell")
    graph.spin_for(0.3)
    for _ in range(3):  # a driver that starts again and again
        publisher = camera.create_publisher(Contours, "/contours", sensor_qos())
        graph.spin_for(0.4)
        camera.destroy_publisher(publisher)
        graph.spin_for(0.1)
    graph.spin_until(logged)
    assert logged() == [
        "nothing comes from /cell/cheap_camera on /contours: what it offers does not fit what "
        "this node asks for: reliability best_effort against reliable; start this node with "
        "-p qos_overrides./contours.subscription.reliability:=best_effort "
        "or let /cell/cheap_camera offer reliable"
    ]
    other = graph.node("another_camera")
    other.create_publisher(Contours, "/contours", sensor_qos())
    graph.spin_until(lambda: len(logged()) == 2)
    assert "/another_camera" in logged()[1]
    graph.executor.remove_node(node)
    graph.nodes.remove(node)
    node.destroy_node()

    # and the remedy is one
    words = [*ALWAYS, "-p", "qos_overrides./contours.subscription.reliability:=best_effort"]
    graph.add(PolygonsNode(context=graph.context, cli_args=words))
    graph.spin_until(lambda: any(p.get_subscription_count() for p in other.publishers))


def test_a_reader_that_does_not_match_is_told_once_with_the_remedy(graph, logged):
    words = [*ALWAYS, "-p", "qos_overrides./contours.publisher.reliability:=best_effort"]
    graph.add(EdgesNode(context=graph.context, cli_args=words))
    late = graph.node("late_joiner")
    kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    late.create_subscription(Contours, "contours", lambda m: None, kept)
    graph.spin_until(logged)
    (text,) = logged()
    assert text.startswith("nothing goes to /late_joiner on /contours: what it asks for does not")
    assert "-p qos_overrides./contours.publisher.reliability:=reliable" in text
    assert "-p qos_overrides./contours.publisher.durability:=transient_local" in text
    assert text.endswith("or let /late_joiner ask for best_effort and volatile")


def test_policies_that_no_parameter_sets_have_a_remedy_at_the_other_end():
    hasty = QoSProfile(depth=1, deadline=Duration(seconds=0.1))
    found = mismatches(result_qos(), hasty)
    assert found == [("deadline", "none", "0.1 s")]
    text = sentence("/contours", "publisher", "/watcher", found)
    assert text.endswith("deadline 0.1 s against none; let /watcher ask for none")
    assert mismatches(hasty, result_qos()) == []


def test_an_output_can_be_kept_for_late_joiners(graph, make_feed, disc_message):
    start = "qos_overrides./contours.publisher."
    words = [*ALWAYS, "-p", f"{start}durability:=transient_local", "-p", f"{start}depth:=1"]
    node = graph.add(EdgesNode(context=graph.context, cli_args=words))
    feed = make_feed()
    feed.wait()
    for stamp in (1, 2):
        feed.images.publish(disc_message(stamp))
        graph.spin_until(lambda n=stamp: node.statistics.frames_out == n)
    got = []
    late = QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    feed.node.create_subscription(Contours, "contours", got.append, late)
    graph.spin_until(lambda: got)
    graph.spin_for(0.2)
    assert [m.header.stamp.nanosec for m in got] == [2]


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("reliability:=sometimes", "expected one of reliable, best_effort, got 'sometimes'"),
        ("depth:=-1", "depth: expected a whole number from 0"),
        ("depth:=deep", "depth: expected a whole number"),
    ],
)
def test_a_wrong_override_is_one_sentence_at_the_start(graph, value, said):
    words = ["--ros-args", "-p", f"qos_overrides./image.subscription.{value}"]
    with pytest.raises(ParameterError, match=said):
        EdgesNode(context=graph.context, cli_args=words)


def test_overrides_are_parameters_before_anybody_listens(graph):
    node = graph.add(EdgesNode(context=graph.context))
    start = "qos_overrides./image.subscription."
    values = {n: node.get_parameter(start + n).value for n in ("reliability", "depth", "history")}
    assert values == {"reliability": "best_effort", "depth": 1, "history": "keep_last"}


def test_images_are_best_effort_and_results_reliable(graph):
    node = graph.add(EdgesNode(context=graph.context, cli_args=ALWAYS))
    (image,) = node.subscriptions
    assert (image.qos_profile.reliability, image.qos_profile.depth) == (
        ReliabilityPolicy.BEST_EFFORT,
        1,
    )
    (contours,) = [p for p in node.publishers if p.topic_name == "/contours"]
    assert contours.qos_profile.reliability == ReliabilityPolicy.RELIABLE


def test_a_slow_stage_serves_the_newest_frame_and_counts_the_others(graph, feed, disc_message):
    """Sent in bursts while the stage works: of every burst the last frame is answered."""
    node = graph.add(EdgesNode(context=graph.context))
    feed.wait("contours")
    work = node._debug.find_contours

    def slow(*args):
        time.sleep(0.05)
        return work(*args)

    node._debug.find_contours = slow
    feed.send(disc_message(0), "contours")
    for burst in range(4):
        for stamp in range(5):
            feed.images.publish(disc_message(10 * burst + stamp + 1))
        graph.spin_until(lambda n=burst: len(feed.got["contours"]) > n + 1)
        graph.spin_for(0.1)
    stamps = [m.header.stamp.nanosec for m in feed.got["contours"]]
    assert stamps == [0, 5, 15, 25, 35]
    counts = node.statistics
    assert counts.frames_in + counts.dropped == 21
    assert counts.dropped == 16


def test_examples_in_the_documentation_run():
    failed, tried = doctest.testmod(qos)
    assert (failed, tried > 0) == (0, True)
