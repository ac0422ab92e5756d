"""What a user does with the running player: pause, step, seek, choose, rename, latch, wait."""

import signal
import subprocess
import sys

import pytest
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Header
from std_srvs.srv import Trigger

from geoprim_core.io.bags import BagWriter
from geoprim_core.io.definitions import serialize
from geoprim_core.io.record import header
from geoprim_ros.nodes import bag_player

PLAYER = "geoprim_ros.nodes.bag_player"
START = 1_700_000_000_000_000_000
STEP = 20_000_000
LATCHED = "- depth: 1\n  reliability: reliable\n  durability: transient_local\n"


@pytest.fixture
def bag(tmp_path):
    """A bag of 50 headers at 50 Hz, numbered in their stamps, and a latched topic at 0 and 10."""
    path = tmp_path / "in.mcap"
    with BagWriter(path) as writer:
        for i in range(50):
            time_ns = START + i * STEP
            writer.write("/numbers", header(i, "n"), time_ns)
            writer.write("/camera/numbers", header(i, "c"), time_ns)
            if i in (0, 10):
                data = serialize(header(i, "map"))
                writer.write_raw("/map", "std_msgs/msg/Header", data, time_ns, offered_qos=LATCHED)
    return path


def numbers(got):
    return [message.stamp.nanosec for message in got]


class Remote:
    """The services and parameters of a player."""

    def __init__(self, graph, node):
        self.graph, self.node = graph, node

    def call(self, kind, name, request):
        client = self.node.create_client(kind, f"/bag_player/{name}")
        self.graph.spin_until(client.service_is_ready, what=name)
        future = client.call_async(request)
        self.graph.spin_until(future.done, what=name)
        self.node.destroy_client(client)
        return future.result()

    def trigger(self, name):
        answer = self.call(Trigger, name, Trigger.Request())
        return answer.success, answer.message

    def set(self, name, value):
        parameter = Parameter(name, value=value).to_parameter_msg()
        request = SetParameters.Request(parameters=[parameter])
        (result,) = self.call(SetParameters, "set_parameters", request).results
        return result.successful, result.reason

    def get(self, name):
        request = GetParameters.Request(names=[name])
        (value,) = self.call(GetParameters, "get_parameters", request).values
        return value.double_value


def test_services_and_parameters_steer_the_player(graph, bag):
    node = graph.node("listener")
    remote = Remote(graph, node)
    got = graph.collect(node, Header, "/numbers")
    clock = graph.collect(node, Clock, "/clock", 1000)
    player = graph.start(
        PLAYER, bag, "--start-paused", "--clock", 50, "--topics", "numbers",
        "--wait-for-readers", 1,
    )  # fmt: skip
    graph.spin_until(lambda: len(clock) > 10)
    assert {m.clock.sec * 10**9 + m.clock.nanosec for m in clock} == {START}
    assert got == []
    assert remote.trigger("is_paused") == (True, "paused at 0.000 of 0.980 s, rate 1")
    for step in range(3):
        assert remote.trigger("play_next")[0]
        graph.spin_until(lambda step=step: len(got) == step + 1)
    assert numbers(got) == [0, 1, 2]
    assert remote.get("position") == pytest.approx(0.04)
    graph.spin_until(lambda: clock[-1].clock.nanosec == 40_000_000)
    assert remote.set("position", 0.5) == (True, "")
    assert remote.set("rate", 10) == (True, "")
    assert remote.get("position") == pytest.approx(0.5)
    assert remote.set("rate", -1.0) == (False, "rate: expected a number above 0, got -1.0")
    refused = remote.set("position", 7.0)
    assert refused == (False, "position: expected a number from 0.000 to 0.980 s, got 7.0")
    assert remote.trigger("is_paused") == (True, "paused at 0.500 of 0.980 s, rate 10")
    assert remote.trigger("toggle_paused")[0]
    graph.spin_until(lambda: player.poll() is not None)
    assert player.returncode == 0, player.stderr.read()
    graph.spin_until(lambda: len(got) == 3 + 25)
    assert numbers(got) == [0, 1, 2, *range(25, 50)]


