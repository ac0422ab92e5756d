"""Node `bag_player`: plays an MCAP bag with its original stamps, as raw bytes, nothing decoded."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from typing import Any

from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos_overriding_options import QoSOverridingOptions
from rosgraph_msgs.msg import Clock
from tqdm import tqdm

from geoprim_core.errors import BagError, InputError
from geoprim_core.io.bags import IMAGE_TYPES, BagMessage, BagReader, Topic
from geoprim_ros.conversions import message_class
from geoprim_ros.spin import in_rclpy, split_ros_args
from geoprim_ros.stage_node import result_qos

# Deep enough that a reliable reader, which takes its time, still finds every frame.
_DEPTH = 50
_ACKNOWLEDGED_S = 10.0
# The last stretch before a message is slept, as the executor wakes up too late for it.
_SLEEP_S = 0.002


class BagPlayer(Node):  # type: ignore[misc]
    """Publishes the messages of a bag in the rhythm of their log times.

    Parameters
    ----------
    reader : the bag
    topics : what to play, all where it is empty
    clock_hz : rate of /clock, 0 for none

    Raises
    ------
    BagError
        A topic is missing or of a type that is not installed, or there is nothing to play.
    """

    def __init__(
        self, reader: BagReader, topics: Sequence[str] = (), clock_hz: float = 0.0, **options: Any
    ) -> None:
        super().__init__("bag_player", **options)
        self._reader = reader
        self._publishers_by_topic: dict[str, Any] = {}
        self.topics: list[Topic] = []
        chosen = [reader.topic(name) for name in topics] or list(reader.topics())
        for topic in chosen:
            self._advertise(topic, asked_for=bool(topics), own_clock=clock_hz > 0)
        if not self.topics:
            raise BagError(f"{reader.path} holds no message that can be played")
        self._clock = self.create_publisher(Clock, "/clock", 10) if clock_hz > 0 else None
        self._clock_period = 1.0 / clock_hz if clock_hz > 0 else float("inf")
        self._next_clock = 0.0

    @property
    def count(self) -> int:
        """Number of messages of one round."""
        return sum(topic.count for topic in self.topics)

    def messages(self) -> Iterator[BagMessage]:
        """Yield the messages to play in the order of their log times."""
        return self._reader.messages([topic.name for topic in self.topics])

    def waiting_for(self, readers: int) -> list[str]:
        """Return the image topics, or all where there is none, with too few readers."""
        images = [t.name for t in self.topics if t.type in IMAGE_TYPES]
        names = images or [t.name for t in self.topics]
        counts = {n: self._publishers_by_topic[n].get_subscription_count() for n in names}
        return [name for name in names if counts[name] < readers]

    def send(self, message: BagMessage) -> None:
        """Publish one message as it stands in the bag."""
        self._publishers_by_topic[message.topic].publish(message.raw)

    def tick(self, bag_time_ns: int) -> float:
        """Publish the bag's time on /clock when it is time; return the seconds to the next time."""
        now = time.monotonic()
        if self._clock is not None and now >= self._next_clock:
            clock = Clock()
            clock.clock.sec, clock.clock.nanosec = divmod(bag_time_ns, 1_000_000_000)
            self._clock.publish(clock)
            self._next_clock = now + self._clock_period
        return self._next_clock - now if self._clock is not None else float("inf")

    def wait_for_acknowledgements(self) -> None:
        """Wait until every reliable reader has all messages."""
        for publisher in self._publishers_by_topic.values():
            publisher.wait_for_all_acked(Duration(seconds=_ACKNOWLEDGED_S))

    def _advertise(self, topic: Topic, *, asked_for: bool, own_clock: bool) -> None:
        if not topic.count or (own_clock and topic.name.lstrip("/") == "clock"):
            return
        try:
            kind = message_class(topic.type)
        except InputError:
            if asked_for:
                raise BagError(f"topic {topic.name}: {topic.type} is not installed") from None
            self.get_logger().warning(f"topic {topic.name} is left out: no {topic.type} here")
            return
        self.topics.append(topic)
        self._publishers_by_topic[topic.name] = self.create_publisher(
            kind, topic.name, result_qos(_DEPTH),
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )  # fmt: skip


