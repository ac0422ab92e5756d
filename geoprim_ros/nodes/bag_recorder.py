"""Node `bag_recorder`: writes topics into an MCAP bag, as raw bytes, nothing decoded."""

from __future__ import annotations

import argparse
import struct
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

from geoprim_core.errors import FileError, InputError
from geoprim_core.io.bag_writer import COMPRESSIONS
from geoprim_core.io.bags import IMAGE_TYPES
from geoprim_core.io.definitions import typestore
from geoprim_ros.conversions import message_class
from geoprim_ros.installed_types import installed_definition
from geoprim_ros.player_options import add_filter, add_overrides, filter_of, not_negative, positive
from geoprim_ros.qos_profiles import Policies, offered_text, profile, read_overrides
from geoprim_ros.selection import TopicFilter
from geoprim_ros.spin import run, split_ros_args
from geoprim_ros.split_writer import Split, open_recording
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


@dataclass(frozen=True)
class Recording:
    """What is recorded and how.

    Attributes
    ----------
    topics : sequence of str
        Names; the type of one that is not geoprim's is looked up in the graph.
    also : TopicFilter or None
        Takes topics of the graph beside those, except hidden ones.
    compression : {"zstd", "lz4", "none"}
    split : when a new file starts
    flush_period_s : float
        So much at most is lost when the process is killed.
    received : bool
        Write under the time of arrival by the node's clock, not under the stamp of the header.
    overrides : mapping of topic to QoS policies
    idle_limit_s : float
        End the process when nothing came for so long after the first message, 0: never.
    """

    topics: Sequence[str] = RESULTS
    also: TopicFilter | None = None
    compression: str = "zstd"
    split: Split = field(default_factory=Split)
    flush_period_s: float = 0.5
    received: bool = False
    overrides: Mapping[str, Policies] = field(default_factory=dict)
    idle_limit_s: float = 0.0


class BagRecorder(Node):  # type: ignore[misc]
    """Writes every message under its stamp; the bag is complete when the node is destroyed.

    Parameters
    ----------
    path : the .mcap file, or the folder where the recording is split
    recording : what and how

    Raises
    ------
    FileError
        The file cannot be written.
    """

    def __init__(self, path: str, recording: Recording | None = None, **options: Any) -> None:
        super().__init__("bag_recorder", **options)
        self._recording = recording = recording or Recording()
        self._bag = open_recording(Path(path), recording.split, recording.compression)
        self._last = self._flushed = 0.0
        self._unknown = set(recording.topics)
        self._met: dict[str, int] = {}
        self._counts: dict[str, int] = {}
        self._offered: dict[str, str] = {}
        self._policies = {name.lstrip("/"): p for name, p in recording.overrides.items()}
        self._diagnostics = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self.create_timer(_DIAGNOSTICS_PERIOD_S, self._publish_diagnostics)
        self.create_timer(recording.flush_period_s, self._flush)
        self._connect()
        if self._unknown or recording.also:
            self.create_timer(_SEARCH_PERIOD_S, self._connect)
        if recording.idle_limit_s > 0:
            self.create_timer(_IDLE_PERIOD_S, self._end_when_idle)

    @property
    def count(self) -> int:
        """Number of messages written."""
        return sum(self._counts.values())

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
        also = self._recording.also
        present = dict(self.get_topic_names_and_types()) if self._unknown or also else {}
        for topic in sorted(self._unknown):
            found = present.get(self.resolve_topic_name(topic), [])
            kind = _TYPES.get(topic.rpartition("/")[2]) or (found[0] if found else None)
            if kind is not None:
                self._unknown.discard(topic)
                self._subscribe(topic, kind)
        if also is None:
            return
        for topic, kinds in present.items():
            if topic not in self._met and also.takes(topic) and not _hidden(topic):
                self._subscribe(topic, kinds[0])

    def _subscribe(self, topic: str, type_name: str) -> None:
        name = self.resolve_topic_name(topic)
        self._met[name] = 0
        try:
            kind = message_class(type_name)
            definition = _definition(type_name)
        except InputError as problem:
            self.get_logger().warning(f"topic {name} is not recorded: {problem}")
            return
        first = next(iter(kind.get_fields_and_field_types().values()), "")
        stamped = first == "std_msgs/Header" and not self._recording.received

        def write(data: bytes) -> None:
            time_ns = stamp_of_bytes(data) if stamped else 0
            # A stamp of zero means that there is none.
            time_ns = time_ns if time_ns > 0 else self.get_clock().now().nanoseconds
            self._write(name, type_name, data, time_ns, definition)

        self.create_subscription(
            kind, topic, write, self._profile(name, type_name), raw=True,
            event_callbacks=SubscriptionEventCallbacks(matched=lambda m: self._matched(name, m)),
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )  # fmt: skip

    def _profile(self, name: str, type_name: str) -> QoSProfile:
        """Return a profile that the publishers of a topic can serve, as far as they are known."""
        sensor = type_name in _SENSOR_TYPES
        qos = sensor_qos(_DEPTH) if sensor else result_qos(_DEPTH)
        offers = [info.qos_profile for info in self.get_publishers_info_by_topic(name)]
        # Where nobody publishes yet, who else listens tells whether a topic is latched.
        others = [info.qos_profile for info in self.get_subscriptions_info_by_topic(name)]
        if offers:
            best_effort = any(o.reliability == ReliabilityPolicy.BEST_EFFORT for o in offers)
            policies = ReliabilityPolicy
            qos.reliability = policies.BEST_EFFORT if best_effort else policies.RELIABLE
        peers = offers or others
        if peers and all(p.durability == DurabilityPolicy.TRANSIENT_LOCAL for p in peers):
            qos.durability = DurabilityPolicy.TRANSIENT_LOCAL
        return profile(qos, self._policies.get(name.lstrip("/"), {}))

    def _matched(self, name: str, event: Any) -> None:
        self._met[name] = event.current_count
        self._publish_diagnostics()

    def _publish_diagnostics(self) -> None:
        """Tell how many messages were written and how many publishers each topic has."""
        name = f"{self.get_fully_qualified_name().lstrip('/')}: bag"
        status = DiagnosticStatus(level=DiagnosticStatus.OK, name=name, hardware_id="none")
        counts = {"messages": self.count}
        counts |= {f"messages of {topic}": n for topic, n in self._counts.items()}
        counts |= {f"publishers of {topic}": n for topic, n in self._met.items()}
        status.values = [KeyValue(key=k, value=str(v)) for k, v in counts.items()]
        message = DiagnosticArray(status=[status])
        message.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(message)

    def _write(
        self, topic: str, type_name: str, data: bytes, time_ns: int, definition: str
    ) -> None:
        if topic not in self._offered:
            offers = self.get_publishers_info_by_topic(topic)
            self._offered[topic] = offered_text(info.qos_profile for info in offers)
        self._bag.write_raw(topic, type_name, data, time_ns, definition, self._offered[topic])
        self._counts[topic] = self._counts.get(topic, 0) + 1
        self._last = time.monotonic()

    def _flush(self) -> None:
        """Hand to the system what came since the last time."""
        if self._last > self._flushed:
            self._flushed = time.monotonic()
            self._bag.flush()

    def _end_when_idle(self) -> None:
        idle = time.monotonic() - self._last
        if self._counts and idle > self._recording.idle_limit_s:
            self.context.try_shutdown()


