"""Processing a bag: the same as calling the stages by hand, frame by frame."""

import numpy as np
import pytest

from geoprim_core.applications import ClassParams, SortingParams, classify
from geoprim_core.ecc import DetectorParams, detect_ellipses, detect_from_contours
from geoprim_core.edges import extract_contours
from geoprim_core.errors import BagError, FileError
from geoprim_core.io.bags import BagReader, BagWriter
from geoprim_core.io.camera_message import camera_from_message, camera_record
from geoprim_core.io.image_message import image_record
from geoprim_core.io.images import read_image
from geoprim_core.io.process import process_bag
from geoprim_core.io.record import header, stamp_of
from geoprim_core.io.wire import from_wire
from geoprim_core.polygon import approximate
from geoprim_core.synthetic import disc_image, thesis_image
from geoprim_core.types import Camera, Ellipses

CAMERA = Camera(fx=500.0, fy=500.0, cx=79.5, cy=59.5, distance=0.5)  # a pixel a millimetre
RADII = {"left": (20.0, 26.5), "right/front": (32.25,)}
TOPICS = ("contours", "polygons", "ellipses", "detections")


def frames():
    for sequence, radii in RADII.items():
        for radius in radii:
            yield sequence, disc_image(160, 120, centre=(80.4, 59.7), radius=radius)


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    path = tmp_path_factory.mktemp("process") / "in.mcap"
    with BagWriter(path) as bag:
        bag.add_metadata("sequences", {"left": "discs"})
        for i, (sequence, image) in enumerate(frames()):
            bag.write("/cam/camera_info", camera_record(CAMERA, (160, 120), i + 1, sequence))
            bag.write("/cam/image", image_record(image, i + 1, sequence), log_time_ns=i + 100)
            bag.write("/ground_truth", header(i + 1, sequence), log_time_ns=i + 101)
            bag.write("/unrelated", header(i + 1, sequence), log_time_ns=i + 101)
    return path


@pytest.fixture(scope="module")
def processed(source, tmp_path_factory):
    folder = tmp_path_factory.mktemp("out")
    sorting = SortingParams({"disc": ClassParams(unit="mm", min_length=50.0)}, other="small")
    report = process_bag(
        source,
        folder / "out.mcap",
        overlays=folder / "overlays",
        sorting=sorting,
        plane_distance=0.5,
        topic="cam/image",
    )
    return report, sorting


def test_messages_equal_direct_calls_field_by_field(processed):
    report, sorting = processed
    messages = {t: [] for t in TOPICS}
    for message in BagReader(report.output).messages(TOPICS):
        messages[message.topic].append(message)
    params = DetectorParams()
    for i, (sequence, image) in enumerate(frames()):
        contours = extract_contours(image, params.edges)
        polygons = approximate(contours, method="rdp_mod", params=params.polygon.rdp_mod)
        ellipses = detect_from_contours(contours, polygons, params.ecc)
        objects = classify(ellipses, sorting, CAMERA)
        for topic, value in zip(TOPICS, (contours, polygons, ellipses, objects), strict=True):
            message = messages[topic][i]
            assert message.log_time_ns == i + 100
            assert stamp_of(message.decoded) == i + 1
            assert message.decoded.header.frame_id == sequence
            assert_same(from_wire(message.decoded), value)
        vertices = messages["polygons"][i].decoded.vertices.reshape(-1, 2)
        np.testing.assert_array_equal(vertices, polygons.vertices(contours))
        assert messages["polygons"][i].decoded.method == "rdp_mod"


def assert_same(first, second):
    assert type(first) is type(second)
    for name in type(first).__dataclass_fields__:
        a, b = getattr(first, name), getattr(second, name)
        if isinstance(a, Ellipses):
            a, b = a.array(), b.array()
        np.testing.assert_array_equal(a, b, err_msg=name)


def test_a_live_graph_that_passes_messages_on_computes_the_same(processed):
    """Each stage of the graph sees what came through float32: nothing is lost on the way."""
    report, _ = processed
    stored = {t: [m.decoded for m in BagReader(report.output).messages([t])] for t in TOPICS}
    for contours, polygons, ellipses in zip(*(stored[t] for t in TOPICS[:3]), strict=True):
        again = detect_from_contours(from_wire(contours), from_wire(polygons))
        assert_same(again, from_wire(ellipses))