def test_the_player_pauses_while_it_plays(graph, bag):
    node = graph.node("listener")
    remote = Remote(graph, node)
    got = graph.collect(node, Header, "/numbers", 500)
    words = ("--loop", "--wait-for-readers", 1, "--regex", "numbers$", "--exclude-regex", "cam")
    player = graph.start(PLAYER, bag, *words)
    graph.spin_until(lambda: len(got) > 5)
    assert remote.trigger("play_next")[0] is False
    assert remote.trigger("pause")[0]
    graph.spin_for(0.3)
    count = len(got)
    graph.spin_for(0.5)
    assert len(got) == count
    assert remote.trigger("resume")[0]
    graph.spin_until(lambda: len(got) > count + 60)
    assert numbers(got) == [i % 50 for i in range(numbers(got)[0], numbers(got)[0] + len(got))]
    player.send_signal(signal.SIGINT)
    graph.spin_until(lambda: player.poll() is not None)
    assert player.returncode == 0, player.stderr.read()


def test_topics_are_chosen_and_renamed(graph, bag):
    node = graph.node("listener")
    first = graph.collect(node, Header, "/first")
    second = graph.collect(node, Header, "/second")
    rest = [graph.collect(node, Header, name) for name in ("/numbers", "/camera/numbers", "/map")]
    player = graph.start(
        PLAYER, bag, "--regex", "numbers", "--exclude-topics", "map", "--rate", 10,
        "--wait-for-readers", 1, "--remap", "/numbers:=/first", "camera/numbers:=/other",
        "--ros-args", "-r", "/other:=/second",
    )  # fmt: skip
    graph.spin_until(lambda: len(first) == 50 and len(second) == 50)
    graph.spin_until(lambda: player.poll() is not None)
    assert {m.frame_id for m in first} == {"n"} and {m.frame_id for m in second} == {"c"}
    assert rest == [[], [], []]


def test_a_part_is_played_and_what_was_latched_before_comes_first(graph, bag):
    node = graph.node("listener")
    got = graph.collect(node, Header, "/numbers")
    order = []
    latched = QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(Header, "/map", lambda m: order.append(m), latched)
    player = graph.start(
        PLAYER, bag, "--start-offset", 0.4, "--duration", 0.2, "--topics", "numbers", "map",
        "--start-paused", "--wait-for-readers", 1,
    )  # fmt: skip
    graph.spin_until(lambda: order)
    assert got == [] and numbers(order) == [10]  # though it is paused
    late = []
    node.create_subscription(Header, "/map", late.append, latched)  # and whoever comes later
    graph.spin_until(lambda: late)
    assert numbers(late) == [10]
    assert Remote(graph, node).trigger("resume")[0]
    graph.spin_until(lambda: player.poll() is not None)
    graph.spin_until(lambda: len(got) == 11)
    assert numbers(got) == list(range(20, 31))
    assert numbers(order) == [10]


def test_the_end_can_be_given_as_a_stamp(graph, bag):
    node = graph.node("listener")
    got = graph.collect(node, Header, "/numbers")
    graph.start(
        PLAYER, bag, "--until", "1700000000.1", "--rate", 5, "--topics", "numbers",
        "--wait-for-readers", 1, "--ros-args", "-p", "position:=0.04",
    )  # fmt: skip
    graph.spin_until(lambda: len(got) == 4)
    graph.spin_for(0.3)
    assert numbers(got) == [2, 3, 4, 5]


