"""Core types to message fields and back."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError
from geoprim_core.io.definitions import message_texts, serialize, typestore
from geoprim_core.io.record import Record, header, stamp_of, type_name
from geoprim_core.io.wire import from_wire, to_wire
from geoprim_core.types import Contours, Detections, EllipseDetections, Ellipses, Polygons

STAMP = 1_700_000_000_123_456_789


def assert_same(first, second):
    """Assert that two core values have the same fields, NaN at the same places."""
    assert type(first) is type(second)
    for name in type(first).__dataclass_fields__:
        a, b = getattr(first, name), getattr(second, name)
        if isinstance(a, Ellipses):
            np.testing.assert_array_equal(a.array(), b.array())
        elif isinstance(a, np.ndarray):
            assert a.dtype == b.dtype
            np.testing.assert_array_equal(a, b)
        else:
            assert a == b or (a != a and b != b)


def through_cdr(record):
    """Return the record as a bag reader decodes it."""
    return typestore().deserialize_cdr(serialize(record), record.type)


lengths = st.lists(st.integers(1, 12), max_size=6)
seeds = st.integers(0, 2**32 - 1)


@st.composite
def contours(draw):
    counts = draw(lengths)
    random = np.random.default_rng(draw(seeds))
    total = sum(counts)
    points = random.integers(0, 8192, (total, 2)).astype(float)
    subpixel, angle = None, None
    if total and draw(st.booleans()):
        subpixel = points + random.integers(-128, 129, (total, 2)) / 256
    if total and draw(st.booleans()):
        angle = random.uniform(-np.pi, np.pi, total).astype(np.float32).astype(float)
    return Contours(
        points,
        np.cumsum([0, *counts]),
        random.random(len(counts)) < 0.5,
        draw(st.sampled_from([None, (640, 480)])),
        subpixel,
        angle,
        draw(st.sampled_from([float("nan"), 0.0, 0.7])),
    )


@st.composite
def ellipses(draw):
    count = draw(st.integers(0, 5))
    random = np.random.default_rng(draw(seeds))
    major = random.uniform(1, 500, count)
    minor = major * random.uniform(0.01, 1, count)
    centre = random.uniform(-100, 900, (2, count))
    return Ellipses(*centre, major, minor, random.uniform(0, 3.14, count)), random


@given(contours())
@settings(max_examples=40, deadline=None)
def test_contours_come_back_as_they_were_sent(value):
    record = to_wire(value, STAMP, "camera")
    assert_same(from_wire(record), value)
    assert_same(from_wire(through_cdr(record)), value)


@given(contours(), st.data())
@settings(max_examples=30, deadline=None)
def test_polygons_come_back_and_carry_their_vertices(value, data):
    counts = np.diff(value.offsets)
    chosen = [np.flatnonzero(np.arange(n) % data.draw(st.integers(1, 3)) == 0) for n in counts]
    polygons = Polygons(
        np.concatenate([np.zeros(0, int), *chosen]),
        np.cumsum([0, *map(len, chosen)]),
        value.closed,
        value.image_size,
    )
    record = to_wire(polygons, STAMP, "camera", contours=value, method="rdp_mod")
    message = through_cdr(record)
    assert message.method == "rdp_mod"
    np.testing.assert_array_equal(message.vertices.reshape(-1, 2), polygons.vertices(value))
    assert_same(from_wire(message), polygons)


@given(ellipses(), st.booleans(), st.sampled_from([(True, ""), (False, ""), (False, "x = 3")]))
@settings(max_examples=30, deadline=None)
def test_ellipse_detections_come_back(drawn, known, bound):
    found, random = drawn
    count = len(found)
    covariance = random.normal(size=(count, 5, 5)) if known else np.full((count, 5, 5), np.nan)
    value = EllipseDetections(found, *random.random((4, count)), covariance, (640, 480), *bound)
    record = to_wire(value, STAMP, "camera")
    assert_same(from_wire(record), value)
    assert_same(from_wire(through_cdr(record)), value)


@given(ellipses(), st.booleans())
@settings(max_examples=30, deadline=None)
def test_detections_come_back(drawn, sized):
    found, random = drawn
    count = len(found)
    corners = random.integers(0, 9, count)
    outline = random.normal(size=(corners.sum(), 2)).astype(np.float32).astype(float)
    value = Detections(
        labels=tuple(f"klasse_ä{i}" for i in range(count)),
        score=random.random(count),
        boxes=random.normal(size=(count, 4)),
        ellipses=found,
        polygons=outline,
        polygon_offsets=np.cumsum([0, *corners]),
        size=random.random((count, 2)) if sized else None,
        image_size=None,
    )
    record = to_wire(value, STAMP, "camera")
    assert_same(from_wire(record), value)
    assert_same(from_wire(through_cdr(record)), value)


def square():
    points = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    return Contours(points, [0, 4], [True], (4, 4), points + 0.25, np.arange(4) / 4, 0.7)


def test_arrays_have_the_types_of_the_definition():
    fields = to_wire(square(), STAMP, "camera").fields
    kinds = {name: v.dtype for name, v in fields.items() if isinstance(v, np.ndarray)}
    assert kinds == {
        "points": np.float32,
        "offsets": np.uint32,
        "closed": np.uint8,
        "subpixel": np.float32,
        "gradient_angle": np.float32,
        "gradient_magnitude": np.float32,
    }


@pytest.mark.parametrize("name", ["Contours", "Polygons", "EllipseDetections", "Detections"])
def test_records_have_the_fields_of_the_definition_in_its_order(name):
    contours_ = square()
    corners = Polygons([0, 2], [0, 2], [True], (4, 4))
    none = EllipseDetections.empty((4, 4))
    objects = Detections((), np.zeros(0), np.zeros((0, 4)), none.ellipses)
    value = {
        "Contours": contours_,
        "Polygons": corners,
        "EllipseDetections": none,
        "Detections": objects,
    }
    record = to_wire(value[name], STAMP, "camera", contours=contours_)
    declared = [
        line.split("#")[0].split()[1]
        for line in message_texts()[record.type].splitlines()
        if line.split("#")[0].strip()
    ]
    assert list(record.fields) == declared


def test_the_header_is_that_of_the_image():
    record = to_wire(square(), STAMP, "camera/left")
    assert (record.header.stamp.sec, record.header.stamp.nanosec) == divmod(STAMP, 10**9)
    assert stamp_of(through_cdr(record)) == STAMP
    assert record.header.frame_id == "camera/left"


def test_the_type_of_a_ros_class_is_read_from_its_module():
    kind = type("Contours", (), {"__module__": "geoprim_msgs.msg._contours"})
    assert type_name(kind()) == "geoprim_msgs/msg/Contours"


def changed(**fields):
    record = to_wire(square(), STAMP, "camera")
    return Record(record.type, record.fields | fields)


@pytest.mark.parametrize(
    ("field", "value", "text"),
    [
        ("points", np.zeros(7, np.float32), "Contours.points.*even.*7"),
        ("points", np.zeros(6, np.float32), "Contours.offsets.*end at 3"),
        ("points", np.full(8, np.nan, np.float32), "Contours.points.*finite"),
        ("offsets", np.zeros(0, np.uint32), "Contours.offsets.*no offsets"),
        ("offsets", np.array([1, 4], np.uint32), "Contours.offsets.*start at 0"),
        ("offsets", np.array([0, 4, 2, 4], np.uint32), "Contours.offsets.*never decrease"),
        ("closed", np.zeros(3, np.uint8), "Contours.closed.*1 flags"),
        ("subpixel", np.zeros(6, np.float32), "Contours.subpixel"),
        ("gradient_angle", np.zeros(3, np.float32), "Contours.gradient_angle"),
        ("image_height", 0, "Contours.image_size"),
    ],
)
def test_arrays_that_contradict_each_other_are_refused(field, value, text):
    with pytest.raises(InputError, match=text):
        from_wire(changed(**{field: value}))


def test_polygons_with_another_number_of_vertices_are_refused():
    polygons = Polygons([0, 2], [0, 2], [True])
    record = to_wire(polygons, STAMP, "camera", contours=square())
    shorter = Record(record.type, record.fields | {"vertices": np.zeros(2, np.float32)})
    with pytest.raises(InputError, match=r"Polygons.vertices.*2 vertices.*1"):
        from_wire(shorter)


ROW = {"x": 0.0, "y": 0.0, "semi_major": 1.0, "semi_minor": 2.0, "angle": 0.0}


def test_an_impossible_ellipse_is_refused():
    ellipse = Record("geoprim_msgs/msg/Ellipse", ROW)
    evidence = {"score": 1.0, "coverage": 1.0, "alignment": 1.0, "continuity": 1.0}
    detection = Record(
        "EllipseDetection", {"ellipse": ellipse, "covariance": [0.0] * 25, **evidence}
    )
    fields = {"header": header(0, ""), "image_width": 9, "image_height": 9}
    fields |= {"complete": True, "reason": ""}
    message = Record("geoprim_msgs/msg/EllipseDetections", {**fields, "detections": [detection]})
    with pytest.raises(InputError, match=r"semi_major >= semi_minor"):
        from_wire(message)


def test_other_messages_and_missing_fields_are_refused():
    with pytest.raises(InputError, match=r"geoprim_msgs/msg/Contours.*std_msgs/msg/Header"):
        from_wire(header(0, "camera"))
    with pytest.raises(InputError, match=r"value.*Contours"):
        to_wire("contours", 0, "camera")
    with pytest.raises(InputError, match=r"contours.*None"):
        to_wire(Polygons([0, 1], [0, 2], [False]), 0, "camera")
    message = SimpleNamespace(__msgtype__="geoprim_msgs/msg/Contours", points=[])
    with pytest.raises(InputError, match=r"all fields.*subpixel"):
        from_wire(message)


def test_contours_of_a_recording_from_before_softness_and_magnitudes_are_read():
    known = {"blur": 0.6, "softness": 1.1, "gradient_magnitude": [3.0, 4.0]}
    record = to_wire(Contours([[1, 1], [2, 1]], [0, 2], [False], **known), STAMP, "camera")
    assert from_wire(record).softness == 1.1
    assert from_wire(record).gradient_magnitude.tolist() == [3.0, 4.0]
    later = "softness", "gradient_magnitude"
    older = {name: value for name, value in record.fields.items() if name not in later}
    read = from_wire(Record(record.type, older))
    assert np.isnan(read.softness)
    assert read.gradient_magnitude is None
