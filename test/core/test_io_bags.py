"""Bags: what is written is read, by us and by others; damage costs what it hit and is told."""

import os
import struct
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import Writer
from rosbags.highlevel import AnyReader

from geoprim_core.errors import BagError, FileError, InputError
from geoprim_core.io.bags import BagReader, BagWriter
from geoprim_core.io.definitions import (
    message_texts,
    schema_text,
    serialize,
    split_schema,
    typestore,
)
from geoprim_core.io.image_message import image_record
from geoprim_core.io.record import Record, header
from geoprim_core.io.wire import from_wire, to_wire
from geoprim_core.types import Contours

FRAMES = 40
STEP = 66_666_666


def noise(index):
    return np.random.default_rng(index).integers(0, 256, (120, 160)).astype(np.uint8)


def contour(index):
    return Contours([[index, 0], [index, 1]], [0, 2], [False], (160, 120))


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A bag of 40 noise frames and contours; noise does not compress: about 19 kB a frame."""
    path = tmp_path_factory.mktemp("bags") / "whole.mcap"
    with BagWriter(path, chunk_bytes=100_000) as bag:
        for i in range(FRAMES):
            bag.write("image", image_record(noise(i), i * STEP, "camera"))
            bag.write("contours", to_wire(contour(i), i * STEP, "camera"))
        bag.add_metadata("sequences", {"camera": "noise"})
    return path


def chunks(path):
    with path.open("rb") as file:
        return make_reader(file).get_summary().chunk_indexes


def damaged(whole, tmp_path, change):
    data = bytearray(whole.read_bytes())
    changed = change(data)
    path = tmp_path / "damaged.mcap"
    path.write_bytes(data if changed is None else changed)
    return path


def frames_read(reader):
    """Return the numbers of the frames read, each checked to be as written."""
    numbers = []
    for frame in reader.images("image"):
        assert frame.reason == ""
        number = frame.stamp_ns // STEP
        np.testing.assert_array_equal(frame.image, noise(number))
        numbers.append(number)
    return numbers


def test_what_is_written_is_read(whole):
    reader = BagReader(whole)
    assert [(t.name, t.type, t.count) for t in reader.topics()] == [
        ("contours", "geoprim_msgs/msg/Contours", FRAMES),
        ("image", "sensor_msgs/msg/Image", FRAMES),
    ]
    assert frames_read(reader) == list(range(FRAMES))
    for i, message in enumerate(reader.messages(["/contours"])):
        assert message.log_time_ns == i * STEP
        assert from_wire(message.decoded).points.tolist() == contour(i).points.tolist()
    assert reader.metadata == {"sequences": {"camera": "noise"}}
    assert not reader.losses


def test_messages_come_in_the_order_of_their_times(tmp_path):
    times = [5, 3, 9, 1, 7, 2]
    with BagWriter(tmp_path / "mixed.mcap", chunk_bytes=1) as bag:  # a chunk a message
        for time in times:
            bag.write("stamps", header(time, "camera"), log_time_ns=time)
    reader = BagReader(tmp_path / "mixed.mcap")
    assert [m.log_time_ns for m in reader.messages()] == sorted(times)


def test_the_reader_of_rosbags_agrees(whole):
    """It knows our types only from the definitions in the bag."""
    with AnyReader([whole], default_typestore=None) as reader:
        found = {c.topic: c.msgtype for c in reader.connections}
        assert found == {"image": "sensor_msgs/msg/Image", "contours": "geoprim_msgs/msg/Contours"}
        for connection, time, raw in reader.messages():
            decoded = reader.deserialize(raw, connection.msgtype)
            assert decoded.header.stamp.sec * 10**9 + decoded.header.stamp.nanosec == time
            if connection.topic == "contours":
                expected = contour(time // STEP).points.reshape(-1)
                np.testing.assert_array_equal(decoded.points, expected)


def test_the_same_content_gives_the_same_bytes(tmp_path):
    for name in ("a.mcap", "b.mcap"):
        with BagWriter(tmp_path / name) as bag:
            bag.write("image", image_record(noise(0), 7, "camera"))
    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()


def test_a_folder_of_files_is_one_bag(whole, tmp_path):
    for number in (2, 10, 1):
        with BagWriter(tmp_path / f"part_{number}.mcap") as bag:
            bag.write("stamps", header(number, "camera"), log_time_ns=number)
    reader = BagReader(tmp_path)
    assert [m.log_time_ns for m in reader.messages()] == [1, 2, 10]
    assert reader.topic("stamps").count == 3


def test_a_missing_topic_lists_those_that_are_there(whole):
    reader = BagReader(whole)
    for ask in (reader.images, lambda name: reader.messages([name])):
        with pytest.raises(BagError, match=r"'depth'.*contours \(geoprim.*, 40\), image \(sensor"):
            ask("depth")


def test_a_topic_of_another_type_holds_no_images(whole):
    with pytest.raises(
        BagError, match=r"contours holds geoprim_msgs/msg/Contours, expected sensor"
    ):
        BagReader(whole).images("contours")


def test_a_bad_image_comes_with_its_reason(tmp_path):
    good = image_record(noise(0), 1, "camera")
    fields = {"encoding": "yuv422", "header": header(2, "camera")}
    with BagWriter(tmp_path / "bag.mcap") as bag:
        bag.write("image", good)
        bag.write("image", Record(good.type, good.fields | fields))
        bag.write_raw("image", good.type, b"\0\1\0\0\7", 3)
    first, second, third = BagReader(tmp_path / "bag.mcap").images()
    assert first.image is not None
    assert second.image is None
    assert "yuv422" in second.reason
    assert second.stamp_ns == 2
    assert third.image is None
    assert "cannot be decoded" in third.reason


@pytest.mark.parametrize(
    ("content", "text"),
    [(b"", "0 bytes"), (b"SQLite format 3\0", "ros2 bag convert"), (b"x" * 99, "not an MCAP")],
)
def test_other_files_are_refused(tmp_path, content, text):
    (tmp_path / "file.mcap").write_bytes(content)
    with pytest.raises(BagError, match=text):
        BagReader(tmp_path / "file.mcap")


def test_a_missing_file_and_an_empty_folder_are_refused(tmp_path):
    with pytest.raises(BagError, match=r"cannot read .*none.mcap: No such file"):
        BagReader(tmp_path / "none.mcap")
    (tmp_path / "other.db3").touch()
    with pytest.raises(BagError, match=r"no .mcap file; it holds other.db3"):
        BagReader(tmp_path)


@pytest.mark.parametrize("share", [0.2, 0.35, 0.6, 0.9])
def test_a_truncated_bag_is_read_up_to_the_cut(whole, tmp_path, share):
    cut = int(share * whole.stat().st_size)
    reader = BagReader(damaged(whole, tmp_path, lambda data: data[:cut]))
    complete = [c for c in chunks(whole) if c.chunk_start_offset + c.chunk_length <= cut]
    last = max(c.message_end_time for c in complete) // STEP if complete else -1
    found = frames_read(reader)
    assert found == list(range(len(found)))
    assert last <= len(found) <= last + 1  # a chunk may end between image and contours
    assert reader.topic("image").count == len(found)
    assert reader.losses
    assert "cut off" in str(reader.losses)


def test_a_bag_cut_in_its_first_chunk_says_so(whole, tmp_path):
    """After 5,000 bytes it is known that there were images, but none is whole."""
    reader = BagReader(damaged(whole, tmp_path, lambda data: data[:5000]))
    assert frames_read(reader) == []
    assert "cut off within a chunk" in str(reader.losses)
    with pytest.raises(BagError, match=r"its topics: none at all; .*cut off"):
        BagReader(damaged(whole, tmp_path, lambda data: data[:100])).images()


def test_a_bag_without_its_end_loses_no_message(whole, tmp_path):
    end = max(c.chunk_start_offset + c.chunk_length + c.message_index_length for c in chunks(whole))
    reader = BagReader(damaged(whole, tmp_path, lambda data: data[:end]))
    assert frames_read(reader) == list(range(FRAMES))
    assert "its end is missing" in str(reader.losses)


def test_a_damaged_chunk_costs_only_its_messages(whole, tmp_path):
    hit = chunks(whole)[2]

    def scratch(data):
        middle = hit.chunk_start_offset + hit.chunk_length // 2
        data[middle : middle + 4] = b"\xff\0\xff\0"

    reader = BagReader(damaged(whole, tmp_path, scratch))
    found = frames_read(reader)
    lost = sorted(set(range(FRAMES)) - set(found))
    first, last = hit.message_start_time // STEP, hit.message_end_time // STEP
    assert set(range(first + 1, last)) <= set(lost) <= set(range(first, last + 1))
    assert reader.losses.parts == 1
    assert reader.losses.bytes == hit.chunk_length
    assert reader.losses.messages >= 2 * len(lost) - 1
    assert "damaged chunk" in reader.losses.reasons[0]


def test_a_damaged_record_length_costs_no_message(whole, tmp_path):
    """The chunk repeats its length, and its checksum proves what is read with that one."""
    hit = chunks(whole)[1]

    def scratch(data):
        struct.pack_into("<Q", data, hit.chunk_start_offset + 1, 2**60)

    reader = BagReader(damaged(whole, tmp_path, scratch))
    assert frames_read(reader) == list(range(FRAMES))
    assert "damaged head" in str(reader.losses)
    assert reader.losses.exact
    assert reader.losses.messages == 0


def test_an_uncompressed_bag_without_chunks_is_read(tmp_path):
    path = tmp_path / "plain.mcap"
    with path.open("wb") as file:
        writer = Writer(file, use_chunking=False)
        writer.start()
        schema = writer.register_schema(
            "std_msgs/msg/Header", "ros2msg", schema_text("std_msgs/msg/Header").encode()
        )
        channel = writer.register_channel("stamps", "cdr", schema)
        data = typestore().serialize_cdr(
            typestore().types["std_msgs/msg/Header"](
                typestore().types["builtin_interfaces/msg/Time"](1, 2), "camera"
            ),
            "std_msgs/msg/Header",
        )
        writer.add_message(channel, 5, bytes(data), 5)
        writer.finish()
    (message,) = BagReader(path).messages()
    assert message.decoded.frame_id == "camera"


def test_a_type_that_only_the_bag_defines_is_decoded(tmp_path):
    """And one of ours is decoded as the bag defines it, not as this version does."""
    foreign = "uint8 count\n" + "=" * 80 + "\nMSG: other_msgs/Unused\nbool flag\n"
    with BagWriter(tmp_path / "foreign.mcap") as bag:
        bag.write_raw("odd", "other_msgs/msg/Odd", b"\0\1\0\0\7", 1, definition=foreign)
    (message,) = BagReader(tmp_path / "foreign.mcap").messages()
    assert message.decoded.count == 7


def test_the_bag_carries_the_whole_definition_with_its_comments():
    text = schema_text("geoprim_msgs/msg/EllipseDetections")
    parts = split_schema("geoprim_msgs/msg/EllipseDetections", text)
    own = {name: body for name, body in parts.items() if name.startswith("geoprim_msgs/")}
    assert {name.split("/")[2] for name in own} == {
        "EllipseDetections",
        "EllipseDetection",
        "Ellipse",
    }
    assert all(message_texts()[name].strip() == body.strip() for name, body in own.items())
    assert "builtin_interfaces/msg/Time" in parts


def test_an_exception_leaves_the_old_bag_and_nothing_else(tmp_path):
    path = tmp_path / "bag.mcap"
    path.write_bytes(b"old")
    with pytest.raises(RuntimeError), BagWriter(path) as bag:
        bag.write("stamps", header(1, "camera"), log_time_ns=1)
        raise RuntimeError
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["bag.mcap"]


def test_places_that_cannot_be_written_are_refused(tmp_path):
    with pytest.raises(FileError, match=r"cannot write .*No such file"):
        BagWriter(tmp_path / "missing" / "bag.mcap")
    with pytest.raises(FileError, match=r"cannot write .*folder"):
        BagWriter(tmp_path)
    (tmp_path / "file").touch()
    with pytest.raises(FileError, match="cannot write"):
        BagWriter(tmp_path / "file" / "bag.mcap")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_full_disk_is_told(tmp_path, monkeypatch):
    opened = Path.open
    monkeypatch.setattr(Path, "open", lambda self, mode: opened(Path("/dev/full"), mode))
    with pytest.raises(FileError, match="No space left"), BagWriter(tmp_path / "bag.mcap") as bag:
        for i in range(9):
            bag.write("image", image_record(noise(i), i, "camera"))


def test_records_that_are_no_messages_are_refused(tmp_path):
    with (
        pytest.raises(InputError, match=r"ROS 2 Jazzy.*'other_msgs/msg/Odd'"),
        BagWriter(tmp_path / "bag.mcap") as bag,
    ):
        bag.write("odd", Record("other_msgs/msg/Odd", {}), log_time_ns=0)
    with (
        pytest.raises(InputError, match=r"fields of std_msgs/msg/Header"),
        BagWriter(tmp_path / "bag.mcap") as bag,
    ):
        bag.write("odd", Record("std_msgs/msg/Header", {"frame": ""}), log_time_ns=0)


def numbered(path, count=40, **options):
    """Write small messages, ten nanoseconds apart, in chunks of a few."""
    with BagWriter(path, chunk_bytes=256, **options) as bag:
        for i in range(count):
            topic = "even" if i % 2 == 0 else "odd"
            bag.write(topic, header(i, "camera"), log_time_ns=10 * i)
    return path


@pytest.mark.parametrize(("since", "until"), [(None, None), (95, None), (None, 200), (100, 100)])
def test_a_range_of_times_holds_both_its_ends(tmp_path, since, until):
    reader = BagReader(numbered(tmp_path / "in.mcap"))
    assert reader.time_range == (0, 390)
    found = [m.log_time_ns for m in reader.messages(None, since, until)]
    first, last = since if since is not None else 0, until if until is not None else 390
    assert found == [t for t in range(0, 400, 10) if first <= t <= last]
    odd = [m.log_time_ns for m in reader.messages(["odd"], since, until)]
    assert odd == [t for t in found if t % 20]


def test_a_range_of_times_does_not_read_the_rest_of_the_file(tmp_path):
    path = numbered(tmp_path / "in.mcap")
    reader = BagReader(path)
    data = bytearray(path.read_bytes())
    data[300:340] = bytes(40)  # in the first chunk, after it was looked over
    path.write_bytes(data)
    assert [m.log_time_ns for m in reader.messages(None, 380)] == [380, 390]
    assert not reader.losses
    assert len(list(reader.messages())) < 40 and reader.losses


@pytest.mark.parametrize("compression", ["zstd", "lz4", "none"])
def test_every_compression_gives_the_same_messages(tmp_path, compression):
    reader = BagReader(numbered(tmp_path / "in.mcap", compression=compression))
    assert [m.decoded.stamp.nanosec for m in reader.messages()] == list(range(40))


def test_a_compression_that_there_is_not_is_refused(tmp_path):
    with pytest.raises(InputError, match="zstd"):
        BagWriter(tmp_path / "in.mcap", compression="rar")
    assert list(tmp_path.iterdir()) == []


def test_what_is_flushed_can_be_read_while_the_bag_grows(tmp_path):
    path = tmp_path / "out.mcap"
    bag = BagWriter(path, in_place=True)
    for i in range(3):
        bag.write("stamps", header(i, "camera"), log_time_ns=i)
    bag.flush()
    bag.write("stamps", header(3, "camera"), log_time_ns=3)
    reader = BagReader(path)
    assert [m.log_time_ns for m in reader.messages()] == [0, 1, 2]
    assert "cut off" in str(reader.losses)
    bag.discard()  # keeps what it has
    assert [m.log_time_ns for m in BagReader(path).messages()] == [0, 1, 2]


def test_the_qos_of_the_publishers_is_kept(tmp_path):
    path = tmp_path / "in.mcap"
    data = serialize(header(1, "camera"))
    with BagWriter(path) as bag:
        bag.write_raw("/map", "std_msgs/msg/Header", data, 1, offered_qos="- depth: 1\n")
        bag.write_raw("/other", "std_msgs/msg/Header", data, 2)
    reader = BagReader(path)
    assert (reader.offered_qos("map"), reader.offered_qos("other")) == ("- depth: 1\n", "")
