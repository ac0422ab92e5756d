"""What is played and with which QoS: topics, ranges of time, latched topics, override files."""

import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from geoprim_core.errors import BagError, FileError, GeoprimError, InputError
from geoprim_core.io.bags import BagReader, BagWriter
from geoprim_core.io.definitions import new_typestore, schema_text, split_schema
from geoprim_core.io.record import header
from geoprim_ros.installed_types import installed_definition
from geoprim_ros.player_options import nanoseconds, remapping
from geoprim_ros.qos_profiles import (
    is_latched,
    offered_policies,
    offered_text,
    profile,
    read_overrides,
)
from geoprim_ros.selection import BagRange, TopicFilter
from geoprim_ros.split_writer import Split, SplitWriter

NAMES = ["/image", "/left/image", "/left/info", "/right/image"]


@pytest.mark.parametrize(
    ("words", "taken"),
    [
        ({}, NAMES),
        ({"topics": ["image"]}, ["/image"]),
        ({"regex": "^/left"}, ["/left/image", "/left/info"]),
        ({"topics": ["/image"], "regex": "info$"}, ["/image", "/left/info"]),
        ({"exclude_regex": "image"}, ["/left/info"]),
        ({"exclude_topics": ["left/info", "/image"]}, ["/left/image", "/right/image"]),
        ({"topics": ["/image"], "exclude_topics": ["/image"]}, []),
    ],
)
def test_topics_are_chosen_by_name_and_pattern(words, taken):
    assert [name for name in NAMES if TopicFilter(**words).takes(name)] == taken


def test_a_pattern_that_is_none_is_refused():
    with pytest.raises(InputError, match="regular expression"):
        TopicFilter(exclude_regex="(")


@pytest.fixture
def bag(tmp_path):
    """A bag of a latched topic, at 0, 10 and 20, another one at 15, and numbers at 0 .. 29."""
    path = tmp_path / "in.mcap"
    with BagWriter(path, chunk_bytes=100) as writer:
        for i in range(30):
            writer.write("/numbers", header(i, "n"), log_time_ns=i)
            if i % 10 == 0:
                writer.write("/map", header(i, "m"), log_time_ns=i)
            if i == 15:
                writer.write("/legend", header(i, "l"), log_time_ns=i)
    return BagReader(path)


def test_a_range_knows_what_held_before_it(bag):
    whole = BagRange(bag, ["/numbers", "/map"], *bag.time_range, {"/map": 2, "/legend": 1})
    part = whole.between(5, 22)
    assert (part.start_ns, part.end_ns) == (5, 22)
    assert [m.log_time_ns for m in part.messages(19)] == [19, 20, 20, 21, 22]
    held = [(m.topic, m.log_time_ns) for m in part.state_before(20)]
    assert held == [("/map", 0), ("/map", 10), ("/legend", 15)]
    held = [(m.topic, m.log_time_ns) for m in part.state_before(21)]
    assert held == [("/map", 10), ("/legend", 15), ("/map", 20)]
    assert list(part.state_before(0)) == []
    assert (whole.between(-5, 99).start_ns, whole.between(-5, 99).end_ns) == (0, 29)
    with pytest.raises(BagError, match="nothing to play"):
        whole.between(40)


