"""Damaged bags: everything readable is read, everything lost is said, nothing is invented."""

import importlib.util
import struct
import sys
import tracemalloc
from collections import Counter
from pathlib import Path

import lz4.frame
import pytest
import zstandard
from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType, Writer

from geoprim_core.cli.main import main
from geoprim_core.errors import BagError, FileError
from geoprim_core.io import mcap_file, mcap_reading
from geoprim_core.io.bag_check import inspect_bag
from geoprim_core.io.bag_repair import repair_bag
from geoprim_core.io.bags import BagReader, BagWriter
from geoprim_core.io.definitions import schema_text, serialize
from geoprim_core.io.mcap_catalogue import Grade
from geoprim_core.io.mcap_chunks import split, unpack
from geoprim_core.io.mcap_file import McapFile
from geoprim_core.io.record import header

ROOT = Path(__file__).resolve().parents[2]
_SPEC = importlib.util.spec_from_file_location("damage_bags", ROOT / "tools" / "damage_bags.py")
damage = sys.modules["damage_bags"] = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(damage)

KINDS = {"zstd": CompressionType.ZSTD, "lz4": CompressionType.LZ4, "raw": CompressionType.NONE}


@pytest.fixture(scope="module", params=KINDS)
def whole(request, tmp_path_factory):
    """A bag in one of the three compressions and its messages."""
    path = tmp_path_factory.mktemp("bags") / f"{request.param}.mcap"
    return path, damage.build(path, 7, KINDS[request.param])


def chunks(path):
    with path.open("rb") as file:
        return make_reader(file).get_summary().chunk_indexes


def changed(path, tmp_path, change):
    data = bytearray(path.read_bytes())
    change(data)
    target = tmp_path / "damaged.mcap"
    target.write_bytes(data)
    return target


def rows(reader):
    return Counter(damage._row(m) for m in reader.messages())


def stamps(path, times, **options):
    """Write headers with some log times in chunks of few."""
    with path.open("wb") as file:
        writer = Writer(file, 200, **options)
        writer.start("ros2")
        kind = "std_msgs/msg/Header"
        schema = writer.register_schema(kind, "ros2msg", schema_text(kind).encode())
        channel = writer.register_channel("stamps", "cdr", schema)
        for i, time in enumerate(times):
            writer.add_message(channel, time, serialize(header(time, f"frame {i}")), time, i)
        writer.finish()
    return path


@pytest.mark.parametrize("kind", damage.KINDS, ids=lambda kind: kind.__name__)
def test_random_damage_is_never_silent(kind, tmp_path):
    """The law of tools/damage_bags.py; `python tools/damage_bags.py --count 1000` runs it fully."""
    broken = {
        (name, i): outcome.broken
        for name, i, outcome in damage.run(3, 20, tmp_path, (kind,))
        if outcome.broken
    }
    assert broken == {}


@pytest.mark.parametrize(
    ("lies", "text"),
    [
        ([(mcap_reading, "_grade", lambda *_: Grade.PROVED)], "was not written comes"),
        (
            [(McapFile, "_note", lambda *_: None), (McapFile, "_count", lambda *_: None)],
            "missing without a word",
        ),
    ],
)
def test_the_law_notices_a_reader_that_hides_something(tmp_path, monkeypatch, lies, text):
    """A law that nothing can break proves nothing."""
    originals = damage.build(tmp_path / "bag.mcap", 1, CompressionType.NONE)
    hit = chunks(tmp_path / "bag.mcap")[3]

    def scratch(data):
        data[hit.chunk_start_offset + hit.chunk_length - 5] ^= 1

    path = changed(tmp_path / "bag.mcap", tmp_path, scratch)
    assert damage.judge(path, originals).broken == []
    for owner, name, lie in lies:
        monkeypatch.setattr(owner, name, lie)
    assert any(text in broken for broken in damage.judge(path, originals).broken)


def test_messages_of_a_half_written_chunk_are_read_and_marked(whole, tmp_path):
    path, originals = whole
    hit = chunks(path)[4]
    end = hit.chunk_start_offset + int(0.85 * hit.chunk_length)
    reader = BagReader(changed(path, tmp_path, lambda data: data.__delitem__(slice(end, None))))
    marked = [m for m in reader.messages() if m.doubt]
    if path.stem == "raw":  # a small frame is one block: nothing or all
        assert len(marked) >= 3
    assert not rows(reader) - Counter(originals)
    assert all("cut off" in m.doubt for m in marked)
    assert reader.losses.doubtful == len(marked)
    assert "cut off within a chunk" in str(reader.losses)


