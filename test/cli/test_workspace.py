"""The set-up script says in one sentence what a machine lacks."""

import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

from geoprim_core.warm import PARTS

ROOT = Path(__file__).resolve().parents[2]


def run(words, **changes):
    environment = {k: v for k, v in os.environ.items() if not k.startswith("_ROS_WHEELS")}
    environment.update(changes)
    return subprocess.run(words, capture_output=True, text=True, env=environment, timeout=60)


@pytest.fixture
def tree(tmp_path):
    """A copy of what the set-up script looks at, without an environment."""
    tools = ("workspace.py", "requirements.txt", "constraints.txt", "constraints-ubuntu2404.txt")
    for name in ("run", *(f"tools/{tool}" for tool in tools)):
        target = tmp_path / name
        target.parent.mkdir(exist_ok=True)
        target.write_bytes((ROOT / name).read_bytes())
        target.chmod(0o755)
    return tmp_path


def one_sentence(answer, *words):
    assert answer.returncode == 2, answer.stderr
    lines = [line for line in answer.stderr.splitlines() if line.strip()]
    assert len(lines) == 1, answer.stderr
    for word in words:
        assert word in lines[0]


def test_a_missing_compiler(tree):
    answer = run([sys.executable, tree / "tools" / "workspace.py", "setup"], PATH="", CXX="")
    one_sentence(answer, "C++ compiler", "CXX=")


def test_a_wrong_python(tree):
    other = tree / "bin"
    other.mkdir()
    for name in ("python3", "python3.11", "python3.12"):
        fake = other / name
        fake.write_text('#!/bin/sh\n[ "$1" = --version ] && echo Python 3.9.1 && exit 0\nexit 1\n')
        fake.chmod(0o755)
    answer = run([tree / "run", "setup"], PATH=f"{other}:/usr/bin:/bin", PYTHON="")
    one_sentence(answer, "Python 3.11 or 3.12", "Python 3.9.1", "PYTHON=")


@pytest.mark.slow
def test_no_network(tree):
    answer = run(
        [sys.executable, tree / "tools" / "workspace.py", "setup"],
        PIP_INDEX_URL="http://127.0.0.1:9/simple",
        PIP_CONFIG_FILE=os.devnull,
        PIP_FIND_LINKS="",
        PIP_EXTRA_INDEX_URL="",
        PIP_RETRIES="0",
    )
    one_sentence(answer, "package index cannot be reached", "network connection")


def test_setup_in_a_folder_that_cannot_be_written(tree):
    if os.geteuid() == 0:
        pytest.skip("nothing is unwritable for root")
    tree.chmod(0o555)
    answer = run([sys.executable, tree / "tools" / "workspace.py", "setup"])
    tree.chmod(0o755)
    one_sentence(answer, "cannot be written")


def test_a_leg_has_an_environment_and_versions_of_its_own(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "tools")
    workspace = importlib.import_module("workspace")
    usual, leg = workspace.Environment(), workspace.Environment("ubuntu2404")
    assert (usual.folder.name, leg.folder.name) == (".venv", ".venv-ubuntu2404")
    pins, own = workspace.pins_of(*usual.constraints), workspace.pins_of(*leg.constraints)
    assert own["numpy"] == "numpy==1.26.4" and own["scipy"] == "scipy==1.11.4"
    assert own["opencv-python-headless"].startswith("opencv-python-headless==4.6.")
    assert own["tqdm"] == pins["tqdm"] and set(own) == set(pins)
    tests = (*workspace.LEG_LIBRARY, *workspace.LEG_ROS)
    missing = [test for test in tests if not (ROOT / test).exists()]
    assert not missing


def test_every_part_of_the_kernels_is_compiled_before_tests_and_the_detector_before_the_demo(
    monkeypatch,
):
    monkeypatch.syspath_prepend(ROOT / "tools")
    workspace = importlib.import_module("workspace")
    assert tuple(PARTS) == workspace.KERNELS
    assert set(workspace.DEMO_KERNELS) < set(PARTS)


def test_a_part_that_is_compiled_is_not_compiled_again(monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(ROOT / "tools")
    workspace = importlib.import_module("workspace")
    calls = []

    class Recorded(workspace.Environment):
        folder = tmp_path

        def call(self, command):
            calls.append(command[command.index("warm") + 1 :])
            return 0

    workspace.warm_kernels(Recorded(), workspace.DEMO_KERNELS)
    workspace.warm_kernels(Recorded(), workspace.KERNELS)
    workspace.warm_kernels(Recorded(), workspace.DEMO_KERNELS)
    rest = [part for part in workspace.KERNELS if part not in workspace.DEMO_KERNELS]
    assert calls == [list(workspace.DEMO_KERNELS), rest]


def test_an_unknown_leg_is_refused(tree):
    answer = run([sys.executable, tree / "tools" / "workspace.py", "test", "--leg", "dapper"])
    assert answer.returncode == 2
    assert "ubuntu2404" in answer.stderr
