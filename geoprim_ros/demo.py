"""The main job on the demo bag: player -> edges -> polygons -> ellipses -> recorder, then pictures.

The three-node graph runs in one process, the recorder in another, the player in this one. The
graph is started once for every scenario, with the configuration file of that scenario.
"""

from __future__ import annotations

import argparse
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geoprim_msgs.msg import Detections
from rclpy.executors import SingleThreadedExecutor
from tqdm import tqdm

from geoprim_core.errors import BagError, GeoprimError
from geoprim_core.io.bags import BagMessage, BagReader
from geoprim_core.io.record import stamp_of
from geoprim_ros.demo_report import Scenario, report
from geoprim_ros.domains import stay_apart
from geoprim_ros.environment import config_folder
from geoprim_ros.nodes.bag_player import BagPlayer, play, wait_for_readers
from geoprim_ros.playback import Playback
from geoprim_ros.spin import in_rclpy
from geoprim_ros.stage_node import result_qos

RECORDED = ("contours", "polygons", "ellipses", "detections", "ground_truth")
STAGE_NODES = ("edges_node", "polygons_node", "ellipses_node")
LOSSLESS_DEPTH = 100
_START_LIMIT_S = 60.0
_ANSWER_LIMIT_S = 15.0


def scenarios_of(reader: BagReader, folder: Path) -> list[Scenario]:
    """Return the scenarios of a bag: neighbouring sequences with the same configuration file."""
    found: list[Scenario] = []
    for message in reader.messages(["camera_info"]):
        sequence = message.decoded.header.frame_id
        named = folder / f"{sequence}.yaml"
        config = str(named if named.is_file() else folder / "default.yaml")
        if not found or found[-1].config != config:
            found.append(Scenario(config, message.log_time_ns, message.log_time_ns))
        found[-1].end_ns = message.log_time_ns
        found[-1].frames += 1
        if sequence not in found[-1].sequences:
            found[-1].sequences.append(sequence)
    if not found:
        raise BagError(f"{reader.path} holds no sequence: no message on camera_info")
    return found


class DemoPlayer(BagPlayer):
    """A bag player that takes the time of the answers to the images of a scenario."""

    def __init__(self, reader: BagReader) -> None:
        super().__init__(reader)
        self.scenario: Scenario | None = None
        self._recorder: dict[str, str] = {}
        self.create_subscription(Detections, "detections", self._answer, result_qos(50))
        self.create_subscription(DiagnosticArray, "/diagnostics", self._note, 10)

    def send(self, message: BagMessage) -> None:
        """Publish one message; note the time where it is an image."""
        if self.scenario is not None and message.topic.lstrip("/") == "image":
            self.scenario.sent[message.log_time_ns] = time.perf_counter()
        super().send(message)

    def recorder_is_ready(self) -> bool:
        """Tell whether the recorder has met the publisher of every topic that it keeps."""
        met = [v for k, v in self._recorder.items() if k.startswith("publishers of")]
        return len(met) == len(RECORDED) and "0" not in met

    def graph_is_active(self) -> bool:
        """Tell whether every stage has heard of its listeners and reads its inputs."""
        told = self.scenario.diagnostics if self.scenario is not None else {}
        return all(told.get(node, {}).get("state") == "active" for node in STAGE_NODES)

    def _answer(self, message: Any) -> None:
        stamp = stamp_of(message)
        if self.scenario is not None and stamp in self.scenario.sent:
            self.scenario.answered[stamp] = time.perf_counter()

    def _note(self, message: Any) -> None:
        for status in message.status:
            node, values = status.name.split(":")[0], {p.key: p.value for p in status.values}
            if node == "bag_recorder":
                self._recorder = values
            elif self.scenario is not None:
                self.scenario.diagnostics[node] = values


def graph_arguments(scenario: Scenario, lossless: bool) -> list[str]:
    """Return the ROS arguments of the graph: the scenario's file, and reliable images on demand.

    A camera's images are read best effort with depth 1, and a late node drops; a replay on a busy
    machine shall lose nothing.
    """
    words = ["--ros-args", "--params-file", scenario.config]
    if lossless:
        start = "qos_overrides./image.subscription."
        words += ["-p", f"{start}reliability:=reliable", "-p", f"{start}depth:={LOSSLESS_DEPTH}"]
        words += ["-p", "max_waiting:=0"]
    return words


