"""Values on the command line: what is wrong with one is a line that says what was expected."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from typing import Any, NoReturn

from geoprim_core.errors import GeoprimError


class UsageError(GeoprimError):
    """The words of a command line are wrong; the message names the command."""


class Parser(argparse.ArgumentParser):
    """A parser whose refusal is one line, as that of the commands: what, expected, got."""

    def error(self, message: str) -> NoReturn:
        """Raise what is wrong, as every other refusal of a command."""
        said = message.removeprefix("argument ")
        raise UsageError(f"{self.prog}: {said}; see {self.prog} --help")

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        choices = action.choices
        if choices is not None and value not in choices:
            known = ", ".join(map(str, choices))
            raise argparse.ArgumentError(action, f"expected one of {known}, got {str(value)!r}")


def whole(low: int = 1, high: int | None = None) -> Callable[[str], int]:
    """Return the reader of a whole number within bounds.

    Examples
    --------
    >>> whole(1)("12")
    12
    >>> whole(0, 65535)("70000")
    Traceback (most recent call last):
    argparse.ArgumentTypeError: expected a whole number from 0 to 65535, got '70000'
    """
    bounds = f"of at least {low}" if high is None else f"from {low} to {high}"

    def read(text: str) -> int:
        value = _number(text, int)
        if value is None or value < low or (high is not None and value > high):
            raise _refusal(f"a whole number {bounds}", text)
        return int(value)

    return read


def ratio(text: str) -> float:
    """Read a number from 0 to 1.

    Examples
    --------
    >>> ratio("0.25")
    0.25
    """
    value = _number(text, float)
    if value is None or not 0 <= value <= 1:
        raise _refusal("a number from 0 to 1", text)
    return value


def positive(text: str) -> float:
    """Read a finite number above 0.

    Examples
    --------
    >>> positive("nan")
    Traceback (most recent call last):
    argparse.ArgumentTypeError: expected a number above 0, got 'nan'
    """
    value = _number(text, float)
    if value is None or not 0 < value < math.inf:
        raise _refusal("a number above 0", text)
    return value


def _number(text: str, kind: type[int] | type[float]) -> float | None:
    try:
        return kind(text)
    except ValueError:
        return None


def _refusal(expected: str, text: str) -> argparse.ArgumentTypeError:
    return argparse.ArgumentTypeError(f"expected {expected}, got {text!r}")
