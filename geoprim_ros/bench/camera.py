"""The camera of the measurement: publishes images at a rate and takes the time of the answers.

A process of its own, as the Fast DDS profile is read once a process. It reads what to do, one JSON
object a line, from its standard input, and writes what it measured likewise:
`{"rate": 30, "frames": 180, "pids": {"edges_node": 4711}}`.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from geoprim_msgs.msg import EllipseDetections
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import CompressedImage, Image

from geoprim_core.errors import GeoprimError
from geoprim_core.io.image_message import image_to_fields
from geoprim_core.io.record import Record, stamp_of
from geoprim_ros.bench.pictures import load
from geoprim_ros.bench.runs import OTHERS
from geoprim_ros.conversions import to_message
from geoprim_ros.image_input import COMPRESSED
from geoprim_ros.spin import in_rclpy
from geoprim_ros.stage_node import result_qos

_START_LIMIT_S = 120.0  # a process may have to compile its kernels first
_TRIAL_S = 0.2
_TRIALS = 5
_TRIALS_LIMIT_S = 10.0  # where most images are lost on the way, some in a row may never be answered
_SILENCE_S = 1.5


class Camera(Node):  # type: ignore[misc]
    """Publishes images in turn; `answers` has stamp -> latency in nanoseconds."""

    def __init__(self, place: Path) -> None:
        super().__init__("bench_camera")
        self._messages = [message_of(picture) for picture in load(place)]
        raw = isinstance(self._messages[0], Image)
        kind, topic = (Image, "image") if raw else (CompressedImage, COMPRESSED)
        self._images = self.create_publisher(kind, topic, result_qos())
        self.create_subscription(EllipseDetections, "ellipses", self._on_answer, result_qos(100))
        self.sent: list[int] = []
        self.answers: dict[int, int] = {}
        self.last_answer = 0.0

    def send(self) -> None:
        """Publish the next image, stamped with the clock of the host."""
        message = self._messages[len(self.sent) % len(self._messages)]
        stamp = time.time_ns()
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, 1_000_000_000)
        self.sent.append(stamp)
        self._images.publish(message)

    def is_read(self) -> bool:
        """Tell whether a node, which has warmed its kernels then, reads the images."""
        return bool(self._images.get_subscription_count())

    def forget(self) -> None:
        """Begin anew."""
        self.sent.clear()
        self.answers.clear()

    def _on_answer(self, message: Any) -> None:
        stamp = stamp_of(message)
        if self.sent and stamp >= self.sent[0]:  # not one of the run before
            self.answers[stamp] = time.time_ns() - stamp
            self.last_answer = time.monotonic()


def message_of(picture: Any) -> Any:
    """Return the message of an array (H, W, 3), or of the bytes of a JPEG file."""
    if not isinstance(picture, bytes):
        return to_message(Record("sensor_msgs/msg/Image", image_to_fields(picture)))
    return CompressedImage(format="bgr8; jpeg compressed bgr8", data=picture)


def spin_to(executor: SingleThreadedExecutor, moment: float) -> None:
    """Serve answers until a moment of the monotonic clock."""
    while (left := moment - time.monotonic()) > 0:
        executor.spin_once(timeout_sec=left)


def wait_until_ready(camera: Camera, executor: SingleThreadedExecutor) -> None:
    """Wait for the graph and send slowly until it answers some images in a row.

    Raises
    ------
    GeoprimError
        Nobody reads the images.
    """
    limit = time.monotonic() + _START_LIMIT_S
    while not camera.is_read():
        if time.monotonic() > limit:
            raise GeoprimError(f"nobody reads the images within {_START_LIMIT_S:g} s")
        spin_to(executor, time.monotonic() + _TRIAL_S)
    limit = time.monotonic() + _TRIALS_LIMIT_S
    while len(camera.answers) < _TRIALS and time.monotonic() < limit:
        camera.send()
        spin_to(executor, time.monotonic() + _TRIAL_S)
        if camera.sent[-1] not in camera.answers:
            camera.forget()
    spin_to(executor, time.monotonic() + _TRIAL_S)


def measure(
    camera: Camera, executor: SingleThreadedExecutor, rate: float, frames: int, pids: dict[str, int]
) -> dict[str, Any]:
    """Send frames at a rate, wait for the answers, and return what was measured."""
    camera.forget()
    before, start = cpu_seconds(pids), time.monotonic()
    for number in range(frames):
        spin_to(executor, start + number / rate)
        camera.send()
    camera.last_answer = last_sent = time.monotonic()
    while len(camera.answers) < frames and time.monotonic() < camera.last_answer + _SILENCE_S:
        executor.spin_once(timeout_sec=0.05)
    took, after = camera.last_answer - start, cpu_seconds(pids)
    return {
        "rate": rate,
        "sent_rate": (frames - 1) / (last_sent - start),
        "sent": frames,
        "received": len(camera.answers),
        "latencies_ms": [ns * 1e-6 for ns in camera.answers.values()],
        "cpu": {name: 100.0 * (after[name] - before[name]) / took for name in after},
    }


def cpu_seconds(pids: Mapping[str, int]) -> dict[str, float]:
    """Return how long each process has had a core, this one as "camera", and all others together.

    Examples
    --------
    >>> cpu_seconds({"me": os.getpid()})["me"] > 0
    True
    """
    ticks = os.sysconf("SC_CLK_TCK")
    seconds = {}
    for name, pid in pids.items():
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        seconds[name] = (int(fields[11]) + int(fields[12])) / ticks
    seconds["camera"] = time.process_time()
    user, nice, system = Path("/proc/stat").read_text().split(maxsplit=4)[1:4]
    machine = (int(user) + int(nice) + int(system)) / ticks
    return {**seconds, OTHERS: machine - sum(seconds.values())}


def main(args: Sequence[str] | None = None) -> int:
    """Measure as the lines of the standard input say, until it ends."""
    (place,) = sys.argv[1:] if args is None else args

    def work(executor: SingleThreadedExecutor, nodes: list[Node]) -> int:
        camera = Camera(Path(place))
        nodes.append(camera)
        executor.add_node(camera)
        wait_until_ready(camera, executor)
        print(json.dumps({"ready": True}), flush=True)
        for line in sys.stdin:
            print(json.dumps(measure(camera, executor, **json.loads(line))), flush=True)
        return 0

    return in_rclpy(work, ())


if __name__ == "__main__":
    raise SystemExit(main())