def run_scenario(
    player: DemoPlayer,
    executor: SingleThreadedExecutor,
    scenario: Scenario,
    rate: float,
    *,
    lossless: bool,
    recorded: bool = True,
) -> None:
    """Start the three-node graph with the scenario's file, play, wait for the last answer."""
    graph = start(["geoprim_ros.nodes.pipeline", *graph_arguments(scenario, lossless)])
    player.scenario = scenario
    try:
        wait_for_graph(player, executor, graph, recorded)
        title = Path(scenario.config).stem
        part = player.source.between(scenario.start_ns, scenario.end_ns)
        with tqdm(total=scenario.frames, unit="frame", desc=title, disable=None) as bar:
            play(
                player, executor, Playback(part, rate=rate),
                lambda: bar.update(len(scenario.sent) - bar.n),
            )  # fmt: skip
            bar.update(len(scenario.sent) - bar.n)
            limit = time.monotonic() + _ANSWER_LIMIT_S
            while len(scenario.answered) < len(scenario.sent) and time.monotonic() < limit:
                executor.spin_once(timeout_sec=0.05)
        settled = time.monotonic() + 1.1  # the statistics come once a second
        while time.monotonic() < settled:
            executor.spin_once(timeout_sec=0.05)
    finally:
        stop(graph, "the graph")
        player.scenario = None


def wait_for_graph(
    player: DemoPlayer,
    executor: SingleThreadedExecutor,
    graph: subprocess.Popen[bytes],
    recorded: bool,
) -> None:
    """Wait until the graph reads images and the recorder all results; raise where that fails."""
    end = time.monotonic() + _START_LIMIT_S
    while (
        player.waiting_for(1)
        or not player.graph_is_active()
        or (recorded and not player.recorder_is_ready())
    ):
        if graph.poll() is not None:
            raise BagError("the graph did not start; its reason stands above")
        if time.monotonic() > end:
            raise BagError(f"graph and recorder did not start within {_START_LIMIT_S:g} s")
        executor.spin_once(timeout_sec=0.1)
    wait_for_readers(player, executor, 1, 1.0)


def start(words: list[str]) -> subprocess.Popen[bytes]:
    """Start a module of ours in a process of its own."""
    return subprocess.Popen([sys.executable, "-m", *words])


def stop(process: subprocess.Popen[bytes], what: str) -> None:
    """End a process as Ctrl-C does; raise where it does not end well."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    try:
        code = process.wait(timeout=20.0)
    except subprocess.TimeoutExpired:
        process.kill()
        raise BagError(f"{what} did not end within 20 s and was killed") from None
    if code:
        raise BagError(f"{what} ended with exit code {code}; its reason stands above")


def run_graph(reader: BagReader, scenarios: list[Scenario], results: Path, rate: float) -> int:
    """Play every scenario through the live graph and record the results."""
    recorder = start(["geoprim_ros.nodes.bag_recorder", str(results), "--topics", *RECORDED])

    def work(executor: SingleThreadedExecutor, nodes: list[Any]) -> int:
        player = DemoPlayer(reader)
        nodes.append(player)
        executor.add_node(player)
        for scenario in scenarios:
            run_scenario(player, executor, scenario, rate, lossless=True)
        return 0

    try:
        return in_rclpy(work, ())
    finally:
        stop(recorder, "the recorder")


def main(args: Sequence[str] | None = None) -> int:
    """Run the demo; 0 where every frame was answered."""
    parser = argparse.ArgumentParser(prog="geoprim_ros.demo", description=__doc__)
    parser.add_argument("--bag", type=Path, required=True, help="the demo bag")
    parser.add_argument("--output", type=Path, default=Path("output", "demo"))
    parser.add_argument("--rate", type=float, default=1.0, help="times the speed (default 1)")
    options = parser.parse_args(args)
    try:
        stay_apart()
        folder = config_folder()
        if folder is None:
            raise BagError("the folder with the configuration files was not found")
        options.output.mkdir(parents=True, exist_ok=True)
        reader = BagReader(options.bag)
        scenarios = scenarios_of(reader, folder)
        results = options.output / "results.mcap"
        code = run_graph(reader, scenarios, results, options.rate)
        return code or report(reader, scenarios, results, options.output)
    except GeoprimError as problem:
        print(f"geoprim: {problem}", file=sys.stderr)
        return 2
    except OSError as problem:
        print(f"geoprim: {options.output}: {problem.strerror}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    raise SystemExit(main())
