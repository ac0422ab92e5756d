"""What the recorder keeps: after a kill, of latched topics, by pattern, in parts."""

import signal
import time

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geoprim_msgs.msg import Contours
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Header, String

from geoprim_core.io.bags import BagReader
from geoprim_ros.nodes import bag_recorder
from geoprim_ros.qos_profiles import is_latched, offered_policies

RECORDER = "geoprim_ros.nodes.bag_recorder"
LATCHED = QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def words(*texts):
    return [String(data=text) for text in texts]


def wait_for_recorder(graph, node, *topics):
    """Wait until the recorder has met the publishers of some topics, and they have met it."""
    said = graph.collect(node, DiagnosticArray, "/diagnostics", 50)

    def met(topic):
        pairs = {p.key: p.value for s in (said[-1].status if said else ()) for p in s.values}
        own = [p for p in node.publishers if p.topic_name == topic]
        heard = all(p.get_subscription_count() for p in own)
        return heard and pairs.get(f"publishers of {topic}", "0") != "0"

    graph.spin_until(lambda: all(met(topic) for topic in topics), what=f"publishers of {topics}")


def stop(graph, recorder):
    """End the recorder as Ctrl-C does."""
    recorder.send_signal(signal.SIGINT)
    graph.spin_until(lambda: recorder.poll() is not None)
    assert recorder.returncode == 0, recorder.stderr.read()


def texts(reader, topic):
    return [message.decoded.data for message in reader.messages([topic])]


@pytest.mark.parametrize("compression", ["zstd", "lz4", "none"])
def test_after_a_kill_all_but_the_last_moment_is_there(graph, tmp_path, compression):
    path = tmp_path / "out.mcap"
    recorder = graph.start(
        RECORDER, path, "--topics", "contours", "--flush-period", 0.2, "--compression", compression
    )
    node = graph.node("source")
    publisher = node.create_publisher(Contours, "contours", 50)
    wait_for_recorder(graph, node, "/contours")
    for i in range(20):
        message = Contours(image_width=i)
        message.header.stamp.sec = 1 + i
        publisher.publish(message)
    graph.spin_for(1.0)  # a second is what may be lost
    publisher.publish(message)
    recorder.kill()
    recorder.wait()
    reader = BagReader(path)
    assert "cut off" in str(reader.losses)
    found = [m.decoded.image_width for m in reader.messages(["contours"])]
    assert found[:20] == list(range(20))


def test_everything_is_recorded_but_what_is_left_out(graph, tmp_path):
    path = tmp_path / "out.mcap"
    node = graph.node("source")
    names = ("/a/one", "/b/two", "/c/two_less", "/d/_hidden")
    publishers = [node.create_publisher(String, name, LATCHED) for name in names]
    for publisher in publishers:
        publisher.publish(String(data=publisher.topic_name))
    recorder = graph.start(RECORDER, path, "--all", "--exclude-regex", "less$|diagnostics")
    wait_for_recorder(graph, node, *names[:2])
    late = node.create_publisher(Header, "/late", 10)  # which appears while it records
    wait_for_recorder(graph, node, "/late")
    before = time.time_ns()
    late.publish(Header())
    graph.spin_for(0.5)
    stop(graph, recorder)
    reader = BagReader(path)
    kept = {topic.name for topic in reader.topics()}
    assert {"/a/one", "/b/two", "/late"} <= kept
    assert not kept & {"/c/two_less", "/d/_hidden", "/diagnostics"}
    (message,) = reader.messages(["/late"])
    assert abs(message.log_time_ns - before) < 60e9  # its time of arrival


def test_what_was_latched_before_the_start_is_recorded_and_stays_latched(graph, tmp_path):
    path = tmp_path / "out.mcap"
    node = graph.node("source")
    latched = node.create_publisher(String, "/map", LATCHED)
    plain = node.create_publisher(
        String, "/noise", QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
    )
    for message in words("one", "two"):
        latched.publish(message)
    recorder = graph.start(RECORDER, path, "--topics", "/map", "/noise")
    wait_for_recorder(graph, node, "/map", "/noise")
    plain.publish(String(data="x"))
    latched.publish(String(data="three"))
    graph.spin_for(0.5)
    stop(graph, recorder)
    reader = BagReader(path)
    assert texts(reader, "/map") == ["one", "two", "three"]
    assert texts(reader, "/noise") == ["x"]
    assert [is_latched(p) for p in offered_policies(reader.offered_qos("/map"))] == [True]
    (offer,) = offered_policies(reader.offered_qos("/noise"))
    assert offer["reliability"] == ReliabilityPolicy.BEST_EFFORT and not is_latched(offer)


def test_counts_are_told_and_overrides_are_heeded(graph, tmp_path):
    overrides = tmp_path / "qos.yaml"
    overrides.write_text("/words: {durability: transient_local}\n")
    node = graph.node("source")
    said = graph.collect(node, DiagnosticArray, "/diagnostics", 50)
    volatile = node.create_publisher(String, "/words", 5)
    recorder = graph.start(
        RECORDER, tmp_path / "out.mcap", "--topics", "words", "counted/contours",
        "--qos-profile-overrides-path", overrides,
    )  # fmt: skip
    contours = node.create_publisher(Contours, "counted/contours", 5)

    def asked():
        return [info.qos_profile for info in node.get_subscriptions_info_by_topic("/words")]

    graph.spin_until(asked)
    wait_for_recorder(graph, node, "/counted/contours")
    assert asked()[0].durability == DurabilityPolicy.TRANSIENT_LOCAL  # and so they do not match
    assert volatile.get_subscription_count() == 0
    contours.publish(Contours())

    def values():
        return {pair.key: pair.value for pair in said[-1].status[0].values} if said else {}

    graph.spin_until(lambda: values().get("messages") == "1")
    told = values()
    assert told["messages of /counted/contours"] == "1"
    assert told["publishers of /counted/contours"] == "1"  # a name that no other test has
    assert values()["publishers of /words"] == "0"
    stop(graph, recorder)
    (message,) = BagReader(tmp_path / "out.mcap").messages()
    assert message.log_time_ns > 1e18  # a stamp of zero is none


def test_a_recording_in_parts_is_one_bag(graph, tmp_path):
    folder = tmp_path / "run"
    recorder = graph.start(RECORDER, folder, "--topics", "/words", "--split-duration", 0.3)
    node = graph.node("source")
    publisher = node.create_publisher(String, "/words", 50)
    wait_for_recorder(graph, node, "/words")
    for i in range(12):
        publisher.publish(String(data=str(i)))
        graph.spin_for(0.1)
    graph.spin_for(0.3)
    stop(graph, recorder)
    assert len(list(folder.iterdir())) >= 3
    reader = BagReader(folder)
    assert not reader.losses
    assert texts(reader, "/words") == [str(i) for i in range(12)]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["{folder}", "--split-size", "1"], "holds a recording already"),
        (["{folder}/new.mcap", "--regex", "("], "regular expression"),
        (["{folder}/new.mcap", "--qos-profile-overrides-path", "{folder}/no.yaml"], "no.yaml"),
        (["{folder}"], "cannot write"),
    ],
)
def test_what_cannot_be_recorded_is_one_sentence(tmp_path, arguments, said, capsys):
    (tmp_path / "old.mcap").touch()
    assert bag_recorder.main([a.format(folder=tmp_path) for a in arguments]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["old.mcap"]