@pytest.mark.parametrize("kind", [CompressionType.ZSTD, CompressionType.LZ4])
def test_a_large_packed_chunk_gives_the_messages_before_the_cut(tmp_path, kind):
    path = tmp_path / "large.mcap"
    originals = damage.build(path, 3, kind, chunk_bytes=1 << 30, frames=400)
    (hit,) = chunks(path)
    end = hit.chunk_start_offset + int(0.7 * hit.chunk_length)
    path.write_bytes(path.read_bytes()[:end])
    reader = BagReader(path)
    found = rows(reader)
    assert 0.4 * len(originals) < found.total() < 0.8 * len(originals)
    assert not found - Counter(originals)
    assert reader.losses.doubtful == found.total()


def test_what_fails_its_checksum_is_kept_back_unless_asked_for(whole, tmp_path):
    path, originals = whole
    hit = chunks(path)[2]

    def scratch(data):
        data[hit.chunk_start_offset + hit.chunk_length - 700] ^= 4

    damaged = changed(path, tmp_path, scratch)
    reader = BagReader(damaged)
    read = rows(reader)
    gone = Counter(originals) - read
    assert not read - Counter(originals)
    assert gone.total() == reader.losses.messages > 0
    assert reader.losses.exact
    (loss,) = reader.losses.details
    assert (loss.offset, loss.bytes) == (hit.chunk_start_offset, hit.chunk_length)
    assert all(loss.start_ns <= row[2] <= loss.end_ns for row in gone)
    everything = BagReader(damaged, keep_doubtful=True)
    marked = [m for m in everything.messages() if m.doubt]
    assert len(marked) == everything.losses.doubtful
    if path.stem == "raw":  # nothing stops the reading of an uncompressed chunk
        assert len(marked) == gone.total()
        wrong = Counter(damage._row(m) for m in marked) - gone
        assert wrong.total() == 1


def test_a_size_field_allocates_nothing(whole, tmp_path):
    path, _ = whole
    hit = chunks(path)[1]

    def forge(data):
        struct.pack_into("<Q", data, hit.chunk_start_offset + 9 + 16, 2**62)
        data[hit.chunk_start_offset + 200] ^= 1

    damaged = changed(path, tmp_path, forge)
    tracemalloc.start()
    try:
        reader = BagReader(damaged)
        assert sum(1 for _ in reader.messages()) > 100
        assert tracemalloc.get_traced_memory()[1] < 30e6
    finally:
        tracemalloc.stop()
    assert reader.losses


@pytest.mark.parametrize(
    ("name", "pack"), [("zstd", zstandard.compress), ("lz4", lz4.frame.compress)]
)
def test_a_bomb_is_not_unpacked(name, pack):
    bomb = pack(bytes(200 << 20))
    tracemalloc.start()
    try:
        unpacked = unpack(name, bomb, 1000)
        assert tracemalloc.get_traced_memory()[1] < 100e6
    finally:
        tracemalloc.stop()
    assert unpacked.contradicted
    assert "more than" in unpacked.fault


def test_a_frame_that_announces_too_much_is_read_by_what_it_holds():
    frame = zstandard.ZstdCompressor().compress(b"a" * 70_000)
    forged = frame[:5] + struct.pack("<I", 2**31) + frame[9:]
    assert zstandard.get_frame_parameters(forged).content_size == 2**31
    tracemalloc.start()
    try:
        assert unpack("zstd", forged, 70_000).fault
        assert tracemalloc.get_traced_memory()[1] < 10e6
    finally:
        tracemalloc.stop()


def test_a_file_of_forged_chunk_heads_ends(tmp_path):
    """Each head claims all that follows: a search that believed them would never end."""
    head = struct.Struct("<BQQQQIIQ")
    count = 3000
    size = 8 + count * head.size
    content = bytearray(b"\x89MCAP0\r\n")
    for i in range(count):
        rest = max(size - 8 - (i + 1) * head.size - 3, 0)
        content += head.pack(6, 40 + rest, 0, 1, rest, 1, 0, rest)
    (tmp_path / "forged.mcap").write_bytes(content)
    with pytest.raises(BagError, match="no topic"):
        BagReader(tmp_path / "forged.mcap").topic("image")


