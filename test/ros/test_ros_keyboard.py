"""Keys on a terminal of the test's own; its settings are put back whatever ends the program."""

import fcntl
import os
import pty
import select
import signal
import subprocess
import sys
import termios
import time

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from std_msgs.msg import Header

from geoprim_core.io.bags import BagWriter
from geoprim_core.io.record import header
from geoprim_ros.keyboard import Keyboard, split_keys

ECHO = """
import sys, time
from geoprim_ros.keyboard import Keyboard
with Keyboard() as keyboard:
    print("ready", keyboard.active, flush=True)
    end = time.monotonic() + 30
    while time.monotonic() < end:
        for key in keyboard.typed():
            print("key", key, flush=True)
            if key == "x":
                raise RuntimeError("on purpose")
            if key == "q":
                sys.exit(0)
        time.sleep(0.01)
"""

# What a shell with job control does: its job runs in the foreground until it stops.
SHELL = """
import os, signal, subprocess, sys
job = subprocess.Popen([sys.executable, "-c", sys.argv[1]], process_group=0)
signal.signal(signal.SIGTTOU, signal.SIG_IGN)
os.tcsetpgrp(0, job.pid)
os.waitpid(job.pid, os.WUNTRACED)
os.tcsetpgrp(0, os.getpgrp())
print("stopped", flush=True)
sys.stdin.readline()
os.tcsetpgrp(0, job.pid)
os.killpg(job.pid, signal.SIGCONT)
sys.exit(job.wait())
"""


class Terminal:
    """A terminal and the program that controls it."""

    def __init__(self, *words):
        self.ours, theirs = pty.openpty()
        self.before = termios.tcgetattr(self.ours)
        self.text = ""

        def take_it():
            fcntl.ioctl(0, termios.TIOCSCTTY, 0)

        self.process = subprocess.Popen(
            [sys.executable, *map(str, words)], stdin=theirs, stdout=theirs, stderr=theirs,
            start_new_session=True, preexec_fn=take_it,
        )  # fmt: skip
        self.theirs = theirs  # kept open, so that the settings outlive the program

    def read(self, seconds=0.02):
        while select.select([self.ours], [], [], seconds)[0]:
            self.text += os.read(self.ours, 65536).decode(errors="replace")
            seconds = 0.0
        return self.text

    def expect(self, text, timeout=20.0):
        end = time.monotonic() + timeout
        while text not in self.read():
            assert time.monotonic() < end, f"{text!r} did not come: {self.text}"

    def type(self, text):
        os.write(self.ours, text.encode())

    def wait(self, timeout=20.0):
        end = time.monotonic() + timeout
        while self.process.poll() is None:
            self.read()  # a program that writes to a full terminal never ends
            assert time.monotonic() < end, self.text
        self.read()
        return self.process.returncode

    def settings(self):
        return termios.tcgetattr(self.ours)

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        os.close(self.ours)
        os.close(self.theirs)


@pytest.fixture
def terminal():
    made = []

    def make(*words):
        made.append(Terminal(*words))
        return made[-1]

    yield make
    for one in made:
        one.close()


def test_keys_come_at_once_and_the_terminal_is_as_before(terminal):
    screen = terminal("-c", ECHO)
    screen.expect("ready True")
    assert screen.settings() != screen.before
    screen.type(" +\x1b[A\x1bOD")
    for key in ("key  ", "key +", "key up", "key left"):
        screen.expect(key)
    screen.type("q")
    assert screen.wait() == 0
    assert screen.settings() == screen.before


@pytest.mark.parametrize("end", ["x", signal.SIGINT, signal.SIGHUP, signal.SIGQUIT])
def test_whatever_ends_the_program_the_terminal_is_as_before(terminal, end):
    screen = terminal("-c", ECHO)
    screen.expect("ready True")
    if isinstance(end, str):
        screen.type(end)
    else:
        screen.process.send_signal(end)
    assert screen.wait() != 0
    assert screen.settings() == screen.before


