"""Every node starts as a module with nothing to source, and ends with code 0."""

import doctest
import importlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from geoprim_msgs.msg import Contours
from rclpy.serialization import serialize_message

from geoprim_core.io.bags import BagWriter
from geoprim_core.io.mcap_file import MAGIC
from geoprim_ros import environment
from geoprim_ros.deadline import exit_after
from geoprim_ros.nodes import edges_node

ROOT = Path(__file__).parents[2]
STAMP = Path(sys.prefix, "share", "geoprim_msgs", "build_stamp")
NODES = (
    "edges_node", "polygons_node", "ellipses_node", "detector_node", "overlay_node",
    "markers_node", "lifecycle_detector",
)  # fmt: skip


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_every_node_runs_as_a_module_and_ends_with_code_0(graph, tmp_path, number):
    bag = tmp_path / "one.mcap"
    with BagWriter(bag) as writer:
        data = serialize_message(Contours())
        writer.write_raw("/contours", "geoprim_msgs/msg/Contours", data, 1)
    watcher = graph.node("watcher")
    commands = {name: [] for name in NODES}
    commands["pipeline"] = ["--stages", "detector"]
    commands["bag_player"] = [bag, "--wait-for-readers", 99]
    commands["bag_recorder"] = [tmp_path / "out.mcap"]
    processes = {}
    for i, (name, words) in enumerate(commands.items()):
        remap = ("--ros-args", "-r", f"__ns:=/n{i}")
        processes[name] = graph.start(f"geoprim_ros.nodes.{name}", *words, *remap)
    spaces = {f"/n{i}" for i in range(len(commands))}

    def missing():
        return spaces - {space for _, space in watcher.get_node_names_and_namespaces()}

    graph.spin_until(lambda: not missing(), 90.0)
    for process in processes.values():
        process.send_signal(number)
    graph.spin_until(lambda: all(p.poll() is not None for p in processes.values()), 90.0)
    ends = {name: (p.returncode, p.stderr.read()) for name, p in processes.items()}
    assert {name: code for name, (code, _) in ends.items()} == dict.fromkeys(commands, 0), ends
    assert not any("Traceback" in text for _, text in ends.values()), ends
    assert (tmp_path / "out.mcap").read_bytes().endswith(MAGIC)


def test_a_process_that_hangs_in_native_code_ends_with_its_code():
    # sleep of PyDLL keeps the interpreter's lock, as rclpy does while a participant is removed
    program = (
        "import ctypes; from geoprim_ros.deadline import exit_after\n"
        "print('said', flush=False)\n"
        "with exit_after(0.5, 7): ctypes.PyDLL(None).sleep(50)"
    )
    words = [sys.executable, "-c", program]
    answer = subprocess.run(words, capture_output=True, text=True, timeout=40)
    assert (answer.returncode, answer.stdout, answer.stderr) == (7, "said\n", "")


def test_a_process_that_is_in_time_goes_on():
    with exit_after(0.2, 7):
        pass
    time.sleep(0.5)  # the timer is gone


def test_a_refused_parameter_ends_the_process_with_one_sentence(graph):
    process = graph.start("geoprim_ros.nodes.edges_node", "--ros-args", "-p", "edges.sigma:=-3.0")
    out, err = process.communicate(timeout=30)
    assert process.returncode == 2
    (line,) = [text for text in err.splitlines() if text]
    assert line.startswith("edges.sigma: expected a number from 0.0 to 5.0 px"), out + err


def test_an_argument_that_is_not_one_of_ros_is_said(capsys):
    assert edges_node.main(["--fast"]) == 2
    assert "--fast" in capsys.readouterr().err


@pytest.mark.parametrize(
    "name",
    [
        "pairing",
        "spin",
        "keyboard",
        "selection",
        "qos_profiles",
        "nodes.bag_recorder",
        "endurance.resources",
        "endurance.starts",
    ],
)
def test_examples_in_the_documentation_run(name):
    module = importlib.import_module(f"geoprim_ros.{name}")
    failed, tried = doctest.testmod(module)
    assert (failed, tried > 0) == (0, True)


def test_what_is_set_in_the_environment_stays(monkeypatch):
    values = {"AMENT_PREFIX_PATH": "/a", "FASTDDS_DEFAULT_PROFILES_FILE": "/b", "ROS_LOG_DIR": "/c"}
    for name in ("FASTRTPS_DEFAULT_PROFILES_FILE", "ROS_HOME"):
        monkeypatch.delenv(name, raising=False)
    for name, value in values.items():
        monkeypatch.setenv(name, value)
    environment.prepare()
    assert {name: os.environ[name] for name in values} == values
    assert "FASTRTPS_DEFAULT_PROFILES_FILE" not in os.environ


def test_the_profile_has_room_for_images(monkeypatch):
    monkeypatch.delenv("FASTRTPS_DEFAULT_PROFILES_FILE", raising=False)
    monkeypatch.delenv("FASTDDS_DEFAULT_PROFILES_FILE", raising=False)
    environment.prepare()
    profile = Path(os.environ["FASTRTPS_DEFAULT_PROFILES_FILE"])
    size = profile.read_text().partition("<segment_size>")[2].partition("<")[0]
    assert int(size) >= 16 * 2**20


def _build(*words, **variables):
    environment = {k: v for k, v in os.environ.items() if k not in ("CC", "CXX")}
    return subprocess.run(
        [sys.executable, str(ROOT / "tools" / "build_msgs.py"), *words],
        env={**environment, **variables}, capture_output=True, text=True,
    )  # fmt: skip


@pytest.mark.skipif(not STAMP.exists(), reason="the messages come from a workspace")
def test_messages_are_not_built_again():
    answer = _build(str(ROOT / "msg_defs" / "geoprim_msgs"))
    assert (answer.returncode, answer.stdout.strip()) == (0, "geoprim_msgs is up to date.")


def test_a_missing_compiler_is_one_sentence(tmp_path):
    source = str(ROOT / "msg_defs" / "geoprim_msgs")
    answer = _build(source, "--force", PATH=str(tmp_path))
    assert answer.returncode == 1
    assert answer.stderr.count("\n") == 1 and "C++ compiler" in answer.stderr
    answer = _build(source, "--force", CXX="no-such-compiler")
    assert answer.returncode == 1 and "no-such-compiler" in answer.stderr
    answer = _build(str(tmp_path))
    assert answer.returncode == 1 and "package.xml" in answer.stderr