def test_what_fails_again_and_again_is_given_up(tmp_path, monkeypatch):
    """A file of bombs with wrong checksums is not unpacked to its bitter end."""
    monkeypatch.setattr(mcap_file, "_WINDOW", 1 << 20)
    bomb = zstandard.compress(bytes(1 << 20))
    head = struct.pack("<BQQQQII", 6, 44 + len(bomb), 0, 1, 1 << 20, 1, 4) + b"zstd"
    chunk = head + struct.pack("<Q", len(bomb)) + bomb
    (tmp_path / "bombs.mcap").write_bytes(b"\x89MCAP0\r\n" + 300 * chunk)
    reader = BagReader(tmp_path / "bombs.mcap")
    assert list(reader.messages()) == []
    assert any("not unpacked" in reason for reason in reader.losses.reasons)
    assert reader.losses.bytes == 300 * len(chunk)


def test_a_damaged_record_in_a_chunk_costs_no_other():
    body = struct.pack("<HIQQ", 1, 0, 5, 5) + b"data"
    record = b"\x05" + struct.pack("<Q", len(body)) + body
    broken = b"\x05" + struct.pack("<Q", 2**50) + body
    content = split(record + broken + record * 2)
    assert len(content.messages) == 3
    assert "byte 35" in content.fault


@pytest.mark.parametrize("opcode", [0x86, 0x07, 0x46])
def test_a_chunk_with_a_damaged_opcode_is_told_by_its_checksum(whole, tmp_path, opcode):
    path, originals = whole
    hit = chunks(path)[3].chunk_start_offset
    reader = BagReader(changed(path, tmp_path, lambda data: data.__setitem__(hit, opcode)))
    assert rows(reader) == Counter(originals)
    assert "damaged head" in reader.losses.reasons[0]


@pytest.mark.parametrize("place", [0, -1])
def test_a_damaged_mark_costs_no_message(whole, tmp_path, place):
    path, originals = whole
    reader = BagReader(changed(path, tmp_path, lambda data: data.__setitem__(place, 0x55)))
    assert rows(reader) == Counter(originals)
    assert reader.losses.exact
    assert (reader.losses.messages, reader.losses.parts) == (0, 1)
    assert "mark" in reader.losses.reasons[0]


def test_zeros_after_a_power_cut_are_left_out(whole, tmp_path):
    path, originals = whole
    reader = BagReader(changed(path, tmp_path, lambda data: data.extend(bytes(100_000))))
    assert rows(reader) == Counter(originals)
    (loss,) = reader.losses.details
    assert (loss.offset, loss.bytes) == (path.stat().st_size, 100_000)


def test_a_file_twice_in_one_is_read_once(whole, tmp_path):
    path, originals = whole
    reader = BagReader(changed(path, tmp_path, lambda data: data.extend(bytes(data))))
    assert rows(reader) == Counter(originals)
    assert "twice" in " ".join(reader.losses.reasons)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"use_chunking": False},
        {"enable_crcs": False},
        {"enable_data_crcs": True},
        {"index_types": IndexType.NONE},
        {"index_types": IndexType.CHUNK},
        {"use_statistics": False},
        {"repeat_channels": False, "repeat_schemas": False},
        {
            "index_types": IndexType.NONE, "use_statistics": False, "repeat_channels": False,
            "repeat_schemas": False, "use_summary_offsets": False,
        },
    ],
)  # fmt: skip
def test_a_whole_bag_of_any_make_is_whole(tmp_path, options):
    report = inspect_bag(stamps(tmp_path / "bag.mcap", range(0, 3000, 10), **options))
    assert (report.exit_code, report.messages, report.losses.parts) == (0, 300, 0)
    protected = options.get("use_chunking", True) and options.get("enable_crcs", True)
    assert any("no checksum" in note for note in report.notes) != protected


def test_the_checksum_of_all_data_is_held(tmp_path):
    path = stamps(tmp_path / "bag.mcap", range(9), use_chunking=False, enable_data_crcs=True)
    where = path.read_bytes().index(b"frame 3")
    report = inspect_bag(changed(path, tmp_path, lambda data: data.__setitem__(where, 0x46)))
    assert report.exit_code == 1
    assert "checksum of all data" in report.faults[0]


def test_times_out_of_order_are_sorted_without_an_index_too(tmp_path):
    times = [50, 10, 90, 30, 70, 20, 60, 40, 80, 100, 5] * 5
    path = stamps(tmp_path / "bag.mcap", times)
    cut = changed(path, tmp_path, lambda data: data.__delitem__(slice(-700, None)))
    reader = BagReader(cut)
    found = [m.log_time_ns for m in reader.messages()]
    assert found == sorted(found)
    assert not reader.losses.notes