def test_a_file_overrides_the_qos(graph, bag, tmp_path):
    overrides = tmp_path / "qos.yaml"
    overrides.write_text(
        "/numbers: {reliability: best_effort, depth: 2}\n"
        "/camera/numbers: {durability: transient_local, depth: 4}\n"
    )
    node = graph.node("listener")
    words = ("--qos-profile-overrides-path", overrides, "--start-paused", "--start-offset", 0.5)
    graph.start(PLAYER, bag, *words)

    def offers(name):
        return [info.qos_profile for info in node.get_publishers_info_by_topic(name)]

    graph.spin_until(lambda: offers("/numbers") and offers("/camera/numbers") and offers("/map"))
    assert offers("/numbers")[0].reliability == ReliabilityPolicy.BEST_EFFORT
    assert offers("/numbers")[0].durability == DurabilityPolicy.VOLATILE
    for name in ("/camera/numbers", "/map"):
        assert offers(name)[0].reliability == ReliabilityPolicy.RELIABLE
        assert offers(name)[0].durability == DurabilityPolicy.TRANSIENT_LOCAL
    got = []
    latched = QoSProfile(depth=9, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(Header, "/camera/numbers", got.append, latched)
    graph.spin_until(lambda: len(got) == 4)
    assert numbers(got) == [21, 22, 23, 24]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--start-offset", "60"], "nothing to play between"),
        (["--regex", "nothing at all"], "no message that can be played"),
        (["--exclude-regex", "("], "regular expression"),
        (["--qos-profile-overrides-path", "{folder}/none.yaml"], "none.yaml"),
        (["--ros-args", "-p", "rate:=-2.0"], "rate: expected a number above 0, got -2.0"),
        (["--ros-args", "-p", "position:=2.0"], "position: expected a number from 0.000 to 0.980"),
    ],
)
def test_what_cannot_be_played_is_one_sentence(bag, words, said, capsys):
    words = [w.format(folder=bag.parent) for w in words]
    assert bag_player.main([str(bag), *words]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1


def test_topics_that_ros_cannot_have_are_left_out_or_refused(graph, tmp_path, capsys):
    path = tmp_path / "odd.mcap"
    data = serialize(header(1, "a"))
    with BagWriter(path) as writer:
        writer.write_raw("/a-b", "std_msgs/msg/Header", data, 1)
        writer.write_raw("/two", "std_msgs/msg/Header", data, 2)
        writer.write_raw("/two", "std_msgs/msg/String", b"\0\1\0\0\1\0\0\0\0", 3)
        writer.write_raw("/fine", "std_msgs/msg/Header", b"", 4)  # what blocks a reader for good
        writer.write_raw("/fine", "std_msgs/msg/Header", data, 5)
        writer.write_raw("/odd", "other_msgs/msg/Odd", b"", 6, definition="bool flag")
    node = graph.node("listener")
    fine = graph.collect(node, Header, "/fine")
    two = graph.collect(node, Header, "/two")
    player = graph.start(PLAYER, path, "--start-paused", "--wait-for-readers", 1, "-x", "a-b|odd")
    remote = Remote(graph, node)
    assert [remote.trigger("play_next")[0] for _ in range(5)] == [True] * 4 + [False]
    graph.spin_until(lambda: fine and two)
    assert remote.trigger("resume")[0]
    graph.spin_until(lambda: player.poll() is not None)
    text = player.stderr.read()
    assert player.returncode == 1, text
    assert "1 messages without content" in text
    assert "/two (std_msgs/msg/String) is left out" in text
    for words, said in (
        (["--topics", "a-b"], "topic /a-b (std_msgs/msg/Header): Invalid topic name"),
        (["--topics", "odd"], "topic /odd (other_msgs/msg/Odd): type_name"),
        (["--topics", "fine", "--remap", "fine:=x-y"], "Invalid topic name"),
    ):
        assert bag_player.main([str(path), *words]) == 2
        assert said in capsys.readouterr().err


READER = """
import sys, time
import rclpy
from std_msgs.msg import Header
rclpy.init()
node = rclpy.create_node("stuck")
node.create_subscription(Header, "/numbers", print, 1000)
print("ready", flush=True)
time.sleep(60)
"""


def test_a_reader_that_does_not_acknowledge_is_told(graph, bag):
    reader = subprocess.Popen(
        [sys.executable, "-c", f"import geoprim_ros\n{READER}"], stdout=subprocess.PIPE, text=True
    )
    try:
        assert reader.stdout.readline() == "ready\n"
        player = graph.start(
            PLAYER, bag, "--topics", "numbers", "--wait-for-readers", 1, "--start-paused",
            "--wait-for-all-acked", 0.5,
        )  # fmt: skip
        remote = Remote(graph, graph.node("remote"))
        assert remote.trigger("is_paused")[0]
        graph.spin_for(0.5)
        reader.send_signal(signal.SIGSTOP)
        remote.trigger("resume")
        graph.spin_until(lambda: player.poll() is not None)
        text = player.stderr.read()
        assert (player.returncode, "/numbers" in text) == (1, True), text
    finally:
        reader.kill()
        reader.wait()
        reader.stdout.close()
