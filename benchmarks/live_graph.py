"""How fast the live three-node graph is: one rendered sequence at rising frame rates.

The graph runs in one process and the player in another, 640x480 bgr8, as in the demo. Every row
is one run: what was answered, what was dropped, and p50 / p95 of the latencies in milliseconds.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import Any

from rclpy.executors import SingleThreadedExecutor

from geoprim_core.io.bags import BagReader
from geoprim_ros.demo import DemoPlayer, run_scenario, scenarios_of
from geoprim_ros.demo_report import Scenario, percentiles_ms
from geoprim_ros.environment import config_folder
from geoprim_ros.spin import in_rclpy

ROOT = Path(__file__).resolve().parents[1]
NODES = ("edges_node", "polygons_node", "ellipses_node")
BAG_RATE_HZ = 15.0


def main() -> None:
    """Run the sequence at every rate and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bag", type=Path, default=ROOT / "bags" / "demo.mcap")
    parser.add_argument("--sequence", default="sorting_cans")
    parser.add_argument("--hz", type=float, nargs="+", default=[15.0, 30.0, 45.0, 60.0])
    options = parser.parse_args()
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    os.environ.setdefault("ROS_DOMAIN_ID", str(1 + os.getpid() % 100))
    folder = config_folder()
    assert folder is not None
    reader = BagReader(options.bag)
    chosen = next(s for s in scenarios_of(reader, folder) if options.sequence in s.sequences)
    print("| frames/s sent | answered | dropped | image -> objects | " + " | ".join(
        f"{node} hop" for node in NODES) + " |")  # fmt: skip
    print("|---:|---:|---:|---:|" + "---:|" * len(NODES))
    for hz in options.hz:
        print(row(reader, chosen, hz), flush=True)


def row(reader: BagReader, chosen: Scenario, hz: float) -> str:
    """Run once and return the row of the table."""
    scenario = Scenario(chosen.config, chosen.start_ns, chosen.end_ns, frames=chosen.frames)

    def work(executor: SingleThreadedExecutor, nodes: list[Any]) -> int:
        player = DemoPlayer(reader)
        nodes.append(player)
        executor.add_node(player)
        run_scenario(player, executor, scenario, hz / BAG_RATE_HZ, lossless=False, recorded=False)
        return 0

    in_rclpy(work, ())
    values = [scenario.diagnostics.get(node, {}) for node in NODES]
    hops = [
        f"{v.get('hop latency p50 [ms]', '?')} / {v.get('hop latency p95 [ms]', '?')}"
        for v in values
    ]
    p50, p95 = percentiles_ms(scenario.latencies())
    dropped = values[0].get("dropped", "?")
    return (
        f"| {hz:g} | {len(scenario.answered)} of {len(scenario.sent)} | {dropped} "
        f"| {p50:.1f} / {p95:.1f} | " + " | ".join(hops) + " |"
    )


if __name__ == "__main__":
    main()
