"""The exceptions of geoprim: wrong input raises, ordinary failure is a value with a reason."""

from __future__ import annotations


class GeoprimError(Exception):
    """Base of every exception that geoprim raises on purpose."""


class InputError(GeoprimError, ValueError):
    """An argument is wrong; the message names it, what was expected and what came.

    Examples
    --------
    >>> raise InputError("points", "an (N, 2) array", "an array of shape (7,)")
    Traceback (most recent call last):
    ...
    geoprim_core.errors.InputError: points: expected an (N, 2) array, got an array of shape (7,)
    """

    def __init__(self, argument: str, expected: str, got: str) -> None:
        super().__init__(f"{argument}: expected {expected}, got {got}")
        self.argument = argument
        self.expected = expected
        self.got = got

    def __reduce__(self) -> tuple[type, tuple[str, str, str]]:
        """Keep the three parts when the exception crosses a process border."""
        return type(self), (self.argument, self.expected, self.got)


class ParameterError(InputError):
    """A parameter is unknown, of the wrong type or out of its range."""


class ImageError(InputError):
    """An image cannot be used: empty, of a wrong shape or type, or not finite."""


class FileError(GeoprimError, OSError):
    """A file cannot be read or written; the message says which one and why."""


class BagError(FileError):
    """A bag cannot be read as asked; the message says what was found in it."""


class MissingPackageError(GeoprimError, ImportError):
    """An optional package is not installed; the message says which command installs it."""
