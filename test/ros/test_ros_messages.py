"""The message definitions speak for themselves, and travel as records say."""

import re
from dataclasses import replace

import numpy as np
import pytest
from geoprim_msgs.msg import Contours as ContoursMessage
from std_msgs.msg import String

from geoprim_core.errors import InputError
from geoprim_core.io.camera_message import camera_from_message
from geoprim_core.io.definitions import message_texts, serialize
from geoprim_core.io.record import Record, header
from geoprim_core.io.wire import from_wire, to_wire
from geoprim_core.types import Contours, Detections, EllipseDetections, Ellipses, Polygons
from geoprim_ros.conversions import check_installed, message_class, to_message

UNITS = ("pixel", "radian", "metre", "no unit", "point", "vertex")
WITHOUT_UNIT = ("header", "method", "label", "closed", "complete", "reason")


def _fields(text):
    for line in text.splitlines():
        found = re.match(r"(\S+)\s+(\w+)\s*(#.*)?$", line)
        if found and not line.startswith("#"):
            yield found.groups()


@pytest.mark.parametrize("name", sorted(message_texts()))
def test_every_message_and_field_says_unit_and_pixel_convention(name):
    text = message_texts()[name]
    nested = "Ellipse ellipse " in text
    assert "top-left pixel" in text or nested
    for kind, field, comment in _fields(text):
        assert comment, f"{field} has no comment"
        if field not in WITHOUT_UNIT:
            assert any(unit in comment for unit in UNITS), f"{kind} {field}: {comment}"


def _contours():
    points = np.array([[3, 4], [4, 5], [5, 5], [9, 9], [8, 9]], float)
    return Contours(points, [0, 3, 5], [True, False], (40, 30), points + 0.25, np.arange(5) * 0.5)


def _found():
    ellipses = Ellipses.from_array([[1.1, 2.2, 9.3, 4.4, 0.5], [5, 6, 3, 3, 0]])
    covariance = np.arange(50.0).reshape(2, 5, 5)
    covariance[1] = np.nan
    return EllipseDetections(
        ellipses, [0.9, 0.8], [0.7, 0.6], [0.5, 0.4], [0.3, 0.2], covariance, (40, 30)
    )


def _values():
    found = _found()
    yield _contours(), {}
    yield Contours(np.zeros((0, 2)), [0], [], (5, 4)), {}
    polygons = Polygons([0, 2, 0, 1], [0, 2, 4], [True, False], (40, 30))
    yield polygons, {"contours": _contours(), "method": "rdp_mod"}
    yield found, {}
    yield replace(found, complete=False, reason="max_pairs = 3: 3 of 9 pairs"), {}
    yield EllipseDetections.empty((7, 8)), {}
    outline = np.array([[0, 0], [1, 0], [1, 1], [5, 5], [6, 5], [6, 6]], float)
    yield (
        Detections(
            ("lid", "cöin"), [0.9, 0.1], np.arange(8.0).reshape(2, 4), found.ellipses,
            outline, [0, 3, 6], [[0.1, 0.05], [np.nan, np.nan]], (40, 30),
        ),
        {},
    )  # fmt: skip


@pytest.mark.parametrize(("value", "options"), list(_values()))
def test_the_ros_message_has_the_bytes_of_the_record(value, options):
    """A live graph and a bag written without ROS carry the same content."""
    from rclpy.serialization import deserialize_message, serialize_message

    record = to_wire(value, 1_500_000_003, "camera", **options)
    message = to_message(record)
    data = serialize_message(message)
    kind = message_class(record.type)
    assert deserialize_message(serialize(record), kind) == deserialize_message(data, kind) or (
        repr(deserialize_message(serialize(record), kind)) == repr(message)  # NaN is not itself
    )
    again = from_wire(deserialize_message(data, kind))
    for name in type(value).__dataclass_fields__:
        was, came = getattr(value, name), getattr(again, name)
        if isinstance(was, Ellipses):
            was, came = was.array(), came.array()
        np.testing.assert_array_equal(came, was, err_msg=name)


def test_image_data_goes_in_as_a_block():
    image = Record(
        "sensor_msgs/msg/Image",
        {"header": header(5, "c"), "height": 1, "width": 3, "encoding": "mono8",
         "is_bigendian": 0, "step": 3, "data": np.array([1, 2, 250], np.uint8)},
    )  # fmt: skip
    message = to_message(image)
    assert message.data.typecode == "B"
    assert bytes(message.data) == b"\x01\x02\xfa"


def test_an_unknown_type_is_said():
    with pytest.raises(ValueError, match="nowhere_msgs/msg/Nothing"):
        message_class("nowhere_msgs/msg/Nothing")


def test_binning_and_region_keep_the_geometry_of_the_camera():
    """A pixel of the binned, cut-out image looks along the ray of the pixels it is made of."""
    from sensor_msgs.msg import CameraInfo

    info = CameraInfo(k=[800.0, 0.0, 319.5, 0.0, 820.0, 239.5, 0.0, 0.0, 1.0])
    plain = camera_from_message(info, 0.5)
    assert (plain.fx, plain.fy, plain.cx, plain.cy) == (800.0, 820.0, 319.5, 239.5)
    info.binning_x = info.binning_y = 2
    info.roi.x_offset, info.roi.y_offset = 100, 40
    binned = camera_from_message(info, 0.5)
    u = 10.0  # made of the columns 120 and 121 of the full image
    assert (u - binned.cx) / binned.fx == pytest.approx((120.5 - plain.cx) / plain.fx)
    v = 7.0  # made of the rows 54 and 55
    assert (v - binned.cy) / binned.fy == pytest.approx((54.5 - plain.cy) / plain.fy)
    info.k = [0.0] * 9
    assert camera_from_message(info, 0.5) is None


def test_messages_of_another_version_are_told_at_the_start():
    """After an update without a new build every frame had ended in a traceback."""

    class Contours(ContoursMessage):
        @classmethod
        def get_fields_and_field_types(cls):
            fields = super().get_fields_and_field_types()
            return {name: kind for name, kind in fields.items() if name != "softness"}

    check_installed(ContoursMessage)
    check_installed(String)
    Contours.__module__ = ContoursMessage.__module__
    with pytest.raises(InputError, match=r"build them again .*Contours that differs in softness"):
        check_installed(Contours)
