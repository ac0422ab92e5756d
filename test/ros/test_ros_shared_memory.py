"""What killed processes leave in /dev/shm goes away; what a process holds stays."""

import fcntl
import os
import re
import signal
from pathlib import Path

import pytest

from geoprim_ros.shared_memory import FOLDER, Leftovers, clean, segments, unowned

NAME = "fastrtps_0123456789abcdef"
PORT = "fastrtps_port7411"
SEGMENT = "fastrtps_[0-9a-f]{16}"


@pytest.fixture
def folder(tmp_path):
    """A folder with a segment and a port as Fast DDS has them, and files of others."""
    (tmp_path / NAME).write_bytes(b"\0" * 1000)
    (tmp_path / PORT).write_bytes(b"\0" * 10)
    for name in (f"{NAME}_el", f"{PORT}_el", f"sem.{PORT}_mutex", "lttng-ust-wait-6", "mine"):
        (tmp_path / name).touch()
    return tmp_path


def left(folder):
    return {path.name for path in folder.iterdir()}


def test_a_segment_without_owner_goes_and_nothing_else_does(folder):
    before = left(folder)
    assert clean(folder, settled_s=0.0, dry=True) == Leftovers((NAME, f"{NAME}_el"), 1000)
    assert left(folder) == before
    assert clean(folder, settled_s=0.0) == Leftovers((NAME, f"{NAME}_el"), 1000)
    assert before - left(folder) == {NAME, f"{NAME}_el"}
    assert clean(folder, settled_s=0.0) == Leftovers()


def test_ports_go_on_demand(folder):
    clean(folder, settled_s=0.0, ports=True)
    assert left(folder) == {"lttng-ust-wait-6", "mine"}


@pytest.mark.parametrize("kind", [fcntl.LOCK_EX, fcntl.LOCK_SH])
def test_what_is_locked_stays(folder, kind):
    before = left(folder)
    with (folder / f"{NAME}_el").open() as first, (folder / f"{PORT}_el").open() as second:
        fcntl.flock(first, kind)
        fcntl.flock(second, kind)
        assert clean(folder, settled_s=0.0, ports=True) == Leftovers()
    assert left(folder) == before


def test_only_segments_without_owner_are_unowned(folder):
    assert unowned(folder) == {NAME}
    with (folder / f"{NAME}_el").open() as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        assert unowned(folder) == set()


def test_what_is_young_or_of_another_user_stays(folder, monkeypatch):
    assert clean(folder, ports=True) == Leftovers()
    monkeypatch.setattr(os, "getuid", lambda: -7)
    assert clean(folder, settled_s=0.0, ports=True) == Leftovers()


def test_a_segment_without_a_lock_is_not_ours_to_judge(folder):
    (folder / f"{NAME}_el").unlink()
    assert clean(folder, settled_s=0.0) == Leftovers()


def test_where_there_is_no_such_folder_nothing_is_done(tmp_path):
    assert clean(tmp_path / "missing", ports=True) == Leftovers()


def test_no_descriptor_stays_open(folder):
    before = len(os.listdir("/proc/self/fd"))
    clean(folder, settled_s=0.0, ports=True, dry=True)
    assert len(os.listdir("/proc/self/fd")) == before


def owned(process):
    """Return the segment that a process maps, alone on its domain."""
    found = re.search(f"/({SEGMENT})", Path(f"/proc/{process.pid}/maps").read_text())
    return found and found.group(1)


def test_the_segment_of_a_killed_node_goes_and_that_of_a_living_one_stays(
    graph, make_domain, monkeypatch
):
    """Each on a domain of its own, so that nobody else looks after the dead one."""
    processes = []
    for _ in range(2):
        monkeypatch.setenv("ROS_DOMAIN_ID", str(make_domain()))
        processes.append(graph.start("geoprim_ros.nodes.edges_node"))
    graph.spin_until(lambda: all(map(owned, processes)), 60.0)
    dead, living = map(owned, processes)
    processes[0].kill()
    processes[0].wait(30)
    assert {dead, living} <= set(segments())
    removed = clean(settled_s=0.0).names
    assert dead in removed
    assert living not in removed and (FOLDER / living).exists()
    processes[1].send_signal(signal.SIGINT)
    assert processes[1].wait(30) == 0
    assert not {dead, living} & set(segments())
