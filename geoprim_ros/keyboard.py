"""Single keys of a terminal, whose settings are put back whatever ends the program.

What cannot be put back after is SIGKILL, which no program hears of; `stty sane` helps then.
"""

from __future__ import annotations

import atexit
import os
import re
import select
import signal
import sys
import termios
import threading
import tty
from types import FrameType, TracebackType
from typing import Any, Self

_ARROWS = {"A": "up", "B": "down", "C": "right", "D": "left"}
# An arrow (CSI or SS3), any other escape sequence, or a character.
_KEY = re.compile(r"\x1b[\[O](?P<arrow>[ABCD])|\x1b[\[O][0-9;]*[ -/]*[@-~]|(?P<key>.)", re.DOTALL)
# Signals that end the program at once, and those around a stop.
_ENDS = (signal.SIGHUP, signal.SIGQUIT)
_READ_BYTES = 256


class Keyboard:
    """Reads keys without waiting; a context manager.

    It does nothing where the input is no terminal, as with a pipe or under a service manager, or
    where the program runs in its background.

    Parameters
    ----------
    descriptor : int or None
        The terminal, standard input by default.

    Attributes
    ----------
    active : bool
        Whether there is a terminal to read from.
    """

    def __init__(self, descriptor: int | None = None) -> None:
        self._descriptor = _standard_input() if descriptor is None else descriptor
        self._before: list[Any] | None = None
        self._handlers: dict[int, Any] = {}
        self._rest = ""
        self.active = self._descriptor >= 0 and os.isatty(self._descriptor)

    def __enter__(self) -> Self:
        self.active = self.active and _in_foreground(self._descriptor)
        if self.active:
            self._before = termios.tcgetattr(self._descriptor)
            atexit.register(self.restore)
            self._handle_signals()
            self._single_keys()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Put the terminal back as it was."""
        self.restore()
        atexit.unregister(self.restore)
        for number, handler in self._handlers.items():
            signal.signal(number, handler)
        self.active = False

    def typed(self) -> list[str]:
        """Return what was typed since the last call: characters, and left, right, up, down."""
        if not self.active or not _in_foreground(self._descriptor):
            return []  # reading in the background stops a program
        if not select.select([self._descriptor], [], [], 0.0)[0]:
            return []
        try:
            data = os.read(self._descriptor, _READ_BYTES)
        except OSError:  # the terminal is gone
            data = b""
        self.active = bool(data)
        text, self._rest = split_keys(self._rest + data.decode(errors="ignore"))
        return text

    def restore(self) -> None:
        """Put the settings of the terminal back; harmless where that is done."""
        if self._before is not None and _in_foreground(self._descriptor):
            try:
                termios.tcsetattr(self._descriptor, termios.TCSANOW, self._before)
            except termios.error:  # the terminal is gone
                self.active = False

    def _single_keys(self) -> None:
        """Hand over every key at once, unseen; Ctrl-C and Ctrl-Z do what they always do."""
        tty.setcbreak(self._descriptor, termios.TCSANOW)

    def _handle_signals(self) -> None:
        if threading.current_thread() is not threading.main_thread():
            return
        handlers = {**dict.fromkeys(_ENDS, self._end), signal.SIGTSTP: self._stop}
        for number, handler in handlers.items():
            if signal.getsignal(number) == signal.SIG_DFL:
                self._handlers[number] = signal.signal(number, handler)

    def _end(self, number: int, frame: FrameType | None) -> None:
        self.restore()
        signal.signal(number, signal.SIG_DFL)
        os.kill(os.getpid(), number)

    def _stop(self, number: int, frame: FrameType | None) -> None:
        """Stop as Ctrl-Z asks, the terminal as it was meanwhile."""
        self.restore()
        signal.signal(number, signal.SIG_DFL)
        os.kill(os.getpid(), number)  # returns when the program goes on
        signal.signal(number, self._stop)
        if _in_foreground(self._descriptor):
            self._single_keys()


def split_keys(text: str) -> tuple[list[str], str]:
    r"""Return the keys in what a terminal sent, and the beginning of a key that is not whole yet.

    Examples
    --------
    >>> split_keys(" +\x1b[A\x1bOD\x1b[3~q\x1b[")
    ([' ', '+', 'up', 'left', 'q'], '\x1b[')
    """
    start = re.search(r"\x1b(?:[\[O][0-9;]*[ -/]*)?\Z", text)
    whole, rest = (text[: start.start()], start.group()) if start else (text, "")
    keys = [
        _ARROWS[found["arrow"]] if found["arrow"] else found["key"]
        for found in _KEY.finditer(whole)
        if found["arrow"] or found["key"]
    ]
    return keys, rest


def _standard_input() -> int:
    try:
        return sys.stdin.fileno()
    except (AttributeError, OSError, ValueError):  # none, closed, or one that a test put there
        return -1


def _in_foreground(descriptor: int) -> bool:
    try:
        return os.tcgetpgrp(descriptor) == os.getpgrp()
    except OSError:
        return False
