"""Any stages in one process, in namespaces, remapped; and the detector as a managed node."""

import doctest

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geoprim_msgs.msg import Contours, EllipseDetections
from lifecycle_msgs.msg import State, Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from sensor_msgs.msg import Image

from geoprim_ros import cameras, param_dump
from geoprim_ros.nodes import pipeline
from geoprim_ros.nodes.lifecycle_detector import LifecycleDetector


def _nodes(feed):
    pairs = feed.node.get_node_names_and_namespaces()
    return {f"{space.rstrip('/')}/{name}" for name, space in pairs} - {"/feed"}


@pytest.mark.parametrize(
    ("stages", "names"),
    [
        (["edges"], {"/edges_node"}),
        (["ellipses", "edges"], {"/edges_node", "/ellipses_node"}),
        (
            ["edges:left", "edges:right", "overlay"],
            {"/left/edges_node", "/right/edges_node", "/overlay_node"},
        ),
    ],
)
def test_any_subset_runs_in_any_namespaces(graph, make_feed, stages, names):
    feed = make_feed()
    graph.start("geoprim_ros.nodes.pipeline", "--stages", *stages)
    graph.spin_until(lambda: _nodes(feed) == names, 90.0)


def test_two_cameras_have_a_chain_each(graph, make_feed, disc_message):
    """Same stages twice; every chain hears its own camera only."""
    stages = ("edges", "polygons", "ellipses")
    words = [f"{stage}:{side}" for side in ("left", "right") for stage in stages]
    graph.start("geoprim_ros.nodes.pipeline", "--stages", *words)
    feed = make_feed()
    sides = {}
    for side in ("left", "right"):
        sent = feed.node.create_publisher(Image, f"{side}/image", QoSProfile(depth=5))
        sides[side] = sent, graph.collect(feed.node, EllipseDetections, f"{side}/ellipses")
    graph.spin_until(lambda: all(p.get_subscription_count() for p, _ in sides.values()), 120.0)
    graph.spin_for(0.5)
    for stamp, (sent, got) in enumerate(sides.values(), 1):
        sent.publish(disc_message(stamp))
        graph.spin_until(lambda g=got: g)
    assert [[m.header.stamp.nanosec for m in got] for _, got in sides.values()] == [[1], [2]]


def test_a_namespace_of_the_process_is_put_around(graph, make_feed):
    feed = make_feed()
    words = ["--stages", "edges:left", "polygons:/own", "ellipses"]
    graph.start("geoprim_ros.nodes.pipeline", *words, "--ros-args", "-r", "__ns:=/cell")
    wanted = {"/cell/left/edges_node", "/own/polygons_node", "/cell/ellipses_node"}
    graph.spin_until(lambda: _nodes(feed) == wanted, 90.0)


def test_remaps_of_one_node_of_the_process(graph, make_feed, disc_message):
    """`-r NODE:FROM:=TO` moves the topic of that node only."""
    words = ["--stages", "edges", "overlay", "--ros-args", "-p", "lazy:=false"]
    words += ["-r", "edges_node:image:=camera/image_raw", "-r", "edges_node:contours:=outlines"]
    graph.start("geoprim_ros.nodes.pipeline", *words)
    feed = make_feed()
    camera = feed.node.create_publisher(Image, "camera/image_raw", QoSProfile(depth=5))
    got = graph.collect(feed.node, Contours, "outlines")
    graph.spin_until(lambda: camera.get_subscription_count() == 1, 90.0)
    graph.spin_until(lambda: feed.images.get_subscription_count() == 1)  # the overlay's
    graph.spin_for(0.5)
    camera.publish(disc_message(4))
    graph.spin_until(lambda: got)
    assert got[0].header.stamp.nanosec == 4


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["edges", "edges"], "edges twice in one namespace"),
        (["eges"], "expected one of edges, polygons"),
        (["edges:9th"], "'9th' cannot be a namespace"),
        (["edges:left/"], "'left/' cannot be a namespace"),
    ],
)
def test_stages_that_cannot_run_are_told(words, said, capsys):
    with pytest.raises(SystemExit) as end:
        pipeline.main(["--stages", *words])
    assert end.value.code == 2
    assert said in capsys.readouterr().err


def _change(feed, name, transition):
    request = ChangeState.Request(transition=Transition(id=transition))
    return feed.ask(ChangeState, f"{name}/change_state", request).success


def _state(feed, name):
    return feed.ask(GetState, f"{name}/get_state", GetState.Request()).current_state.id


def test_the_managed_detector_goes_through_its_states(graph, make_feed, disc_message, told):
    """In a process of its own, twice round: topics while configured, work while active."""
    name = "lifecycle_detector"
    process = graph.start(f"geoprim_ros.nodes.{name}")
    feed = make_feed("ellipses")
    reports = graph.collect(feed.node, DiagnosticArray, "/diagnostics")

    def readers():
        return feed.images.get_subscription_count()

    for turn in range(2):
        graph.spin_until(lambda: told(reports, name, "state") == "unconfigured", 90.0)
        assert _state(feed, name) == State.PRIMARY_STATE_UNCONFIGURED
        assert not feed.node.count_publishers("ellipses")
        assert _change(feed, name, Transition.TRANSITION_CONFIGURE)
        assert _state(feed, name) == State.PRIMARY_STATE_INACTIVE
        graph.spin_until(lambda: feed.node.count_publishers("ellipses"))
        graph.spin_until(lambda: told(reports, name, "state") == "inactive")
        assert readers() == 0
        assert _change(feed, name, Transition.TRANSITION_ACTIVATE)
        graph.spin_until(readers)
        graph.spin_for(0.3)
        feed.send(disc_message(turn + 1), "ellipses")
        graph.spin_until(lambda: told(reports, name, "state") == "active")
        assert _change(feed, name, Transition.TRANSITION_DEACTIVATE)
        graph.spin_until(lambda: not readers())
        assert not _change(feed, name, Transition.TRANSITION_DEACTIVATE)  # not from inactive
        assert _change(feed, name, Transition.TRANSITION_CLEANUP)
        graph.spin_until(lambda: not feed.node.count_publishers("ellipses"))
    assert _change(feed, name, Transition.TRANSITION_UNCONFIGURED_SHUTDOWN)
    assert _state(feed, name) == State.PRIMARY_STATE_FINALIZED
    assert process.poll() is None
    assert [m.header.stamp.nanosec for m in feed.got["ellipses"]] == [1, 2]


def test_parameters_of_the_managed_detector_change_in_every_state(graph, make_feed):
    node = graph.add(LifecycleDetector(context=graph.context))
    feed = make_feed()

    def change(value):
        (result,) = node.set_parameters([Parameter("edges.sigma", value=value)])
        return result.successful and node._params.value.edges.sigma == value

    assert change(1.5)
    assert _change(feed, "lifecycle_detector", Transition.TRANSITION_CONFIGURE)
    assert change(1.75)
    assert _change(feed, "lifecycle_detector", Transition.TRANSITION_ACTIVATE)
    assert change(2.0)
    assert not change(99.0)
    assert node.revision == 3


@pytest.mark.parametrize("module", [pipeline, param_dump, cameras])
def test_examples_in_the_documentation_run(module):
    failed, tried = doctest.testmod(module)
    assert (failed, tried > 0) == (0, True)