def test_the_discs_are_found_labelled_and_measured(processed):
    report, _ = processed
    for message, (_, image), radius in zip(
        BagReader(report.output).messages(["detections"]),
        frames(),
        (20.0, 26.5, 32.25),
        strict=True,
    ):
        best = message.decoded.detections[0]
        assert best.label == ("disc" if radius > 25 else "small")
        assert best.length == pytest.approx(2e-3 * radius, abs=5e-4)
        assert len(detect_ellipses(image)) == len(message.decoded.detections)


def test_the_report_counts_every_sequence(processed):
    report, _ = processed
    assert [(s.name, s.frames, s.bad) for s in report.sequences] == [
        ("left", 2, 0),
        ("right/front", 1, 0),
    ]
    assert dict(report.sequences[1].objects) == {"disc": report.sequences[1].ellipses}
    assert report.frames == 3
    assert not report.losses
    table = report.table().splitlines()
    assert table[1].split()[:3] == ["left", "2", "0"]


def test_ground_truth_cameras_and_metadata_are_copied_and_nothing_else(processed, source):
    report, _ = processed
    before, after = BagReader(source), BagReader(report.output)
    assert {t.name for t in after.topics()} == {*TOPICS, "/ground_truth", "/cam/camera_info"}
    for topic in ("/ground_truth", "/cam/camera_info"):
        kept = [(m.raw, m.log_time_ns, m.definition) for m in after.messages([topic])]
        assert kept == [(m.raw, m.log_time_ns, m.definition) for m in before.messages([topic])]
    assert after.metadata["sequences"] == {"left": "discs"}
    assert after.metadata["geoprim_process"]["plane_distance"] == "0.5"


def test_overlays_show_the_frames_of_their_sequence(processed):
    report, _ = processed
    names = [p.name for p in report.overlays]
    assert names == ["left_00000.png", "left_00001.png", "right_front_00000.png"]
    for path, (_, image) in zip(report.overlays, frames(), strict=True):
        overlay = read_image(path)
        assert overlay.shape == (480, 640, 3)  # letters have the size of VGA
        unlike = (overlay != image.repeat(4, axis=0).repeat(4, axis=1)[:, :, None]).any(axis=2)
        assert 0.005 < unlike.mean() < 0.2


def test_only_the_first_frame_of_each_sequence_is_drawn_on_request(source, tmp_path):
    report = process_bag(
        source, tmp_path / "out.mcap", overlays=tmp_path / "o", overlay_every=0, topic="/cam/image"
    )
    names = sorted(p.name for p in (tmp_path / "o").iterdir())
    assert names == ["left_00000.png", "right_front_00000.png"]
    assert len(report.overlays) == 2


def test_bad_frames_are_counted_with_their_reason_and_do_not_end_the_run(tmp_path):
    disc = disc_image(160, 120, centre=(80, 60), radius=30)
    holes = disc.astype(np.float32)
    holes[5, 5] = np.nan
    good = image_record(disc, 1, "camera")
    with BagWriter(tmp_path / "in.mcap") as bag:
        bag.write("image", good)
        bag.write("image", image_record(holes, 2, "camera"))
        broken = image_record(disc, 3, "camera")
        broken.fields["step"] = 3
        bag.write("image", broken)
        bag.write_raw("image", good.type, b"\0\1\0\0\7", 4)
        bag.write("image", image_record(disc, 5, "camera"))
    report = process_bag(tmp_path / "in.mcap", tmp_path / "out.mcap")
    assert [(s.name, s.frames, s.bad) for s in report.sequences] == [("camera", 2, 2), ("", 0, 1)]
    reasons = {bad.stamp_ns: bad.reason for bad in report.bad_frames}
    assert set(reasons) == {2, 3, 4}
    assert "NaN" in reasons[2]
    assert "step" in reasons[3]
    assert "cannot be decoded" in reasons[4]
    assert "bad frames" in report.table()
    out = BagReader(tmp_path / "out.mcap")
    assert [stamp_of(m.decoded) for m in out.messages(["ellipses"])] == [1, 5]


