"""Frames between stages: whole ones are dropped, the newest is served, none is lost uncounted."""

import pytest
from geoprim_msgs.msg import Contours, EllipseDetections, Polygons
from rclpy.parameter import Parameter

from geoprim_ros.nodes.ellipses_node import EllipsesNode
from geoprim_ros.nodes.polygons_node import PolygonsNode


class Source:
    """Publishes empty contours and polygons, and collects what comes of them."""

    def __init__(self, graph, kind, topic):
        self.graph = graph
        self.node = graph.node("source")
        self.publishers = [
            self.node.create_publisher(kind, name, 50)
            for kind, name in ((Polygons, "polygons"), (Contours, "contours"))
        ]
        self.stamps = []
        self.node.create_subscription(
            kind, topic, lambda m: self.stamps.append(m.header.stamp.nanosec), 50
        )

    def wait(self, readers):
        counts = lambda: [p.get_subscription_count() for p in self.publishers]  # noqa: E731
        self.graph.spin_until(lambda: counts() == readers)
        self.graph.spin_for(0.3)

    def send(self, stamps):
        for stamp in stamps:
            for publisher in self.publishers:
                message = publisher.msg_type(offsets=[0], image_width=20, image_height=10)
                message.header.stamp.nanosec = stamp
                publisher.publish(message)


@pytest.fixture
def stage(graph):
    """The stage of ellipses and a source of what it reads."""
    node = graph.add(EllipsesNode(context=graph.context))
    source = Source(graph, EllipseDetections, "ellipses")
    source.wait([1, 1])
    return node, source


@pytest.mark.parametrize(
    ("most", "served"),
    [
        (2, [1, 11, 12, 23, 39]),  # the last of the two longer bursts
        (1, [1, 12, 23, 39]),
        (8, [1, 11, 12, 21, 22, 23, 39]),
        (0, [1, 11, 12, 21, 22, 23, *range(31, 40)]),
    ],
)
def test_of_what_came_while_it_worked_the_newest_is_served(graph, stage, most, served):
    """Bursts of one, two, three and nine frames, each sent while nobody spins."""
    node, source = stage
    assert node.set_parameters([Parameter("max_waiting", value=most)])[0].successful
    sent = 0
    for start, count in ((1, 1), (11, 2), (21, 3), (31, 9)):
        source.send(range(start, start + count))
        sent += count
        last = start + count - 1
        graph.spin_until(lambda n=last: source.stamps and source.stamps[-1] == n)
    graph.spin_for(0.2)
    assert source.stamps == served
    counts = node.statistics
    assert (counts.frames_in, counts.frames_out) == (len(served), len(served))
    assert (counts.dropped, counts.unpaired) == (sent - len(served), 0)


def test_a_frame_is_dropped_whole(graph, stage):
    """More than the queues hold: what is lost in them and what is left out are counted alike."""
    node, source = stage
    source.send([1])
    graph.spin_until(lambda: source.stamps == [1])
    source.send(range(2, 32))
    graph.spin_until(lambda: source.stamps[-1] == 31)
    graph.spin_for(0.2)
    counts = node.statistics
    assert source.stamps == [1, 31]
    assert (counts.frames_in, counts.dropped, counts.unpaired, counts.bad) == (2, 29, 0, 0)


def test_a_frame_that_cannot_be_used_does_not_hold_up_the_next(graph):
    node = graph.add(PolygonsNode(context=graph.context))
    sender = graph.node("sender")
    got = graph.collect(sender, Polygons, "polygons")
    contours = sender.create_publisher(Contours, "contours", 10)
    graph.spin_until(contours.get_subscription_count)
    graph.spin_for(0.3)
    for stamp, offsets in ((1, [0, 5]), (2, [0])):  # contours of points that are not there
        message = Contours(offsets=offsets, image_width=20, image_height=10)
        message.header.stamp.nanosec = stamp
        contours.publish(message)
    graph.spin_until(lambda: got)
    assert [m.header.stamp.nanosec for m in got] == [2]
    counts = node.statistics
    assert (counts.frames_in, counts.frames_out, counts.bad) == (2, 1, 1)


def test_what_waits_is_forgotten_when_nobody_listens(graph, stage):
    node, source = stage
    work = node._frames._work

    def leave_then_work(frame):  # the listener goes while two more frames wait
        node.enabled = False
        node.refresh()
        work(frame)

    node._frames._work = leave_then_work
    source.send([1, 2])
    graph.spin_until(lambda: source.stamps)
    graph.spin_for(0.3)
    assert source.stamps == [1]
    assert (node.statistics.frames_out, node.statistics.dropped) == (1, 0)
