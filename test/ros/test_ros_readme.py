"""README and docs/ros.md are true: tables are those of the code, commands run as they stand."""

import os
import re
import shlex
import signal
import subprocess
import sys
import time
from dataclasses import fields, is_dataclass
from pathlib import Path

import numpy as np
import pytest

from geoprim_core.io.bags import BagReader
from geoprim_core.io.config import load_config
from geoprim_core.io.demo_bag import build_demo_bag
from geoprim_core.io.images import write_image
from geoprim_core.io.process import process_bag
from geoprim_core.synthetic import disc_image

ROOT = Path(__file__).resolve().parents[2]
PAGES = (ROOT / "README.md").read_text() + (ROOT / "docs" / "ros.md").read_text()


def commands():
    """Return every shell command of the pages, comments and continuations folded away."""
    found = []
    for block in re.findall(r"```sh\n(.*?)```", PAGES, re.DOTALL):
        for line in block.replace("\\\n", " ").splitlines():
            words = line.split("#")[0].strip()
            if words:
                found.append(words)
    return found


ELSEWHERE = {
    "./run demo": "test_the_demo runs its last step; set-up is what this environment came from",
    "./run test": "it runs this test",
    "colcon build --base-paths src src/geoprim/msg_defs": "needs a system ROS",
}
ENDLESS = (
    "geoprim_ros.nodes.pipeline",
    "geoprim_ros.nodes.lifecycle_detector",
    "geoprim_ros.nodes.bag_recorder",
    "view",
)


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    """A folder that looks as the README assumes: the configuration, a photo and two bags."""
    folder = tmp_path_factory.mktemp("desk")
    (folder / "config").symlink_to(ROOT / "config")
    (folder / "bags").mkdir()
    build_demo_bag(folder / "bags" / "demo.mcap", sorting_frames=2, progress=False)
    (folder / "in.mcap").symlink_to(folder / "bags" / "demo.mcap")
    write_image(folder / "photo.png", disc_image(160, 120, centre=(80.0, 60.0), radius=40.0))
    return folder


def environment():
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return {**os.environ, "PATH": path, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}


def test_the_tables_are_those_of_the_code():
    check = [sys.executable, str(ROOT / "tools" / "readme.py"), "--check"]
    answer = subprocess.run(check, capture_output=True, text=True)
    assert answer.returncode == 0, answer.stdout + answer.stderr


def test_the_commands_that_are_run_elsewhere_still_stand_there():
    assert set(ELSEWHERE) <= set(commands())


def test_the_python_of_the_readme_runs(desk):
    (script,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    script += (
        "assert fit.ellipse is not None and len(found) == 1 and picture.shape == (120, 160, 3)"
    )
    subprocess.run([sys.executable, "-c", script], cwd=desk, check=True, timeout=300)


def wait_for_handlers(process):
    """Wait until rclpy catches SIGTERM; a loaded machine takes a while to import it."""
    status, end = Path(f"/proc/{process.pid}/status"), time.monotonic() + 120.0
    while process.poll() is None and time.monotonic() < end:
        caught = re.search(r"SigCgt:\s*(\w+)", status.read_text())
        if caught and int(caught[1], 16) >> (signal.SIGTERM - 1) & 1:
            break
        time.sleep(0.1)
    time.sleep(2.0)


@pytest.mark.live
@pytest.mark.parametrize("command", [c for c in commands() if c not in ELSEWHERE])
def test_a_command(command, desk):
    words = shlex.split(command)
    if words[0] == ".venv/bin/python":
        words[0] = sys.executable
    elif words[0] == "geoprim":
        words[0:1] = [sys.executable, "-m", "geoprim_core.cli.main"]
    process = subprocess.Popen(
        words,
        cwd=desk,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        if any(node in words for node in ENDLESS):
            wait_for_handlers(process)
            assert process.poll() is None, process.communicate()
            process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=120)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == 0, out + err
    assert "Traceback" not in err


@pytest.fixture(scope="module")
def demo(desk):
    """The demo's output folder and what it printed, run on the short bag."""
    output = desk / "output"
    words = [sys.executable, "-m", "geoprim_ros.demo", "--bag", str(desk / "bags" / "demo.mcap")]
    answer = subprocess.run(
        [*words, "--output", str(output)],
        cwd=desk, env=environment(), capture_output=True, text=True, timeout=240,
    )  # fmt: skip
    assert answer.returncode == 0, answer.stdout + answer.stderr
    return output, answer.stdout


@pytest.mark.live
@pytest.mark.slow
def test_the_demo_answers_every_frame_and_draws(demo):
    output, text = demo
    for sequence in ("photo_coins", "photo_coffee", "sorting_cans", "sorting_ores"):
        assert re.search(rf"^  {sequence} +[23] frames", text, re.MULTILINE), text
        assert (output / "overlays" / f"{sequence}_000.png").is_file()
    assert (output / "overview.png").is_file()


@pytest.mark.live
@pytest.mark.slow
@pytest.mark.parametrize("scenario", ["sorting_cans", "sorting_ores"])
def test_offline_gives_the_messages_of_the_live_graph(scenario, demo, desk, tmp_path):
    config = load_config(ROOT / "config" / f"{scenario}.yaml")
    process_bag(
        desk / "bags" / "demo.mcap", tmp_path / "offline.mcap", params=config.detector,
        sorting=config.sorting, plane_distance=config.plane_distance, progress=False,
    )  # fmt: skip
    for topic in ("contours", "polygons", "ellipses", "detections"):
        live = messages(demo[0] / "results.mcap", topic, scenario)
        offline = messages(tmp_path / "offline.mcap", topic, scenario)
        assert len(live) == len(offline) == 2
        for one, other in zip(live, offline, strict=True):
            assert_same_fields(one, other, topic)


def messages(bag, topic, sequence):
    read = BagReader(bag).messages([topic])
    return [m.decoded for m in read if m.decoded.header.frame_id == sequence]


def assert_same_fields(one, other, name):
    """Compare two decoded messages field by field; NaN equals NaN."""
    if is_dataclass(one):
        for field in fields(one):
            inner = f"{name}.{field.name}"
            assert_same_fields(getattr(one, field.name), getattr(other, field.name), inner)
    elif isinstance(one, list):
        assert len(one) == len(other), name
        for a, b in zip(one, other, strict=True):
            assert_same_fields(a, b, name)
    else:
        np.testing.assert_array_equal(one, other, err_msg=name)
