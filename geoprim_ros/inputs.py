"""The inputs of a stage: subscriptions that are opened and closed as they are wanted."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from rclpy.node import Node
from rclpy.qos import QoSProfile

from geoprim_ros.qos import QosReports, overridden


class Source(NamedTuple):
    """A topic that an input can read: message class and name."""

    kind: Any
    topic: str


class Input:
    """A subscription of a node that exists only while the input is open.

    A closed input costs nothing: the publisher does not send to it, nothing is unpacked.

    Parameters
    ----------
    node : the node that reads
    sources : the topics it can read, by name
    chosen : returns the name of the one to read
    receive : called with every message and its `message_info`
    qos : the profile, which parameters may override
    reports : tells of publishers that do not match

    Raises
    ------
    ParameterError
        A `qos_overrides` parameter is refused.
    """

    def __init__(
        self,
        node: Node,
        sources: Mapping[str, Source],
        chosen: Callable[[], str],
        receive: Callable[[Any, dict[str, Any]], None],
        qos: QoSProfile,
        reports: QosReports,
    ) -> None:
        self._node, self._sources, self._chosen = node, sources, chosen
        self._receive, self._reports = receive, reports
        self._subscription: Any = None
        self._open_source = ""
        self._profiles = {
            name: overridden(node, node.resolve_topic_name(source.topic), "subscription", qos)
            for name, source in sources.items()
        }

    @property
    def is_open(self) -> bool:
        """Whether the subscription exists."""
        return self._subscription is not None

    @property
    def topic(self) -> str:
        """The resolved name of the topic that is read when the input is open."""
        return str(self._node.resolve_topic_name(self._sources[self._chosen()].topic))

    def read_one(self) -> bool:
        """Pass on a message that waits to be read; tell whether there was one."""
        if not self.is_open:
            return False
        reader = self._subscription
        with reader.handle:
            taken = reader.handle.take_message(reader.msg_type, reader.raw)
        if taken is not None:
            self._receive(*taken)
        return taken is not None

    def set_open(self, wanted: bool) -> bool:
        """Open or close, or open anew where another source is chosen; tell whether it opened."""
        name = self._chosen()
        if self.is_open and not (wanted and name == self._open_source):
            self._node.destroy_subscription(self._subscription)
            self._subscription = None
        if not wanted or self.is_open:
            return False
        source, profile = self._sources[name], self._profiles[name]
        self._subscription = self._node.create_subscription(
            source.kind, source.topic, self._receive, profile,
            event_callbacks=self._reports.of_subscription(self.topic, profile),
        )  # fmt: skip
        self._open_source = name
        return True
