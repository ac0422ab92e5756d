"""Between records of the core and ROS messages, without knowing any message by name."""

from __future__ import annotations

import array
import sys
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np

from geoprim_core._check import AnyArray
from geoprim_core.errors import InputError
from geoprim_core.io.definitions import field_names, message_texts
from geoprim_core.io.image_message import image_to_fields
from geoprim_core.io.record import Record, stamp_of
from geoprim_core.io.wire import Wired, to_wire
from geoprim_core.types import Contours

# numpy kind and size -> array.array type code, as the message classes use them
_CODES = {
    "u1": "B", "i1": "b", "u2": "H", "i2": "h", "u4": "I", "i4": "i", "u8": "Q", "i8": "q",
    "f4": "f", "f8": "d",
}  # fmt: skip


@cache
def message_class(type_name: str) -> Any:
    """Return the class of a message type.

    Parameters
    ----------
    type_name : str
        Full name, "geoprim_msgs/msg/Contours".

    Raises
    ------
    InputError
        The type is unknown here: its package is not installed or does not have it.
    """
    try:
        package, kind, name = type_name.split("/")
        return getattr(import_module(f"{package}.{kind}"), name)
    except (ValueError, ImportError, AttributeError):
        expected = "a message type whose package is installed"
        raise InputError("type_name", expected, repr(type_name)) from None


def check_installed(kind: Any) -> None:
    """Raise where a message class of ours was not built from the definitions of this version.

    Raises
    ------
    InputError
        After an update of the sources alone: the text says what to do.
    """
    name = f"{kind.__module__.partition('.')[0]}/msg/{kind.__name__}"
    text = message_texts().get(name)
    if text is None:
        return
    differ = set(field_names(name, text)).symmetric_difference(kind.get_fields_and_field_types())
    if differ:
        expected = "the messages of this version; build them again (./run setup, or colcon build)"
        got = f"a {kind.__name__} that differs in {', '.join(sorted(differ))}"
        raise InputError("geoprim_msgs", expected, got)


def to_message(record: Record) -> Any:
    """Return the ROS message that holds the fields of a record.

    Arrays go in through `array.array` and bytes: a message copies those as a block, and a numpy
    array value by value.
    """
    kind = message_class(record.type)
    message = kind()
    fixed = _fixed_arrays(kind)
    for name, value in record.fields.items():
        setattr(message, name, value if name in fixed else _field(value))
    return message


def core_message(
    value: Wired, source: Any, *, contours: Contours | None = None, method: str = ""
) -> Any:
    """Return the ROS message of a core value, with the header of the message it was made from."""
    frame_id = str(source.header.frame_id)
    record = to_wire(value, stamp_of(source), frame_id, contours=contours, method=method)
    return to_message(record)


def image_to_message(image: AnyArray, source: Any, encoding: str | None = None) -> Any:
    """Return the sensor_msgs/msg/Image of an image, with the header of another message."""
    message = to_message(Record("sensor_msgs/msg/Image", image_to_fields(image, encoding)))
    message.header = source.header
    return message


@cache
def _fixed_arrays(kind: Any) -> frozenset[str]:
    """Return the fields that are numpy arrays of fixed length in the message class itself."""
    fields = kind.get_fields_and_field_types()
    return frozenset(name for name, text in fields.items() if text.endswith("]"))


def _field(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return _flat(value)
    if isinstance(value, Record):
        return to_message(value)
    if isinstance(value, list):
        return [_field(v) for v in value]
    return value


def _flat(values: AnyArray) -> array.array[Any]:
    kind = values.dtype.newbyteorder("=" if values.dtype.isnative else sys.byteorder)
    native = np.ascontiguousarray(values, dtype=kind)
    flat: array.array[Any] = array.array(_CODES[kind.str[1:]])
    flat.frombytes(native.reshape(-1).view(np.uint8).data)
    return flat
