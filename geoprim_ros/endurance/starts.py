"""Starts and ends nodes many times, with SIGINT and SIGTERM in turns, some while frames flow.

Single stages, the composed pipeline, the player and the recorder, a few at a time. Each must end
with code 0 and without a traceback. Exit code 0: all did.
"""

from __future__ import annotations

import argparse
import signal
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from geoprim_msgs.msg import Contours, Detections, Polygons
from rclpy.executors import SingleThreadedExecutor
from sensor_msgs.msg import Image
from tqdm import tqdm

from geoprim_core.errors import BagError
from geoprim_ros.domains import stay_apart
from geoprim_ros.endurance.feeder import Feeder
from geoprim_ros.endurance.images import Frame, frames
from geoprim_ros.endurance.kills import write_bag
from geoprim_ros.endurance.processes import SIGNALS, Processes
from geoprim_ros.shared_memory import unowned
from geoprim_ros.spin import TAKE_DOWN_S, in_rclpy

_START_LIMIT_S = 240.0
_GONE_LIMIT_S = 60.0
_HZ = 20.0
# At once, amid the first frames, amid a steady flow.
_LIVES_S = (0.0, 0.2, 1.0)
_HEARD = {"contours": Contours, "polygons": Polygons, "detections": Detections, "overlay": Image}


class Kind(NamedTuple):
    """What is started: its module and words, and the node whose presence says that it is up."""

    module: str
    words: tuple[str, ...]
    node: str


KINDS = {
    "edges": Kind("edges_node", (), "edges_node"),
    "polygons": Kind("polygons_node", (), "polygons_node"),
    "ellipses": Kind("ellipses_node", (), "ellipses_node"),
    "detector": Kind("detector_node", (), "detector_node"),
    "overlay": Kind("overlay_node", (), "overlay_node"),
    "lifecycle_detector": Kind("lifecycle_detector", (), "lifecycle_detector"),
    "pipeline": Kind("pipeline", (), "edges_node"),  # the last of the three to be made
    "pipeline of two": Kind(
        "pipeline", ("--stages", "detector:whole", "overlay:whole"), "detector_node"
    ),
    "player": Kind("bag_player", ("BAG", "--loop", "--quiet"), "bag_player"),
    "recorder": Kind("bag_recorder", ("OUTPUT", "--topics", "contours", "image"), "bag_recorder"),
}


class Start(NamedTuple):
    """One start: what, how it ends, and how long it lives once it is up."""

    kind: str
    signal: int
    life_s: float


@dataclass
class Tally:
    """What came of the starts.

    Attributes
    ----------
    codes : exit codes by kind and signal
    faults : what went wrong
    slowest_s : the longest end
    late : number of ends that took as long as a middleware that hangs is given
    """

    codes: dict[tuple[str, int], list[int]] = field(default_factory=dict)
    faults: list[str] = field(default_factory=list)
    slowest_s: float = 0.0
    late: int = 0

    def add(self, start: Start, code: int, said: str, seconds: float) -> None:
        """Note how one ended."""
        self.codes.setdefault((start.kind, start.signal), []).append(code)
        self.slowest_s = max(self.slowest_s, seconds)
        self.late += seconds >= TAKE_DOWN_S
        if code or "Traceback" in said:
            name = signal.Signals(start.signal).name
            self.faults.append(f"{start.kind}, {name}, code {code}: {said[-500:]}")

    def table(self) -> str:
        """Return a row a kind: how many of how many ended with code 0."""
        lines = ["| started | SIGINT | SIGTERM |", "|---|---:|---:|"]
        for kind in dict.fromkeys(k for k, _ in self.codes):
            cells = [self.codes.get((kind, number), []) for number in SIGNALS]
            texts = [f"{cell.count(0)} of {len(cell)}" for cell in cells]
            lines.append(f"| {kind} | {' | '.join(texts)} |")
        return "\n".join(lines)


def plan(count: int, kinds: Sequence[str]) -> list[Start]:
    """Return the starts: every kind in turn, every signal and life with each of them.

    Examples
    --------
    >>> [(s.signal.name, s.life_s) for s in plan(6, ["edges"])][:3]
    [('SIGINT', 0.0), ('SIGTERM', 0.2), ('SIGINT', 1.0)]
    """
    rounds = [divmod(i, len(kinds)) for i in range(count)]
    return [
        Start(kinds[k], SIGNALS[turn % 2], _LIVES_S[turn % len(_LIVES_S)]) for turn, k in rounds
    ]


def start_and_end(
    feeder: Feeder,
    processes: Processes,
    batch: Sequence[Start],
    source: Iterator[Frame],
    place: Path,
) -> Iterator[tuple[Start, int, str, float]]:
    """Start some, let frames flow, end them; yield exit code, output and seconds of each."""
    names = {f"{start.kind} {time.monotonic_ns()}": start for start in batch}
    nodes = {KINDS[start.kind].node for start in batch}
    feeder.wait(lambda: not nodes & set(feeder.get_node_names()), _GONE_LIMIT_S, "the last ones go")
    for name, start in names.items():
        files = {"BAG": place / "frames.mcap", "OUTPUT": place / f"{time.monotonic_ns()}.mcap"}
        kind = KINDS[start.kind]
        processes.start(name, kind.module, [files.get(word, word) for word in kind.words])
    end = time.monotonic() + _START_LIMIT_S
    while not nodes <= set(feeder.get_node_names()) and not processes.ended():
        feeder.feed_at(source, _HZ, 0.1)
        if time.monotonic() > end:
            raise BagError(f"{', '.join(nodes)}: not up within {_START_LIMIT_S:g} s")
    feeder.feed_at(source, _HZ, max(start.life_s for start in batch))
    for name, start in names.items():
        begun = time.monotonic()
        code = processes.end(name, start.signal)
        yield start, code, processes.said(name), time.monotonic() - begun


def run(count: int, together: int, kinds: Sequence[str], seed: int = 1) -> int:
    """Run the trial, print the table and return the exit code."""
    tally, before = Tally(), unowned()
    with tempfile.TemporaryDirectory() as folder:
        processes, place = Processes(Path(folder)), Path(folder)
        write_bag(place / "frames.mcap")

        def work(executor: SingleThreadedExecutor, nodes: list[Any]) -> int:
            feeder = Feeder(executor)
            nodes.append(feeder)
            for topic, kind in _HEARD.items():
                feeder.hear(topic, kind)
            starts, source = plan(count, kinds), frames(seed)
            with tqdm(total=count, unit="start", disable=None) as bar:
                for i in range(0, count, together):
                    batch = starts[i : i + together]
                    for outcome in start_and_end(feeder, processes, batch, source, place):
                        tally.add(*outcome)
                        bar.update()
            return 0

        try:
            code = in_rclpy(work, ())
        finally:
            processes.end_all()
    print(tally.table())
    print(f"longest end {tally.slowest_s:.1f} s, {tally.late} by the deadline of the take-down")
    print(f"shared memory: {len(unowned() - before)} segments left")
    for fault in tally.faults:
        print(fault, file=sys.stderr)
    return code or int(bool(tally.faults))


def main(args: Sequence[str] | None = None) -> int:
    """Start and end the nodes; see the module."""
    parser = argparse.ArgumentParser(prog="geoprim_ros.endurance.starts", description=__doc__)
    parser.add_argument("--count", type=int, default=200, help="starts in all")
    parser.add_argument("--together", type=int, default=2, help="so many at a time")
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS))
    options = parser.parse_args(args)
    stay_apart()
    return run(options.count, options.together, options.kinds)


if __name__ == "__main__":
    raise SystemExit(main())