def test_frames_that_a_bound_cut_short_say_so_in_the_bag_and_in_the_report(tmp_path):
    busy = thesis_image(8, seed=3, kind="overlapping").image
    with BagWriter(tmp_path / "in.mcap") as bag:
        bag.write("image", image_record(busy, 1, "camera"))
        bag.write("image", image_record(np.zeros_like(busy), 2, "camera"))
    params = DetectorParams().updated({"ecc.refined.max_candidates": 2})
    report = process_bag(tmp_path / "in.mcap", tmp_path / "out.mcap", params=params)
    assert report.sequences[0].cut_short == 1
    assert "1 frame is incomplete" in report.table()
    first, second = BagReader(tmp_path / "out.mcap").messages(["ellipses"])
    expected = detect_ellipses(busy, params)
    found = from_wire(first.decoded)
    assert (found.complete, found.reason) == (expected.complete, expected.reason)
    assert expected.reason.startswith("max_candidates = 2: ")
    assert from_wire(second.decoded).complete


def test_objects_in_millimetres_without_a_camera_are_not_sorted(tmp_path):
    with BagWriter(tmp_path / "in.mcap") as bag:
        disc = disc_image(160, 120, centre=(80, 60), radius=30)
        bag.write("image", image_record(disc, 1, "camera"))
        bag.write("camera_info", camera_record(None, (160, 120), 1, "camera"))
    sorting = SortingParams({"disc": ClassParams(unit="mm")})
    report = process_bag(
        tmp_path / "in.mcap", tmp_path / "out.mcap", sorting=sorting, plane_distance=0.5
    )
    assert report.sequences[0].unsorted == 1
    assert "camera unknown" in report.table()
    out = BagReader(tmp_path / "out.mcap")
    (objects,) = out.messages(["detections"])
    (ellipses,) = out.messages(["ellipses"])
    assert len(objects.decoded.detections) == 0
    assert len(ellipses.decoded.detections) > 0


def test_a_truncated_bag_is_processed_as_far_as_it_goes(tmp_path):
    disc = disc_image(160, 120, centre=(80, 60), radius=30)
    with BagWriter(tmp_path / "in.mcap", chunk_bytes=1) as bag:
        for i in range(4):
            bag.write("image", image_record(disc, i, "camera"))
    data = (tmp_path / "in.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(data[: len(data) // 2])
    report = process_bag(tmp_path / "cut.mcap", tmp_path / "out.mcap")
    assert 1 <= report.frames <= 3
    assert "cut off" in str(report.losses)
    assert "input: " in report.table()
    assert "bytes are damaged or lost" in report.table()


def test_wrong_topics_and_places_are_refused(source, tmp_path):
    with pytest.raises(BagError, match=r"no topic 'image'.*/cam/image"):
        process_bag(source, tmp_path / "out.mcap")
    with pytest.raises(BagError, match="unrelated holds"):
        process_bag(source, tmp_path / "out.mcap", topic="unrelated")
    with pytest.raises(FileError, match="the bag that is read"):
        process_bag(source, source, topic="cam/image")
    with pytest.raises(FileError, match="cannot write"):
        process_bag(source, tmp_path / "none" / "out.mcap", topic="cam/image")
    (tmp_path / "file").touch()
    with pytest.raises(FileError, match="cannot write"):
        process_bag(
            source, tmp_path / "out.mcap", topic="cam/image", overlays=tmp_path / "file" / "x"
        )
    assert not (tmp_path / "out.mcap").exists()


def test_a_camera_survives_its_message():
    info = camera_record(CAMERA, (160, 120), 0, "camera")
    assert vars_of(camera_from_message(info, 0.5)) == vars_of(CAMERA)
    assert camera_from_message(camera_record(None, (160, 120), 0, "camera"), 0.5) is None


def test_binning_and_region_of_interest_move_the_camera():
    """A point of the plane is seen at the pixel that binning and cropping put it."""
    info = camera_record(CAMERA, (160, 120), 0, "camera")
    info.fields.update(binning_x=2, binning_y=2)
    info.roi.fields.update(x_offset=10, y_offset=20)
    camera = camera_from_message(info, 0.5)
    point = np.array([0.013, -0.007])
    full = CAMERA.cx + CAMERA.fx * point[0] / 0.5, CAMERA.cy + CAMERA.fy * point[1] / 0.5
    corner = (full[0] + 0.5 - 10) / 2, (full[1] + 0.5 - 20) / 2  # from the image's corner
    seen = camera.cx + camera.fx * point[0] / 0.5, camera.cy + camera.fy * point[1] / 0.5
    np.testing.assert_allclose(seen, np.array(corner) - 0.5)


def vars_of(camera):
    return [getattr(camera, name) for name in ("fx", "fy", "cx", "cy", "distance")]
