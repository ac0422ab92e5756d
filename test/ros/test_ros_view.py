"""The live view: what the graph finds reaches a viewer, and costs nothing without one."""

import json

import pytest

from geoprim_core.applications import ellipse_outlines
from geoprim_core.io.wire import from_wire
from geoprim_ros.nodes.detector_node import DetectorNode
from geoprim_ros.nodes.view_node import ViewNode


@pytest.fixture
def view(graph):
    pytest.importorskip("foxglove")
    graph.add(DetectorNode(context=graph.context))
    node = graph.add(ViewNode(context=graph.context, cli_args=["--ros-args", "-p", "port:=0"]))
    yield node
    node.close()


def test_a_viewer_sees_what_the_graph_finds(
    graph, feed, view, viewer, annotations_of, disc_message
):
    feed.wait("detections")
    assert feed.images.get_subscription_count() == 1  # the detector's
    seen = viewer(view.port)
    seen.look_at("/annotations", "/ellipses", "/diagnostics", "/image")
    graph.spin_until(lambda: feed.images.get_subscription_count() == 2, what="a lazy input opens")
    graph.spin_until(lambda: feed.node.count_subscribers("detections") == 2)
    graph.spin_for(0.5)
    sent = feed.send(disc_message(5), "ellipses")
    graph.spin_until(lambda: view.statistics.frames_out == 1)
    graph.spin_for(1.2)  # diagnostics come once a second
    got = seen.see("/annotations", "/ellipses", "/diagnostics", "/image")
    found = from_wire(sent)
    (line,), (text,) = annotations_of(got["/annotations"])
    (outline,) = ellipse_outlines(found.ellipses, len(line[1]))
    assert abs(line[1] - 0.5 - outline).max() < 1e-9
    assert text == f"#0 ellipse {found.score[0]:.2f}"
    assert json.loads(got["/ellipses"])["count"] == 1
    status = json.loads(got["/diagnostics"])["status"][0]
    assert status["name"].endswith(": frames")
    seen.close()
    graph.spin_until(lambda: feed.images.get_subscription_count() == 1, what="it closes again")


@pytest.mark.parametrize(
    ("module", "words"),
    [
        ("geoprim_ros.nodes.view_node", ["--ros-args", "-p", "port:=0"]),
        ("geoprim_core.cli.main", ["view", "--port", "0", "--live"]),
        (
            "geoprim_core.cli.main",
            ["view", "--port", "0", "--live", "--ros-args", "-r", "image:=/camera"],
        ),
    ],
)
def test_it_runs_as_a_process_and_ends_with_code_0(graph, module, words):
    pytest.importorskip("foxglove")
    process = graph.start(module, *words)
    watcher = graph.node("watcher")
    graph.spin_until(lambda: "view_node" in watcher.get_node_names(), 90.0)
    process.terminate()
    assert process.wait(timeout=60) == 0, process.stderr.read()
