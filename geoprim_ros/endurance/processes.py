"""Nodes in processes of their own: started, killed, ended."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO

END_LIMIT_S = 30.0
SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Processes:
    """The processes of a trial, by name; what they write goes to files.

    Parameters
    ----------
    folder : where those files are written
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._running: dict[str, subprocess.Popen[bytes]] = {}

    def start(self, name: str, module: str, words: Sequence[str | Path] = ()) -> int:
        """Start a module of `geoprim_ros.nodes` and return the number of its process."""
        command = [sys.executable, "-m", f"geoprim_ros.nodes.{module}", *map(str, words)]
        with self._log(name) as file:
            self._running[name] = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=file, stderr=file
            )
        return self._running[name].pid

    def numbers(self) -> dict[str, int]:
        """Return the process numbers by name."""
        return {name: process.pid for name, process in self._running.items()}

    def ended(self) -> dict[str, int]:
        """Return the exit codes of those that have ended of themselves."""
        codes = {name: process.poll() for name, process in self._running.items()}
        return {name: code for name, code in codes.items() if code is not None}

    def kill(self, name: str) -> None:
        """End a process as `kill -9` does."""
        process = self._running.pop(name)
        process.kill()
        process.wait()

    def end(self, name: str, number: int = signal.SIGINT) -> int:
        """Send a signal and return the exit code; -9 where the process has to be killed."""
        process = self._running.pop(name)
        if process.poll() is None:
            process.send_signal(number)
        try:
            return process.wait(END_LIMIT_S)
        except subprocess.TimeoutExpired:
            process.kill()
            return process.wait()

    def end_all(self) -> dict[str, int]:
        """End all with SIGINT; return the exit codes."""
        for process in self._running.values():
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
        return {name: self.end(name, 0) for name in list(self._running)}

    def said(self, name: str) -> str:
        """Return what a process wrote."""
        return self._path(name).read_text(errors="replace")

    def _path(self, name: str) -> Path:
        return self._folder / f"{name}.log"

    @contextmanager
    def _log(self, name: str) -> Iterator[IO[bytes]]:
        with self._path(name).open("ab") as file:
            yield file
