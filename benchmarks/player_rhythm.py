"""How well the bag player keeps the rhythm of a recording, seen from another process.

A bag of images is written, the player plays it in a process of its own, and this one subscribes.
A row is one run. The error of a frame is the time since the first frame less what the bag and
the rate say, *sent* by the stamp of the middleware, *received* by the clock of this process;
*interval* is the same between neighbours. *Bare sleep* is how late a thread that only sleeps wakes
up at the same times: what the machine itself does to the rhythm. All in milliseconds.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import Image
from tqdm import tqdm

from geoprim_core.io.bags import BagWriter
from geoprim_core.io.image_message import image_record
from geoprim_ros.domains import stay_apart
from geoprim_ros.spin import in_rclpy
from geoprim_ros.stage_node import result_qos

HEAD = "| image | rate | frames | sent: mean | sd | worst | interval sd | received: mean | sd \
| bare sleep: mean | sd |"
START_NS = 1_700_000_000_000_000_000
SETTLED_S = 2.0


def main() -> None:
    """Run every size at every rate and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=500)
    parser.add_argument("--hz", type=float, default=30.0, help="rate of the recording")
    parser.add_argument("--rates", type=float, nargs="+", default=[1.0, 4.0])
    parser.add_argument("--channels", type=int, nargs="+", default=[1, 3], choices=[1, 3])
    options = parser.parse_args()
    stay_apart()
    print(HEAD + "\n" + "|---|" + "---:|" * (HEAD.count("|") - 2))
    with tempfile.TemporaryDirectory() as folder:
        for channels in options.channels:
            bag = Path(folder, f"{channels}.mcap")
            write_bag(bag, channels, options.frames, round(1e9 / options.hz))
            for rate in options.rates:
                print(row(bag, channels, rate, options.hz), flush=True)


def write_bag(path: Path, channels: int, frames: int, step_ns: int) -> None:
    """Write noisy 640x480 images, which compress as badly as those of a camera."""
    noise = np.random.default_rng(0).integers(0, 60, (480, 640, channels), dtype=np.uint8)
    with BagWriter(path) as bag:
        for i in tqdm(range(frames), desc="writing", leave=False, disable=None):
            image = np.squeeze(np.roll(noise, i, axis=0))
            bag.write("image", image_record(image, START_NS + i * step_ns, "camera"))


def row(bag: Path, channels: int, rate: float, hz: float) -> str:
    """Play once and return the row of the table."""
    sent: list[int] = []
    received: list[int] = []
    stamps: list[int] = []

    def receive(data: bytes, info: dict[str, Any]) -> None:
        received.append(time.monotonic_ns())
        sent.append(info["source_timestamp"])
        sec, nanosec = np.frombuffer(data[4:12], dtype="<u4")
        stamps.append(int(sec) * 10**9 + int(nanosec))

    late: list[float] = []
    stop = threading.Event()
    sleeper = threading.Thread(target=_sleep, args=(1 / (hz * rate), stop, late))
    sleeper.start()
    try:
        in_rclpy(lambda executor, nodes: _listen(executor, nodes, receive, bag, rate), ())
    finally:
        stop.set()
        sleeper.join()
    due = (np.array(stamps) - stamps[0]) / rate
    out, arrived = ((np.array(t) - t[0] - due) * 1e-6 for t in (sent, received))
    kind = "640x480 mono8" if channels == 1 else "640x480 bgr8"
    return (
        f"| {kind} | {rate:g} | {len(stamps)} | {out.mean():.3f} | {out.std():.3f} "
        f"| {abs(out).max():.2f} | {np.diff(out).std():.3f} "
        f"| {arrived.mean():.3f} | {arrived.std():.3f} "
        f"| {np.mean(late):.3f} | {np.std(late):.3f} |"
    )


def _sleep(step_s: float, stop: threading.Event, late: list[float]) -> None:
    due = time.monotonic()
    while not stop.is_set():
        due += step_s
        time.sleep(max(0.0, due - time.monotonic()))
        late.append((time.monotonic() - due) * 1e3)


def _listen(
    executor: SingleThreadedExecutor, nodes: list[Node], receive: Any, bag: Path, rate: float
) -> int:
    node = Node("rhythm")
    nodes.append(node)
    executor.add_node(node)
    node.create_subscription(Image, "image", receive, result_qos(50), raw=True)
    words = ["-m", "geoprim_ros.nodes.bag_player", str(bag), "--rate", str(rate)]
    player = subprocess.Popen([sys.executable, *words, "--wait-for-readers", "1"])
    ended = float("inf")
    while time.monotonic() < ended + SETTLED_S:
        executor.spin_once(timeout_sec=0.05)
        if player.poll() is not None:
            ended = min(ended, time.monotonic())
    return int(player.returncode)


if __name__ == "__main__":
    main()
