"""The player keeps what is in a bag; the recorder keeps what is on the topics."""

import signal
import time

import numpy as np
import pytest
from geoprim_msgs.msg import Contours, EllipseDetections
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image

from geoprim_core.io.bags import BagReader, BagWriter
from geoprim_core.io.record import stamp_of
from geoprim_ros.nodes import bag_player, bag_recorder

PLAYER = "geoprim_ros.nodes.bag_player"
RECORDER = "geoprim_ros.nodes.bag_recorder"
START = 1_700_000_000_123_456_789
STEP = 20_000_000


@pytest.fixture
def bag(tmp_path, disc_message):
    """A bag of 30 images at 50 Hz and 30 contours with the same stamps."""
    path = tmp_path / "in.mcap"
    with BagWriter(path) as writer:
        for i in range(30):
            stamp = START + i * STEP
            image = disc_message(stamp)
            writer.write_raw("/image", "sensor_msgs/msg/Image", serialize_message(image), stamp)
            contours = Contours(header=image.header, image_width=i)
            writer.write_raw(
                "/contours", "geoprim_msgs/msg/Contours", serialize_message(contours), stamp + 1
            )
    return path


def test_player_keeps_stamps_order_bytes_and_rhythm(graph, bag):
    node = graph.node("listener")
    images, contours, arrivals, clock = [], [], [], []

    def on_image(data):
        arrivals.append(time.monotonic())
        images.append(bytes(data))

    node.create_subscription(Image, "/camera", on_image, 50, raw=True)
    node.create_subscription(Contours, "/contours", contours.append, 50)
    node.create_subscription(Clock, "/clock", clock.append, 500)
    player = graph.start(
        PLAYER, bag, "--wait-for-readers", 1, "--clock", 100, "--rate", 2,
        "--ros-args", "-r", "/image:=/camera",
    )  # fmt: skip
    graph.spin_until(lambda: player.poll() is not None)
    graph.spin_until(lambda: len(images) == 30 and len(contours) == 30)
    assert player.returncode == 0, player.stderr.read()
    stored = [m.raw for m in BagReader(bag).messages(["image"])]
    same = [a == b for a, b in zip(images, stored, strict=True)]
    assert all(same), same  # the bytes themselves take minutes to be told apart in a report
    assert [stamp_of(m) for m in contours] == [START + i * STEP for i in range(30)]
    assert [m.image_width for m in contours] == list(range(30))
    assert arrivals[-1] - arrivals[0] >= 0.95 * 29 * STEP * 1e-9 / 2  # never ahead of time
    ticks = [m.clock.sec * 10**9 + m.clock.nanosec for m in clock]
    assert ticks == sorted(ticks)
    assert min(ticks) >= START and max(ticks) <= START + 30 * STEP
    assert len(ticks) >= 10


def test_player_topics_offset_and_loop(graph, bag):
    node = graph.node("listener")
    contours = graph.collect(node, Contours, "/contours", 500)
    images = graph.collect(node, Image, "/image", 500)
    player = graph.start(
        PLAYER, bag, "--wait-for-readers", 1, "--topics", "contours", "--start-offset", 0.4,
        "--rate", 20, "--loop",
    )  # fmt: skip
    graph.spin_until(lambda: len(contours) >= 25)
    player.send_signal(signal.SIGINT)
    graph.spin_until(lambda: player.poll() is not None)
    assert player.returncode == 0, player.stderr.read()
    assert [m.image_width for m in contours[:25]] == [
        *range(20, 30),
        *range(20, 30),
        *range(20, 25),
    ]
    assert images == []


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["{bag}", "--topics", "nothing"], "/contours (geoprim_msgs/msg/Contours, 30)"),
        (["{folder}/none.mcap"], "none.mcap"),
        (["{bag}", "--wait-for-readers", "1", "--wait-limit", "0.2"], "1 readers of /image"),
    ],
)
def test_player_says_what_is_wrong(bag, words, said, capsys):
    arguments = [w.format(bag=bag, folder=bag.parent) for w in words]
    assert bag_player.main(arguments) == 2
    assert said in capsys.readouterr().err


def test_player_plays_what_is_left_of_a_damaged_bag(bag, capfd):
    noise = np.random.default_rng(0)
    whole, cut = bag.with_name("long.mcap"), bag.with_name("cut.mcap")
    with BagWriter(whole) as writer:
        for message in BagReader(bag).messages(["contours"]):
            writer.write_raw(message.topic, message.type, message.raw, message.log_time_ns)
        for i in range(400):  # several chunks more
            writer.write_raw("/noise", "std_msgs/msg/String", noise.bytes(8192), START + 10**9 + i)
    data = whole.read_bytes()
    cut.write_bytes(data[: len(data) // 2])
    assert bag_player.main([str(cut), "--topics", "contours", "--rate", "100"]) == 1
    assert "lost" in capfd.readouterr().err


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_recorder_keeps_all_and_finishes_the_bag(graph, tmp_path, disc_message, number):
    path = tmp_path / "out.mcap"
    recorder = graph.start(
        RECORDER, path, "--images",
        "--ros-args", "-p", "qos_overrides./image.subscription.reliability:=reliable",
    )  # fmt: skip
    node = graph.node("source")
    contours = node.create_publisher(Contours, "contours", 50)
    ellipses = node.create_publisher(EllipseDetections, "ellipses", 50)
    images = node.create_publisher(Image, "image", QoSProfile(depth=50))
    publishers = (contours, ellipses, images)
    graph.spin_until(lambda: all(p.get_subscription_count() for p in publishers))
    graph.spin_for(0.3)
    sent = {"/contours": [], "/ellipses": [], "/image": []}
    for i in range(30):
        image = disc_message(START + i * STEP)
        for publisher, message in (
            (images, image),
            (contours, Contours(header=image.header, image_width=i)),
            (ellipses, EllipseDetections(header=image.header, image_height=i)),
        ):
            data = serialize_message(message)
            publisher.publish(data)
            sent[publisher.topic_name].append((START + i * STEP, data))
    graph.spin_for(1.0)
    recorder.send_signal(number)
    graph.spin_until(lambda: recorder.poll() is not None)
    assert recorder.returncode == 0, recorder.stderr.read()
    reader = BagReader(path)
    assert not reader.losses
    for topic, messages in sent.items():
        assert [(m.log_time_ns, m.raw) for m in reader.messages([topic])] == messages, topic


def test_recorder_ends_when_nothing_comes_any_more(graph, bag, tmp_path):
    path = tmp_path / "out.mcap"
    recorder = graph.start(RECORDER, path, "--idle-limit", 0.5, "--topics", "contours")
    player = graph.start(PLAYER, bag, "--rate", 10, "--topics", "contours", "--wait-for-readers", 1)
    graph.spin_until(lambda: recorder.poll() is not None)
    assert (recorder.returncode, player.wait(10)) == (0, 0), recorder.stderr.read()
    stored, copied = (BagReader(p).messages(["contours"]) for p in (bag, path))
    assert [m.raw for m in stored] == [m.raw for m in copied]


def test_recorder_says_that_it_cannot_write(tmp_path, capsys):
    assert bag_recorder.main([str(tmp_path / "no" / "folder.mcap")]) == 2
    assert "cannot write" in capsys.readouterr().err
