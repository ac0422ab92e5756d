"""Node `bag_player`: plays an MCAP bag with its original stamps, as raw bytes, nothing decoded."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from rclpy.duration import Duration
from rclpy.exceptions import InvalidTopicNameException
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from rosgraph_msgs.msg import Clock

from geoprim_core.errors import BagError, InputError
from geoprim_core.io.bags import IMAGE_TYPES, BagMessage, BagReader, Topic
from geoprim_ros.conversions import message_class
from geoprim_ros.keyboard import Keyboard
from geoprim_ros.playback import Playback
from geoprim_ros.player_controls import KEYS, Controls
from geoprim_ros.player_options import filter_of, parser
from geoprim_ros.player_progress import Progress
from geoprim_ros.qos_profiles import (
    Policies,
    is_latched,
    offered_policies,
    profile,
    read_overrides,
)  # fmt: skip
from geoprim_ros.selection import BagRange, TopicFilter
from geoprim_ros.spin import in_rclpy, split_ros_args
from geoprim_ros.stage_node import result_qos

# Deep enough that a reliable reader, which takes its time, still finds every frame.
_DEPTH = 50
_SHORTEST_CDR = 4  # the bytes that tell the encoding
# The last stretch before a message is slept, as the executor wakes up too late for it.
_SLEEP_S = 0.002
# So often keys, the progress bar and, where messages come without a pause, services have a turn.
_TURN_S = 0.05


class BagPlayer(Node):  # type: ignore[misc]
    """Publishes messages of a bag; `play` does so in the rhythm of their log times.

    Parameters
    ----------
    reader : the bag
    choice : what to play
    clock_hz : rate of /clock, 0 for none
    remap : new names of topics
    overrides : QoS policies of topics

    Raises
    ------
    BagError
        A topic is missing or of a type that is not installed, or there is nothing to play.
    """

    playback: Playback[BagMessage] | None = None

    def __init__(
        self,
        reader: BagReader,
        choice: TopicFilter | None = None,
        clock_hz: float = 0.0,
        *,
        remap: Mapping[str, str] | None = None,
        overrides: Mapping[str, Policies] | None = None,
        **options: Any,
    ) -> None:
        super().__init__("bag_player", **options)
        self.reader = reader
        self._choice = choice or TopicFilter()
        self._remap = {old.lstrip("/"): new for old, new in (remap or {}).items()}
        self._overrides = {name.lstrip("/"): p for name, p in (overrides or {}).items()}
        self._publishers_by_topic: dict[str, Any] = {}
        self._latched: dict[str, int] = {}
        self.not_sent = 0
        self.topics: list[Topic] = []
        for topic in self._choice.of(reader):
            if topic.count and not (clock_hz > 0 and topic.name.lstrip("/") == "clock"):
                self._advertise(topic)
        if not self.topics:
            raise BagError(f"{reader.path} holds no message that can be played")
        self._types = {topic.name: topic.type for topic in self.topics}
        self._bag_clock = self.create_publisher(Clock, "/clock", 10) if clock_hz > 0 else None
        self._clock_period = 1.0 / clock_hz if clock_hz > 0 else float("inf")
        self._next_clock = 0.0

    @property
    def source(self) -> BagRange:
        """The whole range of the bag, of the topics to play."""
        names = [topic.name for topic in self.topics]
        return BagRange(self.reader, names, *self.reader.time_range, self._latched)

    def get_parameter(self, name: str) -> Parameter:
        """Return a parameter; `position` is where the player is now."""
        parameter = super().get_parameter(name)
        if name == "position" and self.playback is not None:
            seconds = (self.playback.position() - self.reader.time_range[0]) * 1e-9
            return Parameter(name, value=seconds)
        return parameter

    def waiting_for(self, readers: int) -> list[str]:
        """Return the image topics, or all where there is none, with too few readers."""
        images = [t.name for t in self.topics if t.type in IMAGE_TYPES]
        names = images or [t.name for t in self.topics]
        counts = {n: self._publishers_by_topic[n].get_subscription_count() for n in names}
        return [name for name in names if counts[name] < readers]

    def send(self, message: BagMessage) -> None:
        """Publish one message as it stands in the bag, unless it is none."""
        if len(message.raw) < _SHORTEST_CDR:  # readers in other processes choke on it
            self.not_sent += 1
        elif message.type == self._types[message.topic]:
            self._publishers_by_topic[message.topic].publish(message.raw)

    def tick(self, bag_time_ns: int) -> float:
        """Publish the bag's time on /clock when it is time; return the seconds to the next time."""
        now = time.monotonic()
        if self._bag_clock is not None and now >= self._next_clock:
            clock = Clock()
            clock.clock.sec, clock.clock.nanosec = divmod(bag_time_ns, 1_000_000_000)
            self._bag_clock.publish(clock)
            late = now - self._next_clock > self._clock_period
            self._next_clock = (now if late else self._next_clock) + self._clock_period
        return self._next_clock - now if self._bag_clock is not None else float("inf")

    def unacknowledged(self, limit_s: float) -> list[str]:
        """Wait until every reliable reader has all messages; return the topics where one lacks."""
        end = time.monotonic() + limit_s
        waiting = dict(self._publishers_by_topic)
        while waiting and self.context.ok() and time.monotonic() < end:
            slice_s = min(_TURN_S, max(0.0, end - time.monotonic()))  # a signal is heard between
            waiting = {
                name: publisher
                for name, publisher in waiting.items()
                if not publisher.wait_for_all_acked(Duration(seconds=slice_s))
            }
        return sorted(waiting) if limit_s and self.context.ok() else []

    def _advertise(self, topic: Topic) -> None:
        """Make the publisher of a topic, or tell why there is none."""
        try:
            self._publishers_by_topic[topic.name] = self._publisher(topic)
        except (InputError, InvalidTopicNameException) as problem:
            reason = " ".join(str(problem).split())
            if self._choice.names(topic.name):
                raise BagError(f"topic {topic.name} ({topic.type}): {reason}") from None
            self.get_logger().warning(f"topic {topic.name} ({topic.type}) is left out: {reason}")
        else:
            self.topics.append(topic)

    def _publisher(self, topic: Topic) -> Any:
        if topic.name in self._publishers_by_topic:
            raise InputError("type", "one type a topic", "another one beside")
        kind = message_class(topic.type)
        name = self._remap.get(topic.name.lstrip("/"), topic.name)
        options = QoSOverridingOptions.with_default_policies()
        qos = self._profile(topic.name)
        return self.create_publisher(kind, name, qos, qos_overriding_options=options)

    def _profile(self, name: str) -> QoSProfile:
        """Return how a topic is published: reliably, and latched where it was recorded so."""
        override = self._overrides.get(name.lstrip("/"), {})
        base = result_qos(_DEPTH)
        offered = [p for p in offered_policies(self.reader.offered_qos(name)) if is_latched(p)]
        if offered:
            base.durability = DurabilityPolicy.TRANSIENT_LOCAL
            # A recorder learns the durability of a publisher, but mostly not its depth.
            known = all(p.get("depth") for p in offered)
            base.depth = sum(p["depth"] for p in offered) if known else _DEPTH
        qos = profile(base, override)
        if qos.durability == DurabilityPolicy.TRANSIENT_LOCAL:
            self._latched[name] = max(1, qos.depth)
        return qos


