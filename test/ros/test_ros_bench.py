"""`geoprim bench ros`: the search for the highest rate, the tables, and one short live run."""

import csv
import re
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from geoprim_core.cli.main import main
from geoprim_core.errors import InputError
from geoprim_core.io.images import read_image
from geoprim_ros.bench.cases import cases_of
from geoprim_ros.bench.processes import environment
from geoprim_ros.bench.report import HEAD, Measured, markdown, write_csv, write_plot
from geoprim_ros.bench.runs import Run, find_highest, highest_clean

ROOT = Path(__file__).resolve().parents[2]
PAGES = (ROOT / "README.md").read_text() + (ROOT / "docs" / "results.md").read_text()


def a_run(rate, received=20, sent=20, pace=1.0):
    times = tuple(float(k) for k in range(1, received + 1))
    return Run(rate, rate * pace, sent, received, times, {"edges_node": 31.2, "others": 12.0})


@given(
    rates=st.lists(st.integers(1, 500), min_size=1, unique=True).map(sorted),
    limit=st.integers(0, 500),
    data=st.data(),
)
def test_the_search_finds_the_highest_rate_below_the_limit(rates, limit, data):
    first = data.draw(st.sampled_from(rates))
    runs = find_highest(lambda rate: a_run(rate, 20 if rate <= limit else 19), rates, first)
    assert runs[0].rate == first
    assert highest_clean(runs) == max((r for r in rates if r <= limit), default=0)
    assert len({run.rate for run in runs}) == len(runs) <= len(rates).bit_length() + 1


def test_a_camera_that_falls_behind_is_no_proof():
    assert a_run(30).is_clean
    assert not a_run(30, pace=0.9).is_clean
    assert not a_run(30, received=19).is_clean


def test_every_graph_is_measured_with_and_without_the_profile_and_on_jpeg():
    cases = list(cases_of(["separate", "empty"], ["640x480"], compressed=True, stock=True))
    told = [(c.graph.name, c.pictures.name, c.profile) for c in cases]
    assert told == [
        ("separate", "640x480 bgr8", "ours"), ("empty", "640x480 bgr8", "ours"),
        ("separate", "640x480 bgr8", "stock"), ("empty", "640x480 bgr8", "stock"),
        ("separate", "640x480 JPEG", "ours"), ("empty", "640x480 JPEG", "ours"),
    ]  # fmt: skip
    with pytest.raises(InputError, match="--graphs"):
        list(cases_of(["nonsense"], ["640x480"], compressed=True, stock=True))
    with pytest.raises(InputError, match="--sizes"):
        list(cases_of(["separate"], ["8x8"], compressed=True, stock=True))


def test_a_case_without_our_profile_has_the_built_in_transports(tmp_path):
    ours, stock = cases_of(["separate"], ["640x480"], compressed=False, stock=True)
    named = "FASTRTPS_DEFAULT_PROFILES_FILE"
    assert "segment_size" in Path(environment(ours, tmp_path)[named]).read_text()
    text = Path(environment(stock, tmp_path)[named]).read_text()
    assert "segment_size" not in text and "useBuiltinTransports>true" in text


@pytest.fixture
def measured():
    cases = cases_of(["separate"], ["640x480"], compressed=False, stock=True)
    runs = (a_run(30), a_run(60, 15)), (a_run(30, 0),)
    return [Measured(case, part) for case, part in zip(cases, runs, strict=True)]


def test_the_table_has_the_first_run_and_the_highest_rate(measured):
    lines = markdown(measured).splitlines()
    assert lines[2] == (
        "| 640x480 bgr8 | separate | ours | 30 | 20 of 20 | 0 | 10.5 | 19.1 | edges_node 31 | 30 |"
    )
    assert lines[3].endswith("| 0 of 20 | 20 | nan | nan | edges_node 31 | less |")
    assert "others" not in lines[2]
    assert "what ran beside took 12 to 12 % of a core" in lines[-1]


def test_the_files_hold_every_run(measured, tmp_path):
    write_csv(measured, tmp_path / "ros.csv")
    write_plot(measured, tmp_path / "ros.png")
    with (tmp_path / "ros.csv").open() as file:
        rows = [(r["profile"], r["rate"], r["dropped"]) for r in csv.DictReader(file)]
    assert rows == [("ours", "30", "0"), ("ours", "60", "5"), ("stock", "30", "20")]
    assert read_image(tmp_path / "ros.png").shape[1] > 600


def test_the_tables_of_the_readme_have_the_columns_of_the_command():
    blocks = re.findall(r"<!-- measured: geoprim bench ros.* -->\n(.*)\n", PAGES)
    assert blocks == ["| " + " | ".join(HEAD) + " |"] * 2


def test_without_ros_the_command_says_so(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "rclpy", None)
    assert main(["bench", "ros"]) == 2
    assert "it needs ROS 2" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--graphs", "x"], "--graphs"),
        (["--sizes", "1x1"], "--sizes"),
        (["--config", "nowhere.yaml"], "nowhere.yaml"),
    ],
)
def test_a_refusal_is_one_line(words, said, capsys):
    assert main(["bench", "ros", *words]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.live
def test_a_short_run_of_every_kind_of_process(tmp_path, capsys):
    """What it measures is the machine's; that something is answered and written is ours."""
    words = ["--graphs", "one callback", "empty", "--sizes", "640x480", "--seconds", "0.5"]
    words += ["--no-search", "--own-profile-only", "--quiet", "--output", str(tmp_path)]
    assert main(["bench", "ros", *words]) == 0
    text = capsys.readouterr().out
    rows = re.findall(r"\| 640x480 (\w+) \| ([\w ]+) \| ours \| 30 \| (\d+) of 15 \|", text)
    assert [row[:2] for row in rows] == [
        (kind, graph) for kind in ("bgr8", "JPEG") for graph in ("one callback", "empty")
    ]
    assert all(int(received) > 0 for *_, received in rows)
    assert re.search(r"detector_node \d+, camera \d+", text)
    assert (tmp_path / "ros.md").read_text() in text
    assert (tmp_path / "ros_latency.png").stat().st_size > 1000
