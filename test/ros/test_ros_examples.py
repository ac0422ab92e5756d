"""The launch-free CI example passes on a bag of ours, and fails where nothing is found."""

import subprocess
import sys
from pathlib import Path

import pytest

from geoprim_core.io.demo_bag import build_demo_bag

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    path = tmp_path_factory.mktemp("bag") / "short.mcap"
    build_demo_bag(path, sorting_frames=3, progress=False)
    return path


def run(bag, config):
    words = [sys.executable, ROOT / "examples" / "ci_graph.py", bag, config]
    return subprocess.run(words, capture_output=True, text=True, timeout=240)


@pytest.mark.live
@pytest.mark.parametrize("scenario", ["sorting_cans", "sorting_produce"])
def test_the_example_passes(bag, scenario):
    answer = run(bag, ROOT / "config" / f"{scenario}.yaml")
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert "objects found" in answer.stdout


@pytest.mark.live
def test_the_example_fails_where_nothing_is_found(bag, tmp_path):
    config = tmp_path / "sorting_cans.yaml"
    text = (ROOT / "config" / "sorting_cans.yaml").read_text()
    config.write_text(text.replace("plane_distance: 0.52", "plane_distance: 0.01"))
    answer = run(bag, config)
    assert answer.returncode == 1
    assert answer.stdout.startswith("0 of ")
    assert "AssertionError" in answer.stderr
