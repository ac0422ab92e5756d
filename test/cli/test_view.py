"""`geoprim view`: it serves until it is told to end, and says what it cannot show."""

import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from geoprim_core.cli.main import main
from geoprim_core.cli.view import layout_file


@pytest.fixture
def start():
    """Start the command in a process of its own; return it and its port."""
    pytest.importorskip("foxglove")
    processes = []

    def view(*words):
        command = [sys.executable, "-m", "geoprim_core.cli.main", "view", "--port", "0"]
        process = subprocess.Popen(
            [*command, *map(str, words)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        processes.append(process)
        address, layout = process.stdout.readline(), process.stdout.readline()
        assert str(layout_file()) in layout
        return process, int(re.search(r":(\d+) ", address)[1])

    yield view
    for process in processes:
        process.kill()
        process.communicate()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_it_serves_a_picture_again_and_again_until_it_is_told_to_end(
    disc, start, viewer, annotations_of, number
):
    process, port = start(disc, "--fps", "20")
    seen = viewer(port)
    seen.look_at("/annotations", "/diagnostics")
    for _ in range(3):
        got = seen.see("/annotations", "/diagnostics", timeout=60.0)
    (line,), (text,) = annotations_of(got["/annotations"])
    assert abs(line[1].mean(axis=0) - (70.75, 61.0)).max() < 0.1  # from the corner
    assert text.startswith("#0 ellipse")
    assert b"frames shown" in got["/diagnostics"]
    process.send_signal(number)
    _, err = process.communicate(timeout=30)
    assert process.returncode == 0, err
    assert "Traceback" not in err


def test_one_round_that_waits_for_its_viewer_ends_by_itself(disc, start, viewer):
    process, port = start(disc, "--once", "--wait")
    seen = viewer(port)
    seen.look_at("/annotations")
    seen.see("/annotations", timeout=60.0)
    assert process.wait(timeout=30) == 0


def test_it_writes_a_file_for_foxglove(disc, tmp_path, capsys):
    pytest.importorskip("foxglove")
    assert main(["view", str(disc), "--save", str(tmp_path / "view.mcap")]) == 0
    assert "1 frames" in capsys.readouterr().out
    assert (tmp_path / "view.mcap").stat().st_size > 1000


@pytest.mark.parametrize(
    ("words", "said"),
    [([], "nothing to view"), (["no_such.mcap"], "no_such.mcap"), (["a.png"], "a.png")],
)
def test_what_cannot_be_viewed_is_one_line(words, said, capsys):
    pytest.importorskip("foxglove")
    assert main(["view", *words]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line


def test_the_layout_that_is_named_is_there():
    assert layout_file() == Path(__file__).resolve().parents[2] / "config" / "foxglove_layout.json"
