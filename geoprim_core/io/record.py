"""Records: the fields of a message as plain values, whatever library sends or stores them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, eq=False)
class Record:
    """The fields of one message, each in the type that the wire asks for.

    Attributes
    ----------
    type : str
        Full name of the message type, "geoprim_msgs/msg/Contours".
    fields : dict
        Field name -> int, float, str, flat numpy array, `Record` or list of `Record`. A field
        can also be read as an attribute.
    """

    type: str
    fields: dict[str, Any]

    def __getattr__(self, name: str) -> Any:
        """Return a field of the message."""
        if name.startswith("__") or name not in self.fields:
            raise AttributeError(f"{self.type} has no field {name!r}")
        return self.fields[name]


def header(stamp_ns: int, frame_id: str) -> Record:
    """Return a std_msgs/msg/Header with a stamp in nanoseconds."""
    sec, nanosec = divmod(int(stamp_ns), 1_000_000_000)
    stamp = Record("builtin_interfaces/msg/Time", {"sec": sec, "nanosec": nanosec})
    return Record("std_msgs/msg/Header", {"stamp": stamp, "frame_id": str(frame_id)})


def stamp_of(message: Any) -> int:
    """Return the stamp of a message's header in nanoseconds."""
    stamp = message.header.stamp
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


def type_name(message: Any) -> str:
    """Return the full type name of a message as far as it can be told, else its class name.

    Examples
    --------
    >>> type_name(header(0, "camera"))
    'std_msgs/msg/Header'
    """
    if isinstance(message, Record):
        return message.type
    declared = getattr(message, "__msgtype__", None)  # decoded by rosbags
    if isinstance(declared, str):
        return declared
    kind = type(message)
    package, _, rest = kind.__module__.partition(".msg.")  # a ROS class: package.msg._contours
    return f"{package}/msg/{kind.__name__}" if rest else kind.__name__