def stamp_of_bytes(data: bytes) -> int:
    """Return the stamp in nanoseconds of a CDR message that starts with a header; 0 if too short.

    Examples
    --------
    >>> stamp_of_bytes(bytes([0, 1, 0, 0]) + bytes([2, 0, 0, 0]) + bytes([7, 0, 0, 0]))
    2000000007
    """
    if len(data) < 12:
        return 0
    order = "<" if data[1] & 1 else ">"
    sec, nanosec = struct.unpack_from(f"{order}iI", data, 4)
    return int(sec) * 1_000_000_000 + int(nanosec)


def _definition(type_name: str) -> str:
    """Return the text of a type that the bag writer does not know itself."""
    if type_name in typestore().fielddefs:
        return ""
    text = installed_definition(type_name)
    if not text:
        raise InputError("type", "a type whose definition is installed", type_name)
    return text


def _hidden(topic: str) -> bool:
    return any(part.startswith("_") for part in topic.split("/"))


def main(args: Sequence[str] | None = None) -> int:
    """Record until a signal ends it."""
    own, ros = split_ros_args(sys.argv[1:] if args is None else args)
    options = _parser().parse_args(own)

    def make() -> list[Node]:
        return [BagRecorder(options.bag, _recording(options))]

    return run(make, ros)


def _recording(options: argparse.Namespace) -> Recording:
    left_out = options.exclude_regex or options.exclude_topics
    searched = bool(options.all or options.regex or (left_out and not options.topics))
    default = () if searched else (*RESULTS, *(IMAGES if options.images else ()))
    path = options.qos_profile_overrides_path
    return Recording(
        topics=options.topics or default,
        also=filter_of(options, []) if searched else None,
        compression=options.compression,
        split=Split(round(options.split_size * 1e6), options.split_duration),
        flush_period_s=options.flush_period,
        received=options.log_time == "received" or (searched and not options.log_time),
        overrides=read_overrides(path) if path else {},
        idle_limit_s=options.idle_limit,
    )


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="bag_recorder", description=__doc__, epilog="ROS arguments follow after --ros-args."
    )
    parser.add_argument("bag", help="the .mcap file to write, or the folder where it is split")
    topics = parser.add_argument_group("topics", f"without any: {' '.join(RESULTS)}")
    topics.add_argument("--images", action="store_true", help="record image and camera_info too")
    topics.add_argument("-a", "--all", action="store_true", help="record every topic")
    add_filter(topics, "record")
    add_overrides(topics)
    _add_file(parser.add_argument_group("file"))
    parser.add_argument(
        "--idle-limit", type=float, default=0.0, metavar="S",
        help="end when nothing came for so long after the first message",
    )  # fmt: skip
    return parser


def _add_file(group: argparse._ArgumentGroup) -> None:
    add: Callable[..., Any] = group.add_argument
    add("--compression", choices=list(COMPRESSIONS), default="zstd", help="of chunks of messages")
    add(
        "--log-time", choices=["header", "received"],
        help="the time of a message in the bag; header unless topics are searched for",
    )  # fmt: skip
    add(
        "--flush-period", type=positive, default=0.5, metavar="S",
        help="write out so often; what comes in between is lost when the process is killed",
    )  # fmt: skip
    add(
        "--split-size", type=not_negative, default=0.0, metavar="MB",
        help="start a new file of the folder after so many megabytes",
    )  # fmt: skip
    add(
        "--split-duration", type=not_negative, default=0.0, metavar="S",
        help="start a new file of the folder after so many seconds",
    )  # fmt: skip


if __name__ == "__main__":
    raise SystemExit(main())
