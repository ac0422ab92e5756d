"""The processes of a case: the graph and the camera, started, asked and ended."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

from geoprim_core.errors import GeoprimError
from geoprim_ros.bench.cases import Case
from geoprim_ros.bench.runs import Run
from geoprim_ros.domains import private_domain
from geoprim_ros.environment import config_folder

_END_LIMIT_S = 20.0
_STOCK = """<dds xmlns="http://www.eprosima.com"><profiles>
<participant profile_name="stock" is_default_profile="true">
<rtps><useBuiltinTransports>true</useBuiltinTransports></rtps></participant></profiles></dds>
"""


class Bench:
    """The processes of one case, in a domain of their own on this machine; a context manager.

    Parameters
    ----------
    case : what to start
    place : the images, from `pictures.render`
    folder : for the log and the stock profile
    words : further ROS arguments of the graph, as `--params-file FILE`
    """

    def __init__(self, case: Case, place: Path, folder: Path, words: list[str]) -> None:
        self._log = folder / "log"
        self._environment = environment(case, folder)
        transport = ["-p", f"image_transport:={case.pictures.transport}"]
        ros = ["--ros-args", *words, *transport]
        self._graph = {
            module.rpartition(".")[2]: self._start(module, ros) for module in case.graph.modules
        }
        self._camera = self._start(
            "geoprim_ros.bench.camera", [str(place)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )

    def __enter__(self) -> Bench:
        """Wait until the graph answers."""
        try:
            self._answer()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        """End the processes as Ctrl-C does, and those that do not end by force."""
        self._camera.stdin.close()
        for process in self._graph.values():
            process.send_signal(signal.SIGINT)
        for process in (self._camera, *self._graph.values()):
            try:
                process.wait(_END_LIMIT_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        self._camera.stdout.close()

    def measure(self, rate: float, frames: int) -> Run:
        """Send so many frames at a rate and return what came back.

        Raises
        ------
        GeoprimError
            A process ended.
        """
        pids = {name: process.pid for name, process in self._graph.items()}
        order = {"rate": rate, "frames": frames, "pids": pids}
        try:
            self._camera.stdin.write(json.dumps(order) + "\n")
            self._camera.stdin.flush()
        except BrokenPipeError:
            pass  # the answer says why
        values = self._answer()
        return Run(**{**values, "latencies_ms": tuple(values["latencies_ms"])})

    def _answer(self) -> dict[str, Any]:
        # Fast DDS writes its own complaints to the standard output.
        line = next((text for text in self._camera.stdout if text.startswith("{")), "")
        ended = [name for name, process in self._graph.items() if process.poll() is not None]
        if line and not ended:
            values: dict[str, Any] = json.loads(line)
            return values
        said = self._log.read_text(errors="replace").strip().splitlines()[-3:]
        raise GeoprimError(f"{', '.join(ended) or 'the camera'} ended: {' '.join(said)}")

    def _start(self, module: str, words: list[str], **pipes: Any) -> Any:
        with self._log.open("a") as log:
            return subprocess.Popen(
                [sys.executable, "-m", module, *words],
                env=self._environment, stderr=log, text=True, **{"stdout": log, **pipes},
            )  # fmt: skip


def environment(case: Case, folder: Path) -> dict[str, str]:
    """Return the variables of a case's processes: own domain, this machine, the Fast DDS profile.

    Without our profile they get one that changes nothing, as the nodes would find ours otherwise.
    """
    variables = dict(os.environ)
    variables["ROS_DOMAIN_ID"] = str(private_domain().number)
    variables["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    variables.pop("FASTDDS_DEFAULT_PROFILES_FILE", None)
    ours = config_folder()
    if ours is None:
        raise GeoprimError("the folder with config/fastdds.xml was not found")
    stock = folder / "stock.xml"
    stock.write_text(_STOCK)
    profile = ours / "fastdds.xml" if case.own_profile else stock
    variables["FASTRTPS_DEFAULT_PROFILES_FILE"] = str(profile)
    return variables
