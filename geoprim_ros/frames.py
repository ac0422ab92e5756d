"""Frames for a stage: messages of one stamp, one after the other, the newest where many wait."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from geoprim_core.params import Params, option
from geoprim_ros.pairing import StampPairs

if TYPE_CHECKING:
    from geoprim_ros.stage_node import StageNode

_KEPT = 10
# As many as a queue holds, and the same again while those are read.
_MOST_READ = 20


@dataclass(frozen=True)
class WaitingParams(Params):
    """How far a stage may fall behind.

    Two may wait: a stage that a busy machine holds up for the time of a frame drops none, and in
    one executor two frames wait as a matter of course, as the stage before has its turn first.
    """

    max_waiting: int = option(
        2,
        "frames that may wait; of more the newest is served, the others are dropped and counted "
        "(0: any number, as far as the queues go)",
        low=0,
        high=1000,
    )


class Frames:
    """Puts messages with one stamp together and serves them to the work of a stage.

    The queue between two stages is deep, so that nothing is lost which nobody counts. Where the
    work is slower than what comes, a queue would only make it late; therefore all that has come
    is read before a frame is served, and what is too much is dropped frame by frame.

    Parameters
    ----------
    node : the stage, which gets the parameter `max_waiting`
    topics : the inputs of a frame
    work : called with a frame, as topic -> message
    incomplete : number of frames without all their messages that are kept
    """

    def __init__(
        self,
        node: StageNode,
        topics: tuple[str, ...],
        work: Callable[[dict[str, Any]], object],
        incomplete: int = _KEPT,
    ) -> None:
        self._node, self._work = node, work
        self._live = node.live_params(WaitingParams())
        self._pairs = StampPairs(topics, incomplete)
        self._waiting: deque[dict[str, Any]] = deque()
        self._again = node.create_guard_condition(self._turn)
        self._busy = False

    def receiver(self, topic: str) -> Callable[[Any], None]:
        """Return what takes the messages of a topic."""
        return partial(self._add, topic)

    def clear(self) -> None:
        """Forget what waits; it is not counted, as nobody waits for it any more."""
        self._pairs.clear()
        self._waiting.clear()

    def _add(self, topic: str, message: Any) -> None:
        frame = self._pairs.add(topic, message)
        self._node.statistics.unpaired = self._pairs.unpaired
        if frame is not None:
            self._waiting.append(frame)
        if not self._busy:
            self._turn()

    def _turn(self) -> None:
        """Serve one frame; the executor has its turn between two, for timers and services."""
        self._busy = True
        try:
            if self._live.value.max_waiting:
                self._read_all()
                self._drop()
            if self._waiting:
                frame = self._waiting.popleft()
                self._node.guarded(lambda _: self._work(frame), frame[self._pairs.topics[0]])
        finally:
            self._busy = False
        if self._waiting:
            self._again.trigger()

    def _read_all(self) -> None:
        """Read what waits in the queues, topic by topic in turns: like stamps come together."""
        for _ in range(_MOST_READ):
            if not self._node.read_waiting(self._pairs.topics):
                return

    def _drop(self) -> None:
        if len(self._waiting) > self._live.value.max_waiting:
            newest = self._waiting.pop()
            self._node.statistics.superseded(len(self._waiting))
            self._waiting.clear()
            self._waiting.append(newest)