def play(
    player: BagPlayer,
    executor: SingleThreadedExecutor,
    *,
    rate: float = 1.0,
    start_offset_s: float = 0.0,
    bar: Any = None,
) -> int:
    """Play one round and return the number of messages sent; ends early at a shutdown."""
    sent, begin = 0, 0.0
    start: int | None = None
    for message in player.messages():
        if start is None:
            start = message.log_time_ns + round(start_offset_s * 1e9)
            begin = time.monotonic()
        if bar is not None:
            bar.update()
        if message.log_time_ns < start:
            continue
        due = begin + (message.log_time_ns - start) * 1e-9 / rate
        while (left := due - time.monotonic()) > 0:
            to_clock = player.tick(message.log_time_ns - round(left * rate * 1e9))
            if left > _SLEEP_S:
                executor.spin_once(timeout_sec=min(left - _SLEEP_S, max(to_clock, 0.0)))
            else:
                time.sleep(left)
        if not player.context.ok():
            return sent
        player.tick(message.log_time_ns)
        player.send(message)
        sent += 1
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
    options = _parser().parse_args(own)

    def work(executor: SingleThreadedExecutor, nodes: list[Node]) -> int:
        reader = BagReader(options.bag)
        player = BagPlayer(reader, options.topics, options.clock)
        nodes.append(player)
        executor.add_node(player)
        if options.wait_for_readers:
            wait_for_readers(player, executor, options.wait_for_readers, options.wait_limit)
        _play_rounds(player, executor, options)
        if reader.losses:
            print(f"{reader.path}: {reader.losses}", file=sys.stderr)
        return 1 if reader.losses else 0

    return in_rclpy(work, ros)


def _play_rounds(player: BagPlayer, executor: Any, options: argparse.Namespace) -> None:
    quiet = True if options.quiet else None  # None: quiet unless it is a terminal
    while True:
        with tqdm(total=player.count, unit="msg", desc="playing", disable=quiet) as bar:
            play(
                player, executor,
                rate=options.rate, start_offset_s=options.start_offset, bar=bar,
            )  # fmt: skip
        if not options.loop or not player.context.ok():
            break
    if player.context.ok():
        player.wait_for_acknowledgements()


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="bag_player", description=__doc__, epilog="ROS arguments follow after --ros-args."
    )
    parser.add_argument("bag", help="an .mcap file or the folder of a rosbag2 recording")
    parser.add_argument("-r", "--rate", type=_positive, default=1.0, help="times the speed")
    parser.add_argument("-l", "--loop", action="store_true", help="start again at the end")
    parser.add_argument(
        "--clock", type=_positive, nargs="?", const=40.0, default=0.0, metavar="HZ",
        help="publish /clock at this rate (without a number 40)",
    )  # fmt: skip
    parser.add_argument("--topics", nargs="+", default=[], help="play only these topics")
    parser.add_argument(
        "--start-offset", type=_not_negative, default=0.0, metavar="S",
        help="start this many seconds after the first message",
    )  # fmt: skip
    parser.add_argument(
        "--wait-for-readers", type=int, default=0, metavar="N",
        help="wait until every image topic has N readers",
    )  # fmt: skip
    parser.add_argument(
        "--wait-limit", type=_positive, default=30.0, metavar="S",
        help="give up waiting for readers after this many seconds",
    )  # fmt: skip
    parser.add_argument("-q", "--quiet", action="store_true", help="show no progress bar")
    return parser


def _positive(text: str) -> float:
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"expected a number above 0, got {text}")
    return value


def _not_negative(text: str) -> float:
    value = float(text)
    if not 0 <= value < float("inf"):
        raise argparse.ArgumentTypeError(f"expected a number of at least 0, got {text}")
    return value


if __name__ == "__main__":
    raise SystemExit(main())
