"""Kills every node of a live graph with `kill -9`, one after the other, and starts it again.

A player, the three stages, the detector, the overlay, a recorder and a listener run in processes
of their own. After each kill the others must stay, and after the new start every output must flow
again. At the end all must end with code 0 and the killed recorder's bag must be readable. Exit
code 0: so it was.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geoprim_msgs.msg import Contours, Detections, EllipseDetections, Polygons
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import Image
from tqdm import tqdm

from geoprim_core.errors import BagError, GeoprimError
from geoprim_core.io.bag_repair import repair_bag
from geoprim_core.io.bag_writer import BagWriter
from geoprim_core.io.image_message import image_record
from geoprim_core.synthetic import disc_image
from geoprim_ros.domains import stay_apart
from geoprim_ros.endurance.processes import Processes
from geoprim_ros.qos import result_qos, sensor_qos
from geoprim_ros.shared_memory import clean, unowned
from geoprim_ros.spin import in_rclpy

VICTIMS = (
    "edges", "polygons", "ellipses", "player", "recorder", "overlay", "detector", "listener",
)  # fmt: skip
_FLOWS: dict[str, Any] = {
    "image": Image,
    "contours": Contours,
    "polygons": Polygons,
    "ellipses": EllipseDetections,
    "detections": Detections,
    "overlay": Image,
    "whole/ellipses": EllipseDetections,
}
_RECORDS = ("recorder", "listener")
_RESULTS = ("ellipses", "detections")
_START_LIMIT_S = 240.0  # kernels may compile
_FLOW_LIMIT_S = 90.0
_FRAMES, _HZ = 60, 12.0


class Watcher(Node):  # type: ignore[misc]
    """Notes when something came last on every topic, and when a recorder wrote something."""

    def __init__(self, executor: SingleThreadedExecutor) -> None:
        super().__init__("watcher")
        executor.add_node(self)
        self._executor = executor
        self.last = dict.fromkeys((*_FLOWS, *_RECORDS), 0.0)
        self._written = dict.fromkeys(_RECORDS, 0)
        for topic, kind in _FLOWS.items():
            qos = sensor_qos(1) if topic == "image" else result_qos()
            self.create_subscription(kind, topic, partial(self._came, topic), qos, raw=True)
        self.create_subscription(DiagnosticArray, "/diagnostics", self._note, 50)

    def turn_for(self, seconds: float) -> None:
        """Take what comes for some time."""
        end = time.monotonic() + seconds
        while self.context.ok() and time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.05)

    def wait_for_all(self, since: float, limit_s: float) -> float:
        """Wait until everything flows after some moment; return how long after it that was.

        Raises
        ------
        BagError
            Something does not flow in time.
        """
        while still := [name for name, at in self.last.items() if at <= since]:
            if time.monotonic() - since > limit_s:
                raise BagError(f"nothing comes on {', '.join(still)} after {limit_s:g} s")
            self.turn_for(0.05)
        return max(self.last.values()) - since

    def _came(self, topic: str, data: bytes) -> None:
        self.last[topic] = time.monotonic()

    def _note(self, message: Any) -> None:
        for status in message.status:
            name = status.name.split(":")[0]
            count = next((int(v.value) for v in status.values if v.key == "messages"), 0)
            if name in self._written and count != self._written[name]:
                # Less than before where it was started anew: it may have written nothing yet.
                if count > self._written[name]:
                    self.last[name] = time.monotonic()
                self._written[name] = count


@dataclass
class Outcome:
    """What happened after a kill.

    Attributes
    ----------
    victim : name of the node
    gone_with_it : others that ended
    resumed_s : from the new start until everything flowed again
    faults : what went wrong
    """

    victim: str
    gone_with_it: dict[str, int] = field(default_factory=dict)
    resumed_s: float = float("nan")
    faults: list[str] = field(default_factory=list)

    def row(self) -> str:
        """Return the row of the table."""
        others = ", ".join(f"{n} ({c})" for n, c in self.gone_with_it.items()) or "stay"
        said = "; ".join(self.faults) or "ok"
        return f"| {self.victim} | {others} | {self.resumed_s:.1f} | {said} |"


class Trial:
    """A graph and what is done to it."""

    def __init__(self, processes: Processes, watcher: Watcher, folder: Path) -> None:
        self._processes, self._watcher, self._folder = processes, watcher, folder
        self._started: dict[str, int] = {}
        self.bags: list[Path] = []
        write_bag(folder / "frames.mcap")

    def start(self, name: str) -> None:
        """Start a node of the graph; a recorder writes a bag of its own every time."""
        self._started[name] = self._started.get(name, 0) + 1
        words: dict[str, list[str | Path]] = {
            "player": [self._folder / "frames.mcap", "--loop", "--quiet"],
            "detector": ["--ros-args", "-r", "__ns:=/whole", "-r", "image:=/image"],
        }
        if name in _RECORDS:
            bag = self._folder / f"{name}_{self._started[name]}.mcap"
            self.bags.append(bag)
            renamed = ["--ros-args", "-r", f"__node:={name}"]
            words[name] = [bag, "--topics", *_RESULTS, *renamed]
        modules = {"player": "bag_player"} | dict.fromkeys(_RECORDS, "bag_recorder")
        self._processes.start(name, modules.get(name, f"{name}_node"), words.get(name, ()))

    def kill(self, name: str, pause_s: float) -> Outcome:
        """Kill a node, start it again after a while, wait until all flows."""
        outcome = Outcome(name)
        self._processes.kill(name)
        self._watcher.turn_for(pause_s)
        moment = time.monotonic()
        self.start(name)
        try:
            outcome.resumed_s = self._watcher.wait_for_all(moment, _FLOW_LIMIT_S)
        except BagError as problem:
            outcome.faults.append(str(problem))
        outcome.gone_with_it = self._processes.ended()
        for other in outcome.gone_with_it:
            outcome.faults.append(f"{other} said: {self._processes.said(other)[-300:]}")
            self._processes.kill(other)
            self.start(other)
        return outcome


def write_bag(path: Path) -> None:
    """Write a short bag of images for the player."""
    with BagWriter(path) as bag:
        for i in range(_FRAMES):
            image = disc_image(320, 240, centre=(100.0 + i, 120.0), radius=50.0)
            bag.write("image", image_record(image, 10**9 + round(i * 1e9 / _HZ), "camera"))


def unreadable(bags: Sequence[Path]) -> list[str]:
    """Repair every bag and return what is wrong with those that hold nothing."""
    found = []
    for bag in bags:
        try:
            report = repair_bag(bag)
            if not report.messages:
                found.append(f"{bag.name} holds no message")
        except GeoprimError as problem:
            found.append(str(problem))
    return found


def run(victims: Sequence[str], rounds: int, pause_s: float) -> int:
    """Run the trial, print the table and return the exit code."""
    outcomes: list[Outcome] = []
    faults: list[str] = []
    before = unowned()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        processes = Processes(folder)

        def work(executor: SingleThreadedExecutor, nodes: list[Any]) -> int:
            watcher = Watcher(executor)
            nodes.append(watcher)
            trial = Trial(processes, watcher, folder)
            moment = time.monotonic()
            for name in VICTIMS:
                trial.start(name)
            watcher.wait_for_all(moment, _START_LIMIT_S)
            for victim in tqdm([v for _ in range(rounds) for v in victims], disable=None):
                outcomes.append(trial.kill(victim, pause_s))
            watcher.turn_for(1.0)
            codes = processes.end_all()
            faults.extend(f"{n} ended with {c}" for n, c in codes.items() if c)
            faults.extend(unreadable(trial.bags))
            return 0

        try:
            code = in_rclpy(work, ())
        finally:
            processes.end_all()
    print(table(outcomes))
    print(_memory(before))
    for fault in faults:
        print(fault, file=sys.stderr)
    return code or int(bool(faults) or any(o.faults for o in outcomes))


def table(outcomes: Sequence[Outcome]) -> str:
    """Return the table of the outcomes."""
    head = "| killed | the others | all flows again after [s] | verdict |\n|---|---|---:|---|"
    return "\n".join([head, *(outcome.row() for outcome in outcomes)])


def _memory(before: set[str]) -> str:
    left = unowned() - before
    clean(settled_s=0.0)
    return f"shared memory: {len(left)} segments left by what was killed, {len(unowned())} now"


def main(args: Sequence[str] | None = None) -> int:
    """Kill every node, or those that are named."""
    parser = argparse.ArgumentParser(prog="geoprim_ros.endurance.kills", description=__doc__)
    parser.add_argument("victims", nargs="*", metavar="NODE", help=f"of {', '.join(VICTIMS)}")
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--pause", type=float, default=1.0, help="seconds from kill to start")
    options = parser.parse_args(args)
    unknown = sorted(set(options.victims) - set(VICTIMS))
    if unknown:
        parser.error(f"{', '.join(unknown)}: not one of {', '.join(VICTIMS)}")
    stay_apart()
    return run(options.victims or VICTIMS, options.rounds, options.pause)


if __name__ == "__main__":
    raise SystemExit(main())
