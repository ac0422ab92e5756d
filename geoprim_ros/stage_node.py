"""The base of the stage nodes: guarded callbacks, counts, live parameters, diagnostics."""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable
from typing import Any, TypeVar

from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

from geoprim_core.errors import GeoprimError
from geoprim_core.io.record import stamp_of
from geoprim_core.params import Params
from geoprim_ros.parameters import Follower, LiveParams, as_values
from geoprim_ros.statistics import StageStatistics

P = TypeVar("P", bound=Params)
L = TypeVar("L", bound=Follower)

_WARNING_PERIOD_S = 5.0
_DIAGNOSTICS_PERIOD_S = 1.0


def sensor_qos(depth: int = 1) -> QoSProfile:
    """Return the profile for images that come in: best effort, only the newest."""
    return QoSProfile(
        depth=depth,
        history=HistoryPolicy.KEEP_LAST,
        reliability=ReliabilityPolicy.BEST_EFFORT,
    )


def result_qos(depth: int = 10) -> QoSProfile:
    """Return the profile for results: reliable, the last ten."""
    return QoSProfile(
        depth=depth, history=HistoryPolicy.KEEP_LAST, reliability=ReliabilityPolicy.RELIABLE
    )


class StageNode(Node):  # type: ignore[misc]
    """A node that turns messages into messages and survives the ones it cannot use.

    A subclass declares its parameters with `live_params`, warms its kernels with `warm_up` and
    then connects topics with `listen` and `advertise`.
    """

    def __init__(self, name: str, **options: Any) -> None:
        super().__init__(name, **options)
        self.statistics = StageStatistics()
        self.revision = 0
        self._live: list[Follower] = []
        self._bad_reported = 0
        self._diagnostics = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self.create_timer(_DIAGNOSTICS_PERIOD_S, self.publish_diagnostics)
        self.add_post_set_parameters_callback(self._follow)

    def live_params(
        self, initial: P, prefix: str = "", wanted: Callable[[str], bool] = lambda name: True
    ) -> LiveParams[P]:
        """Declare the parameters of a Params object, which then follows them."""
        return self.follow_with(LiveParams(self, initial, prefix, wanted))

    def follow_with(self, live: L) -> L:
        """Let something made from ROS parameters check and follow their changes."""
        self._live.append(live)
        return live

    def warm_up(self, work: Callable[[], object]) -> None:
        """Run the stage once, so that no frame waits for its kernels."""
        start = time.perf_counter()
        work()
        self.statistics.warm_up_s = time.perf_counter() - start

    def listen(
        self,
        kind: Any,
        topic: str,
        step: Callable[[Any], object],
        qos: QoSProfile,
        *,
        frame: bool = True,
    ) -> Any:
        """Subscribe; what `step` cannot use is counted and told, and the node goes on.

        With `frame` the messages are the frames that the statistics count.
        """

        def receive(message: Any, info: dict[str, Any]) -> None:
            if frame:
                self.statistics.received(topic, info.get("publication_sequence_number"))
                self._note_latency(info)
            self._guarded(step, message)

        return self.create_subscription(
            kind, topic, receive, qos,
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )  # fmt: skip

    def advertise(self, kind: Any, topic: str, qos: QoSProfile | None = None) -> Any:
        """Publish on a topic, reliably, unless parameters override it."""
        return self.create_publisher(
            kind, topic, qos or result_qos(),
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )  # fmt: skip

    def reject(self, reason: str) -> None:
        """Count a frame that cannot be used, and say why, not more often than every few seconds."""
        self.statistics.bad += 1
        self.statistics.last_reason = reason
        self.get_logger().warning(reason, throttle_duration_sec=_WARNING_PERIOD_S)

    def note_cut_short(self, reason: str) -> None:
        """Count a result that is not complete, and say why, not more often than bad frames."""
        self.statistics.cut_short += 1
        self.get_logger().warning(f"incomplete: {reason}", throttle_duration_sec=_WARNING_PERIOD_S)

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> Any:
        """Change parameters together, or none of them and say why."""
        parameters = [self._typed(p) for p in parameter_list]
        reason = self._refusal(parameters)
        if reason:
            return SetParametersResult(successful=False, reason=reason)
        return super().set_parameters_atomically(parameters)

    def set_parameters(self, parameter_list: list[Parameter]) -> list[Any]:
        """Change parameters one after the other."""
        return [self.set_parameters_atomically([p]) for p in parameter_list]

    def publish_diagnostics(self) -> None:
        """Publish the counts and times; called once a second."""
        name = f"{self.get_fully_qualified_name().lstrip('/')}: frames"
        message = DiagnosticArray()
        message.header.stamp = self.get_clock().now().to_msg()
        message.status = [self.statistics.status(name, self.revision, self._bad_reported)]
        self._bad_reported = self.statistics.bad
        self._diagnostics.publish(message)

    def _guarded(self, step: Callable[[Any], object], message: Any) -> None:
        start, done = time.perf_counter(), self.statistics.frames_out
        try:
            step(message)
        except GeoprimError as problem:
            self.reject(f"frame {_stamp_text(message)}: {problem}")
        except Exception as error:
            if not self.context.ok():
                raise
            self.reject(f"frame {_stamp_text(message)}: {type(error).__name__}: {error}")
            text = traceback.format_exc()
            self.get_logger().error(text, throttle_duration_sec=_WARNING_PERIOD_S)
        if self.statistics.frames_out > done:  # not where a message only waits for another one
            self.statistics.seconds.append(time.perf_counter() - start)

    def _note_latency(self, info: dict[str, Any]) -> None:
        sent = info.get("source_timestamp")
        if sent:
            self.statistics.latencies.append(max(0.0, (time.time_ns() - sent) * 1e-9))

    def _typed(self, parameter: Parameter) -> Parameter:
        value = parameter.value
        for live in self._live:
            value = live.typed(parameter.name, value)
        return parameter if value is parameter.value else Parameter(parameter.name, value=value)

    def _refusal(self, parameters: list[Parameter]) -> str:
        """Return why the parameters cannot be changed so, or an empty text."""
        values = as_values(parameters)
        try:
            for live in self._live:
                live.changed(values)
        except GeoprimError as problem:
            return str(problem)
        return ""

    def _follow(self, parameters: list[Parameter]) -> None:
        values = as_values(parameters)
        self.revision += any(live.changes(values) for live in self._live)
        for live in self._live:
            live.follow(values)


def _stamp_text(message: Any) -> str:
    sec, nanosec = divmod(stamp_of(message), 1_000_000_000)
    return f"{sec}.{nanosec:09d}"
