"""Feeds thousands of frames through the live graph and watches what its processes take.

Every stage runs in a process of its own. The images are of several sizes and encodings, one in
fifty cannot be used, now and then many come at once, and a listener to a debug topic comes and
goes. Of every process the memory,
threads, file handles and shared-memory segments are sampled; a line through the resident memory
after the warm-up says how much it grows. Exit code 0: nothing grows.
"""

from __future__ import annotations

import argparse
import csv
import os
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from rclpy.executors import SingleThreadedExecutor
from sensor_msgs.msg import Image
from tqdm import tqdm

from geoprim_core._check import FloatArray
from geoprim_core.errors import GeoprimError
from geoprim_ros.domains import stay_apart
from geoprim_ros.endurance.feeder import Feeder
from geoprim_ros.endurance.images import frames
from geoprim_ros.endurance.processes import Processes
from geoprim_ros.endurance.resources import Drift, Sample, drift, sample
from geoprim_ros.spin import in_rclpy

STAGES = ("edges", "polygons", "ellipses")
ALSO = ("detector", "overlay", "recorder")
UNIT = 10_000  # growth is told by so many frames
_LISTENS = "debug/arcs"
_LISTEN_PERIOD = 400
# The queues shall have been as full as they can be before the growth is judged.
_BURST_PERIOD = 500