def test_beyond_the_window_disorder_is_said(tmp_path, monkeypatch):
    monkeypatch.setattr(mcap_file, "_WINDOW", 100)
    times = [100 * i for i in range(20)] + [50]
    path = stamps(tmp_path / "bag.mcap", times[-1:] + times[:-1])
    with path.open("rb") as file:  # one chunk from first to last, the rest within it
        assert make_reader(file).get_summary().statistics.message_count == 21
    shuffled = [
        t for pair in zip(range(0, 2000, 100), range(2000, 0, -100), strict=True) for t in pair
    ]
    reader = BagReader(stamps(tmp_path / "wide.mcap", shuffled))
    found = [m.log_time_ns for m in reader.messages()]
    assert sorted(found) == sorted(shuffled)
    assert found != sorted(found)
    assert "out of order" in reader.losses.notes[0]


@pytest.fixture
def folder(tmp_path):
    """A recording of three files with its metadata."""
    bag = tmp_path / "bag"
    bag.mkdir()
    facts = []
    for i in range(3):
        stamps(bag / f"bag_{i}.mcap", range(1000 * i, 1000 * i + 500, 10))
        facts.append(
            f"    - path: bag_{i}.mcap\n      starting_time:\n"
            f"        nanoseconds_since_epoch: {1000 * i}\n"
            f"      duration:\n        nanoseconds: 490\n      message_count: 50\n"
        )
    names = "".join(f"    - bag_{i}.mcap\n" for i in range(3))
    text = (
        f"rosbag2_bagfile_information:\n  relative_file_paths:\n{names}  files:\n{''.join(facts)}"
    )
    (bag / "metadata.yaml").write_text(text)
    return bag


def test_a_whole_folder_is_whole(folder):
    assert inspect_bag(folder).exit_code == 0


def test_a_file_missing_from_a_folder_is_counted(folder):
    (folder / "bag_1.mcap").unlink()
    report = inspect_bag(folder)
    (loss,) = report.losses.details
    assert (loss.messages, loss.start_ns, loss.end_ns) == (50, 1000, 1490)
    assert report.losses.exact
    assert (report.messages, report.exit_code) == (100, 1)


@pytest.mark.parametrize("content", [b"", b"x" * 500])
def test_a_file_of_a_folder_that_is_nothing_costs_only_itself(folder, content):
    (folder / "bag_2.mcap").write_bytes(content)
    report = inspect_bag(folder)
    assert (report.messages, report.losses.messages, report.exit_code) == (100, 50, 1)


def test_a_folder_without_metadata_is_read_and_a_gap_is_said(folder):
    (folder / "metadata.yaml").unlink()
    report = inspect_bag(folder)
    assert (report.messages, report.exit_code) == (150, 0)
    assert "metadata.yaml is missing" in report.notes[0]
    (folder / "bag_1.mcap").unlink()
    report = inspect_bag(folder)
    assert report.exit_code == 1
    assert "bag_1.mcap is missing" in str(report)


@pytest.mark.parametrize("text", ["a: [", "rosbag2_bagfile_information: 3", "\0\0", "- 1"])
def test_damaged_metadata_costs_no_message(folder, text):
    (folder / "metadata.yaml").write_text(text)
    report = inspect_bag(folder)
    assert (report.messages, report.exit_code) == (150, 1)
    assert "metadata.yaml is damaged" in str(report)


def test_a_cut_file_is_counted_by_the_metadata(folder):
    path = folder / "bag_1.mcap"
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    reader = BagReader(folder)
    assert reader.losses.exact
    assert reader.losses.messages == 150 - rows(reader).total() > 0


def test_a_message_that_is_not_of_its_type_is_bad(tmp_path):
    with BagWriter(tmp_path / "bag.mcap") as bag:
        bag.write("stamps", header(1, "camera"), log_time_ns=1)
        bag.write_raw("stamps", "std_msgs/msg/Header", b"\0\1\0\0\7", 2)
    report = inspect_bag(tmp_path / "bag.mcap")
    assert (report.topics[0].bad, report.exit_code, report.losses.parts) == (1, 1, 0)
    assert "cannot be decoded as std_msgs/msg/Header" in str(report)


def test_a_schema_that_is_not_that_of_ros_is_said(tmp_path):
    with (tmp_path / "bag.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start("ros2")
        schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"uint8 other")
        channel = writer.register_channel("words", "cdr", schema)
        writer.add_message(channel, 1, b"\0\1\0\0\2\0\0\0a\0", 1)
        writer.finish()
    report = inspect_bag(tmp_path / "bag.mcap")
    assert report.exit_code == 0
    assert "std_msgs/msg/String in the bag is not that of ROS 2 Jazzy" in report.notes[0]


