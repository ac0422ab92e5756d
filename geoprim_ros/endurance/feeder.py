"""The camera and the listener of a trial, in one node."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geoprim_msgs.msg import EllipseDetections
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import Image

from geoprim_core.errors import BagError
from geoprim_core.io.record import stamp_of
from geoprim_ros.endurance.images import Frame
from geoprim_ros.qos import result_qos

_DEPTH = 50
_TURN_S = 0.05
_SETTLED_S = 0.4
# Two on their way keep every stage busy and no queue full.
_ON_THE_WAY = 2
# A frame that is not answered in that time is lost.
_ANSWER_LIMIT_S = 2.0


class Feeder(Node):  # type: ignore[misc]
    """Publishes frames, takes the ellipses that come back and what the stages tell.

    Attributes
    ----------
    sent, answered : int
        Good frames, and those of which the ellipses came.
    told : dict
        Node -> the values that it published last on /diagnostics.
    """

    def __init__(self, executor: SingleThreadedExecutor, topic: str = "ellipses") -> None:
        super().__init__("feeder")
        executor.add_node(self)
        self._executor = executor
        self._images = self.create_publisher(Image, "image", result_qos())
        self._listened = topic
        self._waiting: dict[int, float] = {}
        self._stamp = 0
        self.sent = self.answered = 0
        self.last_answer = 0.0
        self.told: dict[str, dict[str, str]] = {}
        self._ears = {topic: self._listen(topic, EllipseDetections, self._answer)}
        self.create_subscription(DiagnosticArray, "/diagnostics", self._note, _DEPTH)

    @property
    def published(self) -> int:
        """Number of frames, the bad ones too."""
        return self._stamp

    def turn(self, seconds: float = _TURN_S) -> None:
        """Let the node take what comes, for one message at most."""
        self._executor.spin_once(timeout_sec=seconds)

    def turn_for(self, seconds: float) -> None:
        """Take what comes for some time."""
        end = time.monotonic() + seconds
        while self.context.ok() and time.monotonic() < end:
            self.turn(min(_TURN_S, max(0.0, end - time.monotonic())))

    def wait(self, condition: Callable[[], bool], limit_s: float, what: str) -> float:
        """Take what comes until something is true; return how long that took.

        Raises
        ------
        BagError
            It did not become true in time.
        """
        start = time.monotonic()
        while not condition():
            if time.monotonic() - start > limit_s:
                raise BagError(f"{what}: not within {limit_s:g} s")
            self.turn()
        return time.monotonic() - start

    def wait_for(self, nodes: Iterable[str], limit_s: float = 180.0) -> None:
        """Wait until some nodes are active and the image has a reader; kernels may compile."""
        names = list(nodes)

        def active() -> bool:
            states = [self.told.get(name, {}).get("state") for name in names]
            return set(states) <= {"active"} and self._images.get_subscription_count() > 0

        self.wait(active, limit_s, f"the start of {', '.join(names)}")
        self.turn_for(_SETTLED_S)

    def publish(self, frame: Frame) -> None:
        """Publish a frame with a stamp of its own."""
        self._stamp += 1
        if frame.good:
            self._waiting[self._stamp] = time.monotonic()
            self.sent += 1
        self._images.publish(frame.at(self._stamp))

    def feed(self, frames: Iterator[Frame], count: int) -> None:
        """Publish some frames as fast as they are answered."""
        for _ in range(count):
            if not self.context.ok():
                return
            self.publish(next(frames))
            self.drain(_ON_THE_WAY - 1)

    def burst(self, frames: Iterator[Frame], count: int) -> None:
        """Publish some frames at once, as a driver that was held up, and take what comes."""
        for _ in range(count):
            self.publish(next(frames))
        self.drain()

    def feed_at(self, frames: Iterator[Frame], hz: float, seconds: float) -> None:
        """Publish frames at a rate, answered or not."""
        start, number = time.monotonic(), 0
        while self.context.ok() and number < seconds * hz:
            due = start + number / hz
            self.turn_for(due - time.monotonic())
            self.publish(next(frames))
            number += 1

    def drain(self, most: int = 0) -> None:
        """Wait until no more than some frames are on their way; a lost one is given up."""
        while len(self._waiting) > most and self.context.ok():
            self.turn()
            late = time.monotonic() - _ANSWER_LIMIT_S
            self._waiting = {stamp: at for stamp, at in self._waiting.items() if at > late}

    def hear(self, topic: str, kind: Any) -> None:
        """Listen to another topic, to whatever comes."""
        self._ears[topic] = self._listen(topic, kind, lambda message: None)

    def turn_away(self, topic: str) -> None:
        """Listen to a topic no more."""
        self.destroy_subscription(self._ears.pop(topic))

    def _listen(self, topic: str, kind: Any, take: Callable[[Any], None]) -> Any:
        return self.create_subscription(kind, topic, take, result_qos(_DEPTH))

    def _answer(self, message: Any) -> None:
        self.last_answer = time.monotonic()
        self.answered += self._waiting.pop(stamp_of(message), None) is not None

    def _note(self, message: Any) -> None:
        for status in message.status:
            self.told[status.name.split(":")[0]] = {v.key: v.value for v in status.values}