def play(
    player: BagPlayer,
    executor: SingleThreadedExecutor,
    playback: Playback[BagMessage],
    turn: Callable[[], object] = lambda: None,
) -> int:
    """Play to the end and return the number of messages sent; ends early at a shutdown.

    Parameters
    ----------
    player, executor, playback
        The node, what spins it, and the schedule.
    turn : called some twenty times a second
    """
    player.playback = playback
    playback.anchor()
    sent, last_turn = 0, 0.0
    while player.context.ok() and not playback.finished:
        message = playback.take()
        if message is not None:
            player.send(message)
            sent += 1
        to_clock, left = player.tick(playback.position()), playback.wait_s()
        if left > _SLEEP_S or time.monotonic() - last_turn > _TURN_S:
            executor.spin_once(timeout_sec=max(0.0, min(left - _SLEEP_S, to_clock, _TURN_S)))
            turn()
            last_turn = time.monotonic()
        elif message is None:
            time.sleep(left)
    return sent


def wait_for_readers(
    player: BagPlayer, executor: SingleThreadedExecutor, readers: int, limit_s: float
) -> None:
    """Wait until every image topic has some readers.

    Raises
    ------
    BagError
        They did not come in time.
    """
    end = time.monotonic() + limit_s
    while missing := player.waiting_for(readers):
        if time.monotonic() > end:
            names = ", ".join(missing)
            raise BagError(f"after {limit_s:g} s there are not {readers} readers of {names}")
        executor.spin_once(timeout_sec=0.05)
    # A best-effort reader may hear of this player a little later than the player of it.
    settled = time.monotonic() + 0.3
    while time.monotonic() < settled:
        executor.spin_once(timeout_sec=0.05)


