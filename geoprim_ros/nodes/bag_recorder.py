"""Node `bag_recorder`: writes topics into an MCAP bag, as raw bytes, nothing decoded."""

from __future__ import annotations

import argparse
import struct
import sys
import time
from collections.abc import Sequence
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos_overriding_options import QoSOverridingOptions

from geoprim_core.errors import FileError, InputError
from geoprim_core.io.bags import IMAGE_TYPES, BagWriter
from geoprim_ros.conversions import message_class
from geoprim_ros.spin import run, split_ros_args
from geoprim_ros.stage_node import result_qos, sensor_qos

RESULTS = ("contours", "polygons", "ellipses", "detections")
IMAGES = ("image", "camera_info")
_TYPES = {
    "contours": "geoprim_msgs/msg/Contours",
    "polygons": "geoprim_msgs/msg/Polygons",
    "ellipses": "geoprim_msgs/msg/EllipseDetections",
    "detections": "geoprim_msgs/msg/Detections",
    "image": "sensor_msgs/msg/Image",
    "overlay": "sensor_msgs/msg/Image",
    "camera_info": "sensor_msgs/msg/CameraInfo",
}
_SENSOR_TYPES = (*IMAGE_TYPES, "sensor_msgs/msg/CameraInfo")
_DEPTH = 100
_SEARCH_PERIOD_S = 0.5
_IDLE_PERIOD_S = 0.1
_DIAGNOSTICS_PERIOD_S = 1.0


class BagRecorder(Node):  # type: ignore[misc]
    """Writes every message under its stamp; the bag is complete when the node is destroyed.

    Parameters
    ----------
    path : the .mcap file
    topics : names; the type of one that is not geoprim's is looked up in the graph
    idle_limit_s : end the process when nothing came for so long after the first message, 0: never

    Raises
    ------
    FileError
        The file cannot be written.
    """

    def __init__(
        self,
        path: str,
        topics: Sequence[str] = RESULTS,
        idle_limit_s: float = 0.0,
        **options: Any,
    ) -> None:
        super().__init__("bag_recorder", **options)
        self.count = 0
        self._bag = BagWriter(path)
        self._idle_limit_s = idle_limit_s
        self._last = 0.0
        self._unknown = set(topics)
        self._met: dict[str, int] = {}
        self._diagnostics = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self.create_timer(_DIAGNOSTICS_PERIOD_S, self._publish_diagnostics)
        self._connect()
        if self._unknown:
            self.create_timer(_SEARCH_PERIOD_S, self._connect)
        if idle_limit_s > 0:
            self.create_timer(_IDLE_PERIOD_S, self._end_when_idle)

    def close(self) -> None:
        """Finish the bag."""
        try:
            self._bag.close()
        except FileError as problem:
            self.get_logger().error(str(problem))

    def destroy_node(self) -> None:
        """Finish the bag, where that is not done, and take the node down."""
        self.close()
        super().destroy_node()

    def _connect(self) -> None:
        """Subscribe to the topics whose type is known by now."""
        present = dict(self.get_topic_names_and_types()) if self._unknown else {}
        for topic in sorted(self._unknown):
            found = present.get(self.resolve_topic_name(topic), [])
            kind = _TYPES.get(topic.rpartition("/")[2]) or (found[0] if found else None)
            if kind is not None:
                self._unknown.discard(topic)
                self._subscribe(topic, kind)

    def _subscribe(self, topic: str, type_name: str) -> None:
        name = self.resolve_topic_name(topic)
        try:
            kind = message_class(type_name)
        except InputError as problem:
            self.get_logger().warning(f"topic {name} is not recorded: {problem}")
            return
        first = next(iter(kind.get_fields_and_field_types().values()), "")
        stamped = first == "std_msgs/Header"
        qos = sensor_qos(_DEPTH) if type_name in _SENSOR_TYPES else result_qos(_DEPTH)
        self._met[name] = 0
        self.create_subscription(
            kind, topic, lambda data: self._write(name, type_name, data, stamped), qos, raw=True,
            event_callbacks=SubscriptionEventCallbacks(matched=lambda m: self._matched(name, m)),
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )  # fmt: skip

    def _matched(self, name: str, event: Any) -> None:
        self._met[name] = event.current_count
        self._publish_diagnostics()

    def _publish_diagnostics(self) -> None:
        """Tell how many messages were written and how many publishers each topic has."""
        name = f"{self.get_fully_qualified_name().lstrip('/')}: bag"
        status = DiagnosticStatus(level=DiagnosticStatus.OK, name=name, hardware_id="none")
        counts = {"messages": self.count}
        counts |= {f"publishers of {topic}": n for topic, n in self._met.items()}
        status.values = [KeyValue(key=k, value=str(v)) for k, v in counts.items()]
        message = DiagnosticArray(status=[status])
        message.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(message)

    def _write(self, topic: str, type_name: str, data: bytes, stamped: bool) -> None:
        time_ns = stamp_of_bytes(data) if stamped else time.time_ns()
        self._bag.write_raw(topic, type_name, data, time_ns)
        self.count += 1
        self._last = time.monotonic()

    def _end_when_idle(self) -> None:
        if self.count and time.monotonic() - self._last > self._idle_limit_s:
            self.context.try_shutdown()


def stamp_of_bytes(data: bytes) -> int:
    """Return the stamp in nanoseconds of a CDR message that starts with a header.

    Examples
    --------
    >>> stamp_of_bytes(bytes([0, 1, 0, 0]) + bytes([2, 0, 0, 0]) + bytes([7, 0, 0, 0]))
    2000000007
    """
    order = "<" if data[1] & 1 else ">"
    sec, nanosec = struct.unpack_from(f"{order}iI", data, 4)
    return int(sec) * 1_000_000_000 + int(nanosec)


def main(args: Sequence[str] | None = None) -> int:
    """Record until a signal ends it."""
    own, ros = split_ros_args(sys.argv[1:] if args is None else args)
    options = _parser().parse_args(own)
    topics = options.topics or (*RESULTS, *(IMAGES if options.images else ()))
    return run(lambda: [BagRecorder(options.bag, topics, options.idle_limit)], ros)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="bag_recorder", description=__doc__, epilog="ROS arguments follow after --ros-args."
    )
    parser.add_argument("bag", help="the .mcap file to write")
    parser.add_argument(
        "--topics", nargs="+", default=[], help=f"topics (default: {' '.join(RESULTS)})"
    )
    parser.add_argument("--images", action="store_true", help="record image and camera_info too")
    parser.add_argument(
        "--idle-limit", type=float, default=0.0, metavar="S",
        help="end when nothing came for so long after the first message",
    )  # fmt: skip
    return parser


if __name__ == "__main__":
    raise SystemExit(main())