def test_overrides_are_read_as_rosbag2_writes_them(tmp_path):
    path = tmp_path / "qos.yaml"
    path.write_text(
        "/image:\n  reliability: best_effort\n  depth: 3\n  history: keep_last\n"
        "/map:\n  durability: transient_local\n  reliability: 1\n"
        "  deadline: {sec: 2, nsec: 5}\n  lifespan: {sec: 9223372036, nsec: 854775807}\n"
        "  liveliness: automatic\n  avoid_ros_namespace_conventions: false\n"
    )
    found = read_overrides(path)
    image = profile(QoSProfile(depth=50), found["/image"])
    assert (image.depth, image.reliability) == (3, ReliabilityPolicy.BEST_EFFORT)
    assert image.durability == DurabilityPolicy.VOLATILE
    latched = profile(QoSProfile(depth=50), found["/map"])
    assert (latched.depth, latched.reliability) == (50, ReliabilityPolicy.RELIABLE)
    assert latched.durability == DurabilityPolicy.TRANSIENT_LOCAL
    assert latched.deadline.nanoseconds == 2_000_000_005
    assert is_latched(found["/map"]) and not is_latched(found["/image"])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("/a: {reliability: sometimes}", "/a.reliability: expected one of system_default, rel"),
        ("/a: {relability: reliable}", "'relability'"),
        ("/a: {depth: -1}", "/a.depth: expected a number of messages, got -1"),
        ("/a: {depth: true}", "/a.depth"),
        ("/a: {durability: 77}", "/a.durability"),
        ("/a: {deadline: soon}", "/a.deadline: expected a time as sec and nsec"),
        ("/a: best_effort", "/a: expected QoS policies"),
        ("- 1", "expected topics"),
        ("{", "cannot read the QoS overrides"),
    ],
)
def test_a_wrong_override_is_said(tmp_path, text, said):
    path = tmp_path / "qos.yaml"
    path.write_text(text)
    with pytest.raises(GeoprimError) as problem:
        read_overrides(path)
    assert said in str(problem.value)


def test_a_missing_file_of_overrides_is_said(tmp_path):
    with pytest.raises(FileError, match=r"none\.yaml"):
        read_overrides(tmp_path / "none.yaml")


def test_profiles_survive_the_bag():
    offer = QoSProfile(depth=4, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    (back,) = offered_policies(offered_text([offer]))
    assert profile(QoSProfile(depth=9), back) == offer
    assert offered_text([]) == ""


@pytest.mark.parametrize("text", ["", "{", "7", "- 3", "- {durability: no}", "[[]]"])
def test_profiles_that_cannot_be_read_are_none(text):
    assert offered_policies(text) == []


def test_words_of_the_command_line():
    assert remapping("/a:=b") == ("/a", "b")
    assert nanoseconds("1700000000.123456789") == 1_700_000_000_123_456_789
    for wrong in ("/a", ":=b", "a:="):
        with pytest.raises(Exception, match="OLD:=NEW"):
            remapping(wrong)
    for wrong in ("now", "nan", "inf"):
        with pytest.raises(Exception, match="seconds"):
            nanoseconds(wrong)


@pytest.mark.parametrize("name", ["sensor_msgs/msg/CameraInfo", "geoprim_msgs/msg/Detections"])
def test_an_installed_definition_is_complete(name):
    """Types that a bag defines itself are decoded from this text alone."""
    parts = split_schema(name, installed_definition(name))
    assert set(parts) == set(split_schema(name, schema_text(name)))
    renamed = {"other_msgs/msg/Copy": parts[name]} | {
        part: text for part, text in parts.items() if part.startswith("geoprim_msgs/")
    }
    here = new_typestore(renamed).fielddefs["other_msgs/msg/Copy"]
    there = new_typestore(parts).fielddefs[name]
    assert [field[0] for field in here[1]] == [field[0] for field in there[1]]


def test_a_definition_that_is_not_installed_is_empty():
    assert installed_definition("other_msgs/msg/Odd") == ""


def test_a_recording_is_split_by_size_and_read_as_one_bag(tmp_path):
    folder = tmp_path / "run"
    writer = SplitWriter(folder, Split(bytes=1500), "none")
    data = b"\0\1\0\0" + bytes(8) + bytes([1, 0, 0, 0, 0])
    for i in range(40):
        writer.write_raw("/a", "std_msgs/msg/Header", data, i, offered_qos="- depth: 7\n")
        if i % 5 == 4:
            writer.flush()
    writer.close()
    names = sorted(path.name for path in folder.iterdir())
    assert names[:2] == ["run_0.mcap", "run_1.mcap"] and len(names) > 2
    reader = BagReader(folder)
    assert [m.log_time_ns for m in reader.messages()] == list(range(40))
    assert not reader.losses and reader.offered_qos("/a") == "- depth: 7\n"
    with pytest.raises(FileError, match="recording already"):
        SplitWriter(folder, Split(bytes=3000))
