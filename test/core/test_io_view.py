"""The view for Foxglove: where its points are, what its channels are, how it keeps time."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from geoprim_core.applications import SortingParams
from geoprim_core.ecc import DetectorParams, detect_ellipses
from geoprim_core.errors import GeoprimError, InputError, MissingPackageError
from geoprim_core.io import foxglove_view
from geoprim_core.io.annotations import contour_lines, corner_based, ellipse_lines, polygon_lines
from geoprim_core.io.bags import BagReader, BagWriter
from geoprim_core.io.foxglove_view import View, ViewFrame, as_numbers
from geoprim_core.io.image_message import image_record
from geoprim_core.io.images import write_image
from geoprim_core.io.process import Chain
from geoprim_core.io.shown import OverlayParams, to_show
from geoprim_core.io.view_frames import BagFrames, Detector, Replay, Rhythm, image_frames
from geoprim_core.io.wire import to_wire
from geoprim_core.synthetic import disc_image
from geoprim_core.types import Contours, Polygons

LAYOUT = Path(__file__).resolve().parents[2] / "config" / "foxglove_layout.json"
IMAGE = disc_image(160, 120, centre=(70.25, 60.5), radius=35.5)


@pytest.fixture
def found():
    return detect_ellipses(IMAGE)


@pytest.fixture
def frame(found):
    return ViewFrame(IMAGE, to_show(found), 7_000_000_005, "camera")


@pytest.fixture
def view():
    pytest.importorskip("foxglove")
    with View() as view:
        yield view


def test_a_line_lies_on_the_ellipse_half_a_pixel_further(found):
    """Of a pixel whose centre is (0, 0) here, Foxglove says (0.5, 0.5)."""
    (line,) = ellipse_lines(to_show(found), OverlayParams())
    (ellipse,) = found.ellipses
    np.testing.assert_allclose(
        line.points.mean(axis=0), (ellipse.x + 0.5, ellipse.y + 0.5), atol=1e-5
    )
    assert line.closed
    distance = np.hypot(*(line.points - line.points.mean(axis=0)).T)
    assert ellipse.semi_minor - 1e-4 <= distance.min() <= distance.max() < ellipse.semi_major + 1e-4


@given(st.floats(-1e4, 1e4), st.floats(-1e4, 1e4))
def test_the_shift_is_the_same_everywhere(x, y):
    np.testing.assert_array_equal(corner_based(np.array([[x, y]])), [[x + 0.5, y + 0.5]])


def test_contours_and_polygons_are_shifted_too_and_closed_as_they_are():
    points = np.array([[0, 0], [1, 1], [2, 1], [9, 9], [8, 9], [8, 8]], float)
    contours = Contours(points, [0, 3, 6], [False, True])
    lines = contour_lines(contours)
    assert [line.closed for line in lines] == [False, True]
    np.testing.assert_array_equal(np.vstack([line.points for line in lines]), points + 0.5)
    polygons = Polygons([0, 2, 0, 2], [0, 2, 4], [False, True])
    corners = [line.points.tolist() for line in polygon_lines(polygons, contours)]
    assert corners == [[[0.5, 0.5], [2.5, 1.5]], [[9.5, 9.5], [8.5, 8.5]]]
    assert contour_lines(Contours(np.zeros((0, 2)), [0], [])) == []


def test_what_a_viewer_gets_is_what_was_found(view, viewer, annotations_of, frame, found):
    """Over a real connection: the points of the loop are those of the ellipse."""
    seen = viewer(view.serve(port=0))
    seen.look_at("/annotations", "/ellipses", "/image")
    wait_until(view.watched)
    while True:  # the subscriptions come one after the other
        view.show(frame)
        try:
            got = seen.see("/annotations", "/ellipses", "/image", timeout=1.0)
            break
        except TimeoutError:
            continue
    (line,), (text,) = annotations_of(got["/annotations"])
    kind, points, colour = line
    assert kind == 2  # LINE_LOOP
    assert text == f"#0 {found.score[0]:.2f}"
    (expected,) = ellipse_lines(frame.shown, OverlayParams())
    np.testing.assert_allclose(points, expected.points, atol=1e-9)
    np.testing.assert_allclose(colour, expected.colour, atol=1e-6)
    (ellipse,) = found.ellipses
    np.testing.assert_allclose(points.mean(axis=0) - 0.5, (ellipse.x, ellipse.y), atol=1e-5)
    numbers = json.loads(got["/ellipses"])
    assert numbers["count"] == 1
    assert numbers["ellipses"][0]["semi_major"] == pytest.approx(ellipse.semi_major, abs=1e-4)
    assert b"\xff\xd8\xff" in got["/image"]  # the start of a JPEG


def test_the_image_that_a_viewer_gets_can_be_without_loss(annotations_of, viewer, frame):
    pytest.importorskip("foxglove")
    with View("raw") as view:
        seen = viewer(view.serve(port=0))
        seen.look_at("/image")
        wait_until(view.watched)
        view.show(frame)
        data = seen.see("/image")["/image"]
    assert np.repeat(IMAGE[:, :, None], 3, axis=2).tobytes() in data


def wait_until(condition):
    import time

    end = time.monotonic() + 20
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def named_topics(value):
    """Yield every topic that a layout names, in paths and as keys."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from named_topics(key)
            yield from named_topics(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from named_topics(inner)
    elif isinstance(value, str) and value.startswith("/"):
        yield value


def test_every_topic_and_field_of_the_layout_exists(view, frame):
    layout = json.loads(LAYOUT.read_text())
    paths = set(named_topics(layout["configById"]))
    assert {path.partition(".")[0] for path in paths} == set(view.channels)
    numbers = as_numbers(frame)
    for path in paths:
        topic, _, fields = path.partition(".")
        value = numbers if topic == "/ellipses" else None
        for field in filter(None, fields.split(".")):
            assert value is not None, f"only the numbers are known here: {path}"
            value = value[field.removesuffix("[:]")]
            value = value[0] if field.endswith("[:]") else value
        assert not fields or value is not None
    panels = set(layout["configById"])
    assert panels == {p for p in json.dumps(layout["layout"]).split('"') if "!" in p}


def test_the_channels_are_of_the_types_that_the_panels_of_the_layout_take(view):
    layout = json.loads(LAYOUT.read_text())["configById"]
    kinds = {topic: channel.schema_name() for topic, channel in view.channels.items()}
    image = layout["Image!geoprim"]["imageMode"]
    assert kinds[image["imageTopic"]] == "foxglove.CompressedImage"
    assert {kinds[topic] for topic in image["annotations"]} == {"foxglove.ImageAnnotations"}
    diagnostics = layout["DiagnosticStatusPanel!geoprim"]["topicToRender"]
    assert kinds[diagnostics] == "diagnostic_msgs/DiagnosticArray"


def test_numbers_follow_their_schema(frame):
    numbers = as_numbers(frame)
    schema = foxglove_view._ELLIPSES_SCHEMA["properties"]
    assert set(numbers) == set(schema)
    assert set(numbers["ellipses"][0]) == set(schema["ellipses"]["items"]["properties"])
    json.dumps(numbers, allow_nan=False)  # JSON knows no NaN


def test_nothing_is_made_while_nobody_looks(view, frame, monkeypatch):
    monkeypatch.setattr(view, "_ellipses", lambda *_: pytest.fail("made for nobody"))
    view.serve(port=0)
    assert not view.watched()
    view.show(frame)


def test_a_port_that_is_taken_is_refused(view):
    port = view.serve(port=0)
    with View() as other, pytest.raises(GeoprimError, match=f"127.0.0.1:{port}"):
        other.serve(port=port)


def test_an_image_format_that_is_not_known_is_refused():
    with pytest.raises(InputError, match="image_format"):
        View("gif")


def test_without_the_package_it_is_said_what_installs_it(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "foxglove", None)
    with pytest.raises(MissingPackageError, match="pip install foxglove-sdk"):
        View()


@pytest.fixture
def bag(tmp_path):
    path = tmp_path / "small.mcap"
    with BagWriter(path) as writer:
        for k in range(3):
            stamp = 1_000_000_000 + k * 50_000_000
            writer.write("image", image_record(IMAGE, stamp, "camera"), stamp)
        writer.write("image", image_record(IMAGE, 2_000_000_000, "camera"), 2_000_000_000)
    return path


def detector():
    return Detector(Chain(DetectorParams(), SortingParams(), 0.0), OverlayParams())


def test_a_bag_shows_its_frames_at_their_times(bag, found):
    frames = list(BagFrames(BagReader(bag), "image", detector())())
    assert [d.time_ns for d in frames] == [10**9, 1_050_000_000, 1_100_000_000, 2 * 10**9]
    made = frames[0].make()
    np.testing.assert_array_equal(made.shown.ellipses.array(), found.ellipses.array())
    assert made.shown.labels == ("ellipse",)
    assert made.seconds > 0


def test_results_of_another_bag_are_taken_and_not_made_again(bag, tmp_path, found):
    other = tmp_path / "results.mcap"
    half = found.ellipses.array() * (1, 1, 0.5, 0.5, 1)
    changed = to_show(found)
    assert len(changed) == 1
    smaller = type(found)(
        type(found.ellipses).from_array(half), found.score, found.coverage, found.alignment,
        found.continuity, found.covariance, found.image_size,
    )  # fmt: skip
    with BagWriter(other) as writer:
        writer.write("ellipses", to_wire(smaller, 10**9, "camera"), 10**9)
    frames = list(BagFrames(BagReader(bag), "image", detector(), BagReader(other))())
    np.testing.assert_allclose(frames[0].make().shown.ellipses.array(), half)
    np.testing.assert_array_equal(frames[1].make().shown.ellipses.array(), found.ellipses.array())


def test_a_file_for_foxglove_holds_every_frame_at_its_time(view, bag, tmp_path, annotations_of):
    path = tmp_path / "view.mcap"
    view.write_to(path)
    replay = Replay(view)
    replay.play(BagFrames(BagReader(bag), "image", detector())())
    view.close()
    assert (replay.shown, replay.bad) == (4, 0)
    reader = BagReader(path)
    counts = {topic.name: topic.count for topic in reader.topics()}
    assert counts == dict.fromkeys(view.channels, 4)
    times = [m.log_time_ns for m in reader.messages(["/annotations"])]
    assert times == [10**9, 1_050_000_000, 1_100_000_000, 2 * 10**9]
    message = next(iter(reader.messages(["/annotations"])))
    (line,), _ = annotations_of(message.raw)
    assert abs(line[1].mean(axis=0) - (70.75, 61.0)).max() < 0.1  # the rim, from the corner


def test_a_bad_image_is_counted_and_the_others_are_shown(view, tmp_path):
    good, bad = tmp_path / "b.png", tmp_path / "a.png"
    write_image(good, IMAGE)
    bad.write_bytes(b"no image")
    view.write_to(tmp_path / "view.mcap")
    replay = Replay(view)
    replay.play(image_frames([bad, good], detector(), 2.0))
    assert (replay.shown, replay.bad) == (1, 1)
    assert "a.png" in replay.last_reason


@given(
    st.lists(st.integers(0, 10**9), min_size=2, max_size=20),
    st.floats(0.1, 10.0),
    st.lists(st.floats(0, 0.5), min_size=20, max_size=20),
)
def test_frames_are_never_early_and_never_closer_than_they_were(times, rate, work):
    """However long the work takes; a step back in time, as at a new round, does not wait."""
    now = [0.0]
    rhythm = Rhythm(rate, clock=lambda: now[0], sleep=lambda s: now.__setitem__(0, now[0] + s))
    shown = []
    for time_ns, seconds in zip(times, work, strict=False):
        rhythm.wait_for(time_ns)
        shown.append(now[0])
        now[0] += seconds
    for k in range(1, len(times)):
        gap = max(0, times[k] - times[k - 1]) * 1e-9 / rate
        assert shown[k] - shown[k - 1] >= gap - 1e-9
        assert shown[k] - shown[k - 1] <= max(gap, work[k - 1]) + 1e-9