@dataclass
class Course:
    """The samples of one process.

    Attributes
    ----------
    frames, seconds : list
        How many frames had been sent, and when.
    samples : list of Sample
    """

    frames: list[int] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    samples: list[Sample] = field(default_factory=list)

    def of(self, name: str) -> FloatArray:
        """Return the course of one quantity."""
        return np.array([getattr(s, name) for s in self.samples], float)

    def after(self, warm_up: int) -> Course:
        """Return the part from some frame on."""
        first = int(np.searchsorted(self.frames, warm_up))
        return Course(self.frames[first:], self.seconds[first:], self.samples[first:])

    def growth(self, name: str = "resident") -> Drift:
        """Return the growth of a quantity in `UNIT` frames."""
        return drift(np.array(self.frames, float) / UNIT, self.of(name))

    def risen(self, name: str) -> int:
        """Return by how much the median of the last third exceeds that of the first third."""
        values, third = self.of(name), max(1, len(self.samples) // 3)
        return round(float(np.median(values[-third:]) - np.median(values[:third])))


def problems(course: Course, limit_mb: float) -> list[str]:
    """Return what grows in a process after its warm-up; empty where nothing does."""
    if len(course.samples) < 3:
        return ["ended early"]
    growth = course.growth()
    found = []
    if growth.slope + 2 * growth.error >= limit_mb:
        found.append(f"memory {growth.slope:+.2f} ± {growth.error:.2f} MB in {UNIT} frames")
    for name in ("threads", "handles", "segments"):
        if course.risen(name) > 0:
            found.append(f"{course.risen(name)} more {name}")
    return found


def soak(
    feeder: Feeder, processes: Processes, count: int, every: int, seed: int
) -> dict[str, Course]:
    """Feed `count` frames and return the courses of the processes, sampled every few frames."""
    courses: dict[str, Course] = {name: Course() for name in processes.numbers()}
    courses["this one"] = Course()
    source, start = frames(seed), time.monotonic()
    with tqdm(total=count, unit="frame", desc="soak", disable=None) as bar:
        for number in range(0, count, every):
            if number % _LISTEN_PERIOD == 0:
                _come_or_go(feeder, number // _LISTEN_PERIOD)
            burst = number and number % _BURST_PERIOD == 0  # not first: it counts from there
            give = feeder.burst if burst else feeder.feed
            give(source, min(every, count - number))
            pids = processes.numbers() | {"this one": os.getpid()}
            _note(courses, pids, number + every, time.monotonic() - start)
            bar.update(min(every, count - number))
            if processes.ended() or not feeder.context.ok():
                break
    feeder.drain()
    feeder.turn_for(2.5)  # the statistics come once a second
    return courses


def _come_or_go(feeder: Feeder, turn: int) -> None:
    if turn % 2:
        feeder.hear(_LISTENS, Image)
    elif turn:
        feeder.turn_away(_LISTENS)


def _note(courses: dict[str, Course], pids: dict[str, int], frame: int, seconds: float) -> None:
    for name, pid in pids.items():
        found = sample(pid)
        if found is not None:
            courses[name].frames.append(frame)
            courses[name].seconds.append(seconds)
            courses[name].samples.append(found)


def table(courses: dict[str, Course], warm_up: int, limit_mb: float) -> str:
    """Return the table of the courses, a row a process."""
    lines = [
        f"| process | resident [MB] | growth in {UNIT} frames [MB] | of its own [MB] | threads "
        "| handles | segments | verdict |",
        "|---|---:|---:|---:|---:|---:|---:|---|",
    ]
    for name, whole in courses.items():
        course = whole.after(warm_up)
        if len(course.samples) < 3:
            lines.append(f"| {name} | | | | | | | ended early |")
            continue
        first, last = course.samples[0], course.samples[-1]
        resident, own = course.growth(), course.growth("anonymous")
        counts = [
            f"{getattr(first, n)} -> {getattr(last, n)}" for n in ("threads", "handles", "segments")
        ]
        lines.append(
            f"| {name} | {first.resident:.1f} -> {last.resident:.1f} "
            f"| {resident.slope:+.3f} ± {resident.error:.3f} | {own.slope:+.3f} ± {own.error:.3f} "
            f"| {' | '.join(counts)} | {'; '.join(problems(course, limit_mb)) or 'flat'} |"
        )
    return "\n".join(lines)


def write_csv(path: Path, courses: dict[str, Course]) -> None:
    """Write every sample as a row."""
    with path.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["process", "frame", "seconds", *Sample._fields])
        for name, course in courses.items():
            for frame, seconds, values in zip(
                course.frames, course.seconds, course.samples, strict=True
            ):
                numbers = [round(v, 3) for v in values]
                rows.writerow([name, frame, round(seconds, 2), *numbers])


def draw(path: Path, courses: dict[str, Course], warm_up: int) -> None:
    """Draw the resident memory of every process over the frames, with the fitted line."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 1.7 * len(courses) + 0.8), layout="constrained")
    axes = np.atleast_1d(figure.subplots(len(courses), 1, sharex=True))
    for axis, (name, course) in zip(axes, courses.items(), strict=True):
        part = course.after(warm_up)
        axis.plot(course.frames, course.of("resident"), lw=1.0, color="tab:blue")
        if len(part.samples) >= 3:
            line = part.growth()
            x = np.array([part.frames[0], part.frames[-1]])
            label = f"{line.slope:+.2f} ± {line.error:.2f} MB in {UNIT} frames"
            axis.plot(x, line.start + line.slope * x / UNIT, color="tab:red", label=label)
            axis.legend(loc="lower right", fontsize=8)
            middle = float(np.median(part.of("resident")))
            axis.set_ylim(middle - 10, middle + 10)
        axis.axvline(warm_up, color="0.7", ls=":")
        axis.set_ylabel(f"{name}\n[MB]")
        axis.grid(alpha=0.3)
    axes[-1].set_xlabel("frames sent (dotted: end of the warm-up)")
    figure.suptitle("Resident memory")
    figure.savefig(path, dpi=110)


def start_graph(processes: Processes, also: Sequence[str], folder: Path) -> list[str]:
    """Start the three stages and what else is asked for; return the stages' names as nodes."""
    for stage in STAGES:
        processes.start(stage, f"{stage}_node")
    for name in also:
        if name == "recorder":
            words: list[str | Path] = [folder / "soak.mcap", "--topics", "ellipses", "detections"]
            processes.start(name, "bag_recorder", words)
        elif name == "detector":
            space = ["--ros-args", "-r", "__ns:=/whole", "-r", "image:=/image"]
            processes.start(name, "detector_node", [*space, "-p", "lazy:=false"])
        else:
            processes.start(name, "overlay_node", ["--ros-args", "-p", "lazy:=false"])
    return [f"{stage}_node" for stage in STAGES]


def main(args: Sequence[str] | None = None) -> int:
    """Run the soak; 0 where nothing grows, every frame is accounted for and all end well."""
    options = _parser().parse_args(args)
    stay_apart()
    options.output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        return _run(options, Path(folder))


def _run(options: argparse.Namespace, folder: Path) -> int:
    processes = Processes(folder)
    courses: dict[str, Course] = {}
    told: dict[str, Any] = {}

    def work(executor: SingleThreadedExecutor, nodes: list[Any]) -> int:
        feeder = Feeder(executor)
        nodes.append(feeder)
        feeder.wait_for(start_graph(processes, options.also, folder))
        courses.update(soak(feeder, processes, options.frames, options.every, options.seed))
        told.update(feeder.told, sent=feeder.sent, answered=feeder.answered)
        told.update(published=feeder.published)
        return 0

    code, early = 2, {}
    try:
        code = in_rclpy(work, ())
        early = processes.ended()
    finally:
        codes = processes.end_all()
        for name in [n for n, c in codes.items() if c]:
            print(f"{name}: {processes.said(name)[-2000:]}", file=sys.stderr)
    return code or _report(options, courses, told, codes, early)


def _report(
    options: argparse.Namespace,
    courses: dict[str, Course],
    told: dict[str, Any],
    codes: dict[str, int],
    early: dict[str, int],
) -> int:
    write_csv(options.output / "soak.csv", courses)
    draw(options.output / "soak.png", courses, options.warm_up)
    print(table(courses, options.warm_up, options.limit))
    print(f"\n{told['answered']} of {told['sent']} good frames answered; as the stages tell:")
    for stage in STAGES:
        values = told.get(f"{stage}_node", {})
        print(f"  {stage}: " + ", ".join(f"{k} {values.get(k)}" for k in _TOLD))
    first = told.get("edges_node", {})
    counted = sum(int(first.get(k, 0)) for k in ("frames in", "dropped"))
    print(f"{told['published']} frames published, {counted} counted")
    print(f"exit codes: {codes}; results in {options.output}")
    grown = [n for n, c in courses.items() if problems(c.after(options.warm_up), options.limit)]
    return 1 if grown or early or any(codes.values()) else 0


_TOLD = ("frames in", "frames out", "dropped", "bad", "unpaired")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="geoprim_ros.endurance.soak", description=__doc__)
    parser.add_argument("--frames", type=int, default=20_000)
    parser.add_argument("--warm-up", type=int, default=4_000, help="frames that are not judged")
    parser.add_argument("--every", type=int, default=50, help="frames between two samples")
    parser.add_argument(
        "--limit", type=float, default=1.0, help=f"growth that is refused, MB in {UNIT} frames"
    )
    parser.add_argument("--also", nargs="*", choices=ALSO, default=(), help="processes beside")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--output", type=Path, default=Path("output", "soak"))
    return parser


if __name__ == "__main__":
    try:
        raise SystemExit(main())
    except GeoprimError as problem:
        print(problem, file=sys.stderr)
        raise SystemExit(2) from None