def records(path):
    """Return messages, schemas, metadata and attachments as the library of MCAP reads them."""
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        messages = [
            (schema.name, schema.data, schema.encoding, channel.topic, channel.message_encoding,
             tuple(channel.metadata.items()), m.sequence, m.log_time, m.publish_time, m.data)
            for schema, channel, m in reader.iter_messages()
        ]  # fmt: skip
        metadata = [(m.name, tuple(m.metadata.items())) for m in reader.iter_metadata()]
        parts = [(a.name, a.media_type, a.log_time, a.data) for a in reader.iter_attachments()]
        return Counter(messages), metadata, parts


def test_the_repair_of_a_whole_bag_changes_nothing(whole, tmp_path):
    path, originals = whole
    report = repair_bag(path, tmp_path / "new.mcap")
    assert records(tmp_path / "new.mcap") == records(path)
    assert (report.messages, bool(report.losses)) == (len(originals), False)
    with (tmp_path / "new.mcap").open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary.statistics.message_count == len(originals)
    assert summary.chunk_indexes


def test_the_repair_keeps_what_is_whole_and_tells_the_rest(whole, tmp_path):
    path, _ = whole
    hit = chunks(path)[3]

    def wreck(data):
        middle = hit.chunk_start_offset + hit.chunk_length // 2
        data[middle : middle + 64] = bytes(64)
        del data[-20:]

    damaged = changed(path, tmp_path, wreck)
    report = repair_bag(damaged)
    assert report.output == tmp_path / "damaged_repaired.mcap"
    messages, metadata, parts = records(report.output)
    before = records(path)
    assert messages < before[0]
    assert (metadata[:-1], parts) == before[1:]
    assert metadata[-1][0] == "geoprim_repair"
    assert "damaged chunk" in dict(metadata[-1][1])["losses"]
    assert inspect_bag(report.output).exit_code == 0


def test_a_damaged_attachment_is_left_out_and_said(whole, tmp_path):
    path, _ = whole
    where = path.read_bytes().index(b"of no weight")
    damaged = changed(path, tmp_path, lambda data: data.__setitem__(where, 0x4F))
    assert "note.txt: its checksum fails" in inspect_bag(damaged).faults[0]
    report = repair_bag(damaged)
    assert (report.attachments, len(report.faults)) == (0, 1)


def test_a_repair_never_writes_over_its_input(whole, tmp_path):
    path = changed(whole[0], tmp_path, lambda data: data.__delitem__(slice(-9, None)))
    content = path.read_bytes()
    link = tmp_path / "link.mcap"
    link.hardlink_to(path)
    for target in (path, link, tmp_path / "." / "damaged.mcap"):
        with pytest.raises(FileError, match="the bag that is read"):
            repair_bag(path, target, replace=True)
    other = tmp_path / "other.mcap"
    other.write_bytes(b"mine")
    with pytest.raises(FileError, match="exists already"):
        repair_bag(path, other)
    assert (path.read_bytes(), other.read_bytes()) == (content, b"mine")


def test_the_exit_code_tells(whole, tmp_path, capsys):
    path, _ = whole
    cut = changed(path, tmp_path, lambda data: data.__delitem__(slice(len(data) // 2, None)))
    none = tmp_path / "none.mcap"
    none.write_bytes(path.read_bytes()[:120])
    new = str(tmp_path / "new.mcap")
    for words, code in (
        (["info", str(path)], 0),
        (["check", str(path)], 0),
        (["info", str(cut)], 1),
        (["check", str(cut)], 1),
        (["check", str(none)], 2),
        (["repair", str(cut), new], 1),
        (["check", new], 0),
        (["repair", str(none), str(tmp_path / "no.mcap")], 2),
        (["repair", str(path), new], 2),
        (["repair", str(path), new, "--replace"], 0),
    ):
        assert main(["bag", *words]) == code, words
    assert not (tmp_path / "no.mcap").exists()
    said = capsys.readouterr()
    assert "cut off" in said.out
    assert "Traceback" not in said.err


def test_process_tells_of_damage_by_its_exit_code(tmp_path, capsys):
    path = tmp_path / "whole.mcap"
    damage.build(path, 5, CompressionType.ZSTD)
    cut = changed(path, tmp_path, lambda data: data.__delitem__(slice(len(data) // 2, None)))
    words = ["--topic", "camera/image", "--output", str(tmp_path / "out.mcap")]
    assert main(["process", str(cut), *words]) == 1
    assert "cut off" in capsys.readouterr().out
    early = chunks(path)[0]
    cut.write_bytes(path.read_bytes()[: early.chunk_start_offset + 300])
    assert main(["process", str(cut), *words]) == 2
