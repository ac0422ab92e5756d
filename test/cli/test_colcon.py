"""`colcon build` and `colcon test` on this package: the tests are really run, and can fail."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("colcon_core")
pytest.importorskip("geoprim_msgs")

ROOT = Path(__file__).resolve().parents[2]
KEPT = (
    "config", "geoprim_core", "geoprim_ros", "msg_defs", "resource", "test", "package.xml",
    "pyproject.toml", "setup.cfg", "setup.py",
)  # fmt: skip
PICKED = ("test/core/test_params.py", "test/ros/test_ros_messages.py")


@pytest.fixture(scope="module")
def workspace(tmp_path_factory):
    """A copy of the package, built; its messages are those of this environment."""
    folder = tmp_path_factory.mktemp("workspace")
    for name in KEPT:
        source, target = ROOT / name, folder / name
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, target)
    answer = colcon(folder, "build", "--base-paths", ".")
    assert answer.returncode == 0, answer.stdout + answer.stderr
    return folder


def colcon(folder, *words):
    variables = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "COLUMNS")}
    path = f"{Path(sys.executable).parent}{os.pathsep}{variables['PATH']}"
    return subprocess.run(
        [Path(sys.executable).with_name("colcon"), *words], cwd=folder,
        env={**variables, "PATH": path, "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True, text=True, timeout=300,
    )  # fmt: skip


def run_tests(folder, *files):
    words = ("--base-paths", ".", "--return-code-on-test-failure", "--pytest-args", *files)
    return colcon(folder, "test", *words)


def test_the_package_is_installed_as_one_of_ros(workspace):
    installed = workspace / "install" / "geoprim_ros"
    assert os.access(installed / "lib" / "geoprim_ros" / "detector_node", os.X_OK)
    share = installed / "share"
    assert (share / "ament_index" / "resource_index" / "packages" / "geoprim_ros").is_file()
    assert (share / "geoprim_ros" / "config" / "fastdds.xml").is_file()


def test_colcon_test_runs_tests(workspace):
    answer = run_tests(workspace, *PICKED)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    results = colcon(workspace, "test-result", "--all").stdout
    count = int(results.split("Summary: ")[1].split(" tests")[0])
    assert count >= 20, results


def test_colcon_test_fails_where_a_test_fails(workspace):
    (workspace / "test" / "test_wrong.py").write_text("def test_wrong():\n    assert 1 == 2\n")
    assert run_tests(workspace, "test/test_wrong.py").returncode == 1
    results = colcon(workspace, "test-result", "--verbose")
    assert results.returncode == 1
    assert "1 failure" in results.stdout and "test_wrong" in results.stdout
