"""The demo bag: photographs as their files hold them, sequences with their ground truth."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from geoprim_core.errors import FileError
from geoprim_core.io.bags import BagReader
from geoprim_core.io.camera_message import camera_from_message
from geoprim_core.io.demo_bag import (
    PHOTOGRAPH_FRAMES,
    PHOTOGRAPH_TICKS,
    RATE_HZ,
    SORTING_FRAMES,
    build_demo_bag,
)
from geoprim_core.io.photographs import PHOTOGRAPHS, packaged_photographs
from geoprim_core.io.wire import from_wire
from geoprim_core.synthetic import SORTING_LINES, sorting_sequence


@pytest.fixture(scope="module")
def demo(tmp_path_factory):
    path = tmp_path_factory.mktemp("demo") / "demo.mcap"
    return path, build_demo_bag(path, sorting_frames=2)


def test_stamps_rise_and_the_table_tells_where_sequences_lie(demo):
    path, sequences = demo
    reader = BagReader(path)
    frames = [(f.stamp_ns, f.frame_id) for f in reader.images()]
    for kind, ticks in (("photo", PHOTOGRAPH_TICKS), ("sorting", 1)):
        gaps = np.diff([stamp for stamp, frame_id in frames if frame_id.startswith(kind)])
        np.testing.assert_allclose(gaps, ticks * 1e9 / RATE_HZ, atol=1)  # whole nanoseconds
    table = {k: json.loads(v) for k, v in reader.metadata["sequences"].items()}
    assert list(table) == sorted(table, key=lambda name: table[name]["start_ns"])
    assert [row.name for row in sequences] == list(table)
    for name, row in table.items():
        stamps = [stamp for stamp, frame_id in frames if frame_id == name]
        assert (stamps[0], stamps[-1], len(stamps)) == tuple(
            row[k] for k in ("start_ns", "end_ns", "frames")
        )
        assert row["content"]
        assert row["source"]


def test_photographs_are_those_of_the_files(demo):
    images = packaged_photographs()
    seen = set()
    for frame in BagReader(demo[0]).images():
        kind, _, name = frame.frame_id.partition("_")
        if kind == "photo":
            np.testing.assert_array_equal(frame.image, images[name])
            seen.add(name)
    assert seen == set(PHOTOGRAPHS)


@pytest.mark.parametrize("line", SORTING_LINES)
def test_ground_truth_is_that_of_the_scene(demo, line):
    reader = BagReader(demo[0])
    name = f"sorting_{line}"
    truth = {m.log_time_ns: m.decoded for m in reader.messages(["ground_truth"])}
    infos = {m.log_time_ns: m.decoded for m in reader.messages(["camera_info"])}
    frames = [f for f in reader.images() if f.frame_id == name]
    scenes = sorting_sequence(line, seed=list(SORTING_LINES).index(line), frames=2)
    for frame, scene in zip(frames, scenes, strict=True):
        np.testing.assert_array_equal(frame.image, scene.image)
        objects = from_wire(truth[frame.stamp_ns])
        assert objects.score.sum() == scene.required.sum() > 5
        assert (np.diff(objects.score) <= 0).all()
        required = {kind.label for kind in SORTING_LINES[line].objects}
        for i in np.flatnonzero(objects.score):
            assert objects.labels[i] in required
            kind = next(k for k in SORTING_LINES[line].objects if k.label == objects.labels[i])
            low, high = kind.diameter
            assert low - 1e-6 <= 1000 * objects.size[i, 0] <= high + 1e-6
        camera = camera_from_message(infos[frame.stamp_ns], SORTING_LINES[line].distance)
        assert camera.fx == scene.camera.fx


def test_photographs_have_no_calibrated_camera(demo):
    for message in BagReader(demo[0]).messages(["camera_info"]):
        if message.decoded.header.frame_id.startswith("photo"):
            assert camera_from_message(message.decoded, 1.0) is None


def test_the_readme_lists_every_sequence():
    text = (Path(__file__).resolve().parents[2] / "bags" / "README.md").read_text()
    for name, photograph in PHOTOGRAPHS.items():
        assert f"| `photo_{name}` | `{photograph.file}` | {photograph.source} |" in text
    for line in SORTING_LINES:
        assert f"`sorting_{line}`" in text
    photographs, sorting = re.findall(r"\| (\d+)(?: each) \|", text)
    assert (int(photographs), int(sorting)) == (PHOTOGRAPH_FRAMES, SORTING_FRAMES)
    rates = [RATE_HZ, RATE_HZ // PHOTOGRAPH_TICKS]
    assert list(map(int, re.findall(r"(\d+) Hz", text))) == rates


def test_a_place_that_cannot_be_written_is_refused(tmp_path):
    with pytest.raises(FileError, match="cannot write"):
        build_demo_bag(tmp_path / "none" / "demo.mcap", sorting_frames=1)
