"""The base of the stage nodes: lazy inputs, guarded callbacks, live parameters, diagnostics."""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from std_srvs.srv import SetBool

from geoprim_core.errors import GeoprimError
from geoprim_core.io.record import stamp_of
from geoprim_core.params import Params, option
from geoprim_ros.conversions import check_installed
from geoprim_ros.inputs import Input, Source
from geoprim_ros.parameters import Follower, LiveParams, as_values
from geoprim_ros.qos import QosReports, overridden, result_qos, sensor_qos
from geoprim_ros.statistics import StageStatistics

__all__ = ["StageNode", "StageParams", "result_qos", "sensor_qos"]

P = TypeVar("P", bound=Params)
L = TypeVar("L", bound=Follower)

_WARNING_PERIOD_S = 5.0
_DIAGNOSTICS_PERIOD_S = 1.0


@dataclass(frozen=True)
class StageParams(Params):
    """What every stage has.

    Lazy is the default: nobody misses what nobody reads, and a robot that starts all its nodes
    pays for those in use. Without it a stage works and publishes all the time, which a
    transient-local output needs.
    """

    lazy: bool = option(True, "subscribe only while somebody listens to an output")


class StageNode(Node):  # type: ignore[misc]
    """A node that turns messages into messages and survives the ones it cannot use.

    A subclass declares its parameters with `live_params`, warms its kernels with `warm_up` and
    then connects topics with `advertise` and `listen`. Its inputs are open while it is enabled
    (service `~/enable`) and somebody listens to one of its outputs.
    """

    def __init__(self, name: str, **options: Any) -> None:
        super().__init__(name, **options)
        self.statistics = StageStatistics()
        self.revision = 0
        self.enabled = True
        self._live: list[Follower] = []
        self._inputs: dict[str, Input] = {}
        self._outputs: list[Any] = []
        self._reports = QosReports(self)
        self._bad_reported = 0
        self._stage_params = self.live_params(StageParams())
        self._diagnostics = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self.create_timer(_DIAGNOSTICS_PERIOD_S, self._every_second)
        self.create_service(SetBool, "~/enable", self._on_enable)
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
        guarded: bool = True,
    ) -> None:
        """Subscribe as long as the stage is in use; see `add_input`."""
        self.add_input(
            {"": Source(kind, topic)}, lambda: "", step, qos,
            name=topic, frame=frame, guarded=guarded,
        )  # fmt: skip

    def add_input(
        self,
        sources: Mapping[str, Source],
        chosen: Callable[[], str],
        step: Callable[[Any], object],
        qos: QoSProfile,
        *,
        name: str,
        frame: bool = True,
        guarded: bool = True,
    ) -> None:
        """Add an input; what `step` cannot use is counted and told, and the node goes on.

        With `frame` the messages are the frames that the statistics count. Without `guarded` the
        step looks after that itself, as `Frames` does.
        """
        act = partial(self.guarded, step) if guarded else step

        def receive(message: Any, info: dict[str, Any]) -> None:
            if frame:
                self.statistics.received(name, info.get("publication_sequence_number"))
                self._note_latency(info)
            act(message)

        self._inputs[name] = Input(self, sources, chosen, receive, qos, self._reports)
        self.refresh()

    def read_waiting(self, names: Iterable[str]) -> bool:
        """Pass on a message of each of some inputs; tell whether there was one to read."""
        return sum(self._inputs[name].read_one() for name in names if name in self._inputs) > 0

    def advertise(self, kind: Any, topic: str, qos: QoSProfile | None = None) -> Any:
        """Publish on a topic, reliably, unless parameters override it."""
        check_installed(kind)
        name = self.resolve_topic_name(topic)
        profile = overridden(self, name, "publisher", qos or result_qos())
        events = self._reports.of_publisher(name, profile, lambda _: self.refresh())
        self._outputs.append(self.create_publisher(kind, topic, profile, event_callbacks=events))
        return self._outputs[-1]

    def wanted(self, output: Any) -> bool:
        """Tell whether a message on an output is worth making."""
        return not self._stage_params.value.lazy or output.get_subscription_count() > 0

    def is_active(self) -> bool:
        """Tell whether the inputs shall be open."""
        return self.enabled and any(self.wanted(output) for output in self._outputs)

    def state(self) -> str:
        """Return what the node does: "active", "idle" where nobody listens, or "disabled"."""
        if not self.enabled:
            return "disabled"
        return "active" if self.is_active() else "idle"

    def refresh(self) -> None:
        """Open or close the inputs, in the order in which they were added."""
        wanted, was_open = self.is_active(), any(i.is_open for i in self._inputs.values())
        for name, source in self._inputs.items():
            topic = source.topic
            if source.set_open(wanted):
                self.statistics.resumed(name, topic)
        if was_open and not wanted:
            self.paused()
        if was_open != any(i.is_open for i in self._inputs.values()):
            self.publish_diagnostics()  # whoever waits for the stage hears of it now

    def paused(self) -> None:
        """Forget what waits for messages that will not come; for subclasses."""

    def disconnect(self) -> None:
        """Take the inputs and outputs away."""
        for source in self._inputs.values():
            source.set_open(False)
        for output in self._outputs:
            self.destroy_publisher(output)
        self._inputs.clear()
        self._outputs.clear()
        self.paused()

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
        state = self.state()
        message.status = [self.statistics.status(name, state, self.revision, self._bad_reported)]
        self._bad_reported = self.statistics.bad
        self._diagnostics.publish(message)

    def _every_second(self) -> None:
        self.refresh()
        self.publish_diagnostics()

    def _on_enable(self, request: Any, response: Any) -> Any:
        """Answer `~/enable`: a disabled stage has no subscription."""
        self.enabled = bool(request.data)
        self.refresh()
        self.publish_diagnostics()
        response.success, response.message = True, self.state()
        return response

    def guarded(self, step: Callable[[Any], object], message: Any) -> None:
        """Do a step with a message; what cannot be used is counted and told."""
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
        self.refresh()


def _stamp_text(message: Any) -> str:
    sec, nanosec = divmod(stamp_of(message), 1_000_000_000)
    return f"{sec}.{nanosec:09d}"