def main(args: Sequence[str] | None = None) -> int:
    """Play a bag; 0 at its end or after a signal, 1 where a part is lost, 2 where nothing plays."""
    own, ros = split_ros_args(sys.argv[1:] if args is None else args)
    options = parser(__doc__ or "").parse_args(own)

    def work(executor: SingleThreadedExecutor, nodes: list[Node]) -> int:
        player = _player(options)
        nodes.append(player)
        executor.add_node(player)
        playback = _playback(player, options)
        if options.wait_for_readers:
            wait_for_readers(player, executor, options.wait_for_readers, options.wait_limit)
        return _play_all(player, executor, playback, options)

    return in_rclpy(work, ros)


def _player(options: argparse.Namespace) -> BagPlayer:
    path = options.qos_profile_overrides_path
    overrides = read_overrides(path) if path else {}
    return BagPlayer(
        BagReader(options.bag), filter_of(options), options.clock,
        remap=dict(options.remap), overrides=overrides,
    )  # fmt: skip


def _playback(player: BagPlayer, options: argparse.Namespace) -> Playback[BagMessage]:
    """Return the schedule of the part of the bag that is asked for."""
    whole = player.source
    start = whole.start_ns + round(options.start_offset * 1e9)
    ends = [options.until] if options.until is not None else []
    if options.duration is not None:
        ends.append(start + round(options.duration * 1e9))
    return Playback(
        whole.between(start, min(ends, default=None)),
        rate=options.rate, paused=options.start_paused, loop=options.loop,
    )  # fmt: skip


def _play_all(
    player: BagPlayer, executor: Any, playback: Playback[BagMessage], options: argparse.Namespace
) -> int:
    reader = player.reader
    controls = Controls(player, playback, reader.time_range[0], player.send)
    keyboard = Keyboard(-1 if options.disable_keyboard_controls else None)
    with keyboard:
        if keyboard.active and not options.quiet:
            print(KEYS, file=sys.stderr)
        with Progress(playback, quiet=options.quiet) as progress:

            def turn() -> None:
                for key in keyboard.typed():
                    controls.press(key)
                progress.show()

            play(player, executor, playback, turn)
    missing = player.unacknowledged(options.wait_for_all_acked)
    if missing:
        print(f"not acknowledged by every reader: {', '.join(missing)}", file=sys.stderr)
    if reader.losses:
        print(f"{reader.path}: {reader.losses}", file=sys.stderr)
    if player.not_sent:
        print(f"{reader.path}: {player.not_sent} messages without content", file=sys.stderr)
    return 1 if reader.losses or missing or player.not_sent else 0


if __name__ == "__main__":
    raise SystemExit(main())
