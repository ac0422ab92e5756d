"""The command line of the bag player."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from decimal import Decimal, InvalidOperation

from geoprim_ros.player_controls import KEYS
from geoprim_ros.selection import TopicFilter

CLOCK_HZ = 40.0
_EPILOG = f"{KEYS}\n\nROS arguments follow after --ros-args."


def parser(description: str) -> argparse.ArgumentParser:
    """Return the parser of the player's own arguments."""
    made = argparse.ArgumentParser(
        prog="bag_player", description=description, epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    made.add_argument("bag", help="an .mcap file or the folder of a rosbag2 recording")
    _add_topics(made.add_argument_group("topics"))
    _add_time(made.add_argument_group("time"))
    _add_readers(made.add_argument_group("readers"))
    made.add_argument(
        "--disable-keyboard-controls", action="store_true", help="leave the terminal alone"
    )
    made.add_argument("-q", "--quiet", action="store_true", help="show no progress bar")
    return made


def add_filter(group: argparse._ArgumentGroup, verb: str) -> None:
    """Add the arguments of a `TopicFilter`."""
    group.add_argument("--topics", nargs="+", default=[], help=f"{verb} these topics")
    group.add_argument(
        "-e", "--regex", default="", metavar="RE",
        help=f"{verb} also the topics that this is found in",
    )  # fmt: skip
    group.add_argument(
        "--exclude-topics", nargs="+", default=[], metavar="TOPIC", help="but not these"
    )
    group.add_argument(
        "-x", "--exclude-regex", default="", metavar="RE", help="nor those that this is found in"
    )


def filter_of(options: argparse.Namespace, topics: Sequence[str] | None = None) -> TopicFilter:
    """Return the choice of topics of a command line."""
    names = options.topics if topics is None else topics
    return TopicFilter(names, options.regex, options.exclude_topics, options.exclude_regex)


def add_overrides(group: argparse._ArgumentGroup) -> None:
    """Add the argument for a file of QoS overrides."""
    group.add_argument(
        "--qos-profile-overrides-path", metavar="FILE",
        help="YAML as of ros2 bag: topic, and below it reliability, durability, history, depth",
    )  # fmt: skip


def _add_topics(group: argparse._ArgumentGroup) -> None:
    add_filter(group, "play")
    group.add_argument(
        "-m", "--remap", nargs="+", default=[], type=remapping, metavar="OLD:=NEW",
        help="play a topic under another name; remaps of --ros-args come after that",
    )  # fmt: skip
    add_overrides(group)


def _add_time(group: argparse._ArgumentGroup) -> None:
    group.add_argument("-r", "--rate", type=positive, default=1.0, help="times the speed")
    group.add_argument("-l", "--loop", action="store_true", help="start again at the end")
    group.add_argument("-p", "--start-paused", action="store_true", help="wait for the order to go")
    group.add_argument(
        "--start-offset", type=not_negative, default=0.0, metavar="S",
        help="start this many seconds after the start of the bag; what latched topics published "
        "before comes first",
    )  # fmt: skip
    group.add_argument(
        "--duration", "--playback-duration", type=not_negative, metavar="S",
        help="play this many seconds of the bag",
    )  # fmt: skip
    group.add_argument(
        "--until", "--playback-until-sec", type=nanoseconds, metavar="STAMP",
        help="play up to this time, in seconds as the bag counts them",
    )  # fmt: skip
    group.add_argument(
        "--clock", type=positive, nargs="?", const=CLOCK_HZ, default=0.0, metavar="HZ",
        help=f"publish /clock at this rate (without a number {CLOCK_HZ:g}), also while paused",
    )  # fmt: skip


def _add_readers(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--wait-for-readers", type=int, default=0, metavar="N",
        help="wait until every image topic has N readers",
    )  # fmt: skip
    group.add_argument(
        "--wait-limit", type=positive, default=30.0, metavar="S",
        help="give up waiting for readers after this many seconds",
    )  # fmt: skip
    group.add_argument(
        "--wait-for-all-acked", type=not_negative, default=10.0, metavar="S",
        help="at the end wait so long for the acknowledgement of reliable readers (default 10)",
    )  # fmt: skip


def remapping(text: str) -> tuple[str, str]:
    """Return the two names of OLD:=NEW."""
    old, found, new = text.partition(":=")
    if not (old and found and new):
        raise argparse.ArgumentTypeError(f"expected OLD:=NEW, got {text}")
    return old, new


def positive(text: str) -> float:
    """Return a number above 0."""
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"expected a number above 0, got {text}")
    return value


def not_negative(text: str) -> float:
    """Return a number of at least 0."""
    value = float(text)
    if not 0 <= value < float("inf"):
        raise argparse.ArgumentTypeError(f"expected a number of at least 0, got {text}")
    return value


def nanoseconds(text: str) -> int:
    """Return seconds as nanoseconds, to the last digit."""
    try:
        return int(Decimal(text) * 1_000_000_000)
    except (InvalidOperation, OverflowError, ValueError):
        raise argparse.ArgumentTypeError(f"expected seconds, got {text}") from None
