"""The trials judge rightly: what grows is told from what does not, a bad end from a good one."""

import signal
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from geoprim_core.errors import BagError
from geoprim_core.io.bags import BagReader
from geoprim_ros.endurance import resources, starts
from geoprim_ros.endurance.kills import unreadable, write_bag
from geoprim_ros.endurance.processes import Processes
from geoprim_ros.endurance.resources import Sample, drift, sample
from geoprim_ros.endurance.soak import Course, problems


def course(resident, threads=17, handles=20):
    count = len(resident)
    return Course(
        frames=[100 * i for i in range(count)],
        seconds=[float(i) for i in range(count)],
        samples=[
            Sample(float(mb), 0.0, 0.0, int(t), int(h), 10)
            for mb, t, h in np.broadcast(resident, threads, handles)
        ],
    )


def test_what_grows_is_told_from_what_does_not():
    frames = 100.0 * np.arange(200)
    noise = np.random.default_rng(3).normal(0, 0.05, 200)
    assert problems(course(240 + noise), 1.0) == []
    assert "memory +2.0" in problems(course(240 + 2e-4 * frames + noise), 1.0)[0]
    assert problems(course(240 + noise, threads=np.arange(200) // 100), 1.0) == ["1 more threads"]
    assert problems(course(240 + noise, handles=np.arange(200) // 10), 1.0) == ["13 more handles"]
    assert problems(course(240 + noise[:2]), 1.0) == ["ended early"]


def test_a_growth_that_cannot_be_told_for_noise_is_no_pass():
    noise = np.random.default_rng(5).normal(0, 1.0, 30)
    steady = course(240 + noise - noise.mean())
    assert steady.growth().error > 1.0
    assert problems(steady, 1.0)


@given(st.floats(-5, 5), st.floats(-50, 50), st.integers(3, 60))
def test_a_line_is_found_exactly(slope, start, count):
    x = np.arange(count) / 7
    found = drift(x, start + slope * x)
    assert np.isclose(found.slope, slope, atol=1e-9)
    assert np.isclose(found.start, start, atol=1e-9)
    assert found.error < 1e-6


def test_the_error_of_a_slope_covers_it():
    """Of many noisy lines, some 95 % have the true slope within two standard errors."""
    draw, x = np.random.default_rng(11), np.linspace(0, 2, 100)
    found = [drift(x, 3 + 0.7 * x + draw.normal(0, 0.3, 100)) for _ in range(400)]
    inside = np.mean([abs(f.slope - 0.7) < 2 * f.error for f in found])
    assert 0.9 < inside < 0.99


def test_alike_neighbours_are_worth_less():
    x, noise = np.linspace(0, 1, 90), np.random.default_rng(2).normal(0, 1, 30)
    assert drift(x, np.repeat(noise, 3)).error > 1.3 * drift(x, np.tile(noise, 3)).error


def test_a_process_that_has_ended_gives_no_sample():
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait()
    assert sample(process.pid) is None
    assert resources.drift(np.zeros(2), np.zeros(2)).error == float("inf")


def test_a_node_that_does_not_end_well_is_a_fault():
    tally = starts.Tally()
    tally.add(starts.Start("edges", signal.SIGINT, 0.0), 0, "", 1.0)
    tally.add(starts.Start("edges", signal.SIGTERM, 0.0), 1, "why", 2.0)
    tally.add(starts.Start("edges", signal.SIGTERM, 0.0), 0, "Traceback (most", 1.5)
    assert [f.split(": ")[0] for f in tally.faults] == [
        "edges, SIGTERM, code 1", "edges, SIGTERM, code 0"
    ]  # fmt: skip
    assert "| edges | 1 of 1 | 1 of 2 |" in tally.table()
    assert tally.slowest_s == 2.0


def test_a_bag_that_holds_nothing_is_a_fault(tmp_path):
    whole, junk = tmp_path / "whole.mcap", tmp_path / "junk.mcap"
    write_bag(whole)
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])
    junk.write_bytes(b"no bag at all")
    (fault,) = unreadable([whole, cut, junk])
    assert "junk.mcap" in fault
    assert len(list(BagReader(whole.with_name("whole_repaired.mcap")).messages())) == 60


def test_every_kind_ends_by_every_signal_at_every_age():
    planned = set(starts.plan(60, list(starts.KINDS)))
    assert len(planned) == 60


def test_a_process_that_has_to_be_killed_is_told(tmp_path):
    processes = Processes(tmp_path)
    processes.start("player", "bag_player", [tmp_path / "missing.mcap"])
    assert processes.end("player", 0) == 2
    assert "missing.mcap" in processes.said("player")
    with pytest.raises(BagError):
        BagReader(tmp_path / "missing.mcap")