def test_a_stopped_program_leaves_the_terminal_and_takes_it_again(terminal):
    screen = terminal("-c", SHELL, ECHO)
    screen.expect("ready True")
    ours = screen.settings()
    screen.type("\x1a")  # Ctrl-Z
    screen.expect("stopped")
    assert screen.settings() == screen.before
    screen.type("\n")
    deadline = time.monotonic() + 10
    while screen.settings() != ours:
        assert time.monotonic() < deadline
        time.sleep(0.02)
    screen.type("q")
    assert screen.wait() == 0
    assert screen.settings() == screen.before


def test_without_a_terminal_there_are_no_keys():
    words = [sys.executable, "-c", ECHO.replace("+ 30", "+ 0.3")]
    answer = subprocess.run(words, input="q x", capture_output=True, text=True, timeout=30)
    assert (answer.returncode, answer.stdout, answer.stderr) == (0, "ready False\n", "")
    with Keyboard(-1) as keyboard:
        assert not keyboard.active and keyboard.typed() == []


@given(st.text(alphabet="\x1b[OABCD~1; +-q", max_size=30), st.integers(0, 30))
@example("\x1bO-A", 3)  # cut behind an intermediate byte
def test_keys_do_not_depend_on_how_the_terminal_cuts_them(text, at):
    first, rest = split_keys(text[:at])
    second, rest = split_keys(rest + text[at:])
    assert (first + second, rest) == split_keys(text)


@pytest.fixture
def bag(tmp_path):
    path = tmp_path / "in.mcap"
    with BagWriter(path) as writer:
        for i in range(100):
            writer.write("/numbers", header(i, "n"), 10**18 + i * 100_000_000)
    return path


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM])
def test_the_player_is_steered_by_keys_and_shows_where_it_is(graph, terminal, bag, end):
    got = graph.collect(graph.node("listener"), Header, "/numbers", 500)
    screen = terminal("-m", "geoprim_ros.nodes.bag_player", bag, "-p", "--wait-for-readers", 1)

    def shown(text):
        graph.spin_until(lambda: text in screen.read(0.0), what=f"{text!r} on the screen")

    shown("space     pause and go on")
    shown("playing: 0.0 of 9.9 s")
    shown("rate 1, 0 messages, paused")
    screen.type("\x1b[C\x1b[C")  # right, twice
    graph.spin_until(lambda: len(got) == 2)
    shown("playing: 0.1 of 9.9 s")
    screen.type("+++")
    shown("rate 1.331, 2 messages, paused")
    screen.type("-\x1b[B")  # slower twice
    shown("rate 1.1, 2 messages, paused")
    screen.type(" ")
    graph.spin_until(lambda: len(got) > 5)
    screen.type("\x1b[C")  # right: five seconds on
    graph.spin_until(lambda: got[-1].stamp.nanosec >= 50)
    screen.type(" \x1b[D")  # pause, and five seconds back
    graph.spin_for(0.3)
    del got[:]
    screen.type("\x1b[C")
    graph.spin_until(lambda: len(got) == 1)
    assert 0 < got[0].stamp.nanosec < 50
    assert screen.settings() != screen.before
    screen.process.send_signal(end)
    assert screen.wait() == 0
    assert screen.settings() == screen.before


def test_the_player_can_leave_the_terminal_alone(graph, terminal, bag):
    got = graph.collect(graph.node("listener"), Header, "/numbers", 500)
    words = ("--disable-keyboard-controls", "--quiet", "--wait-for-readers", 1, "-r", 20)
    screen = terminal("-m", "geoprim_ros.nodes.bag_player", bag, *words)
    graph.spin_until(lambda: len(got) > 3)
    assert screen.settings() == screen.before
    screen.type(" ")
    graph.spin_until(lambda: len(got) == 100)
    assert screen.wait() == 0
    assert "playing" not in screen.text
