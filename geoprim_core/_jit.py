"""The one door to numba: `kernel` compiles a numeric function and keeps it on disk.

A kernel takes arrays and scalars and returns arrays, scalars or named tuples; it does no
checks and sees no strings or globals other than numbers and other kernels.

numba's disk cache only watches the file that a function stands in, so a kernel that calls a
kernel of another file would go stale when that one changes. The cache folder of a kernel file
therefore carries a digest of that file and of all kernel files that it imports, directly or not.
"""

from __future__ import annotations

import hashlib
import os
import re
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
import numpy as np
from numba.core import event

Function = TypeVar("Function", bound=Callable[..., Any])

_ROOT = Path(__file__).resolve().parent
_IMPORT = re.compile(r"^from geoprim_core\.([\w.]*_kernels\w*) import", re.MULTILINE)

_KEPT = 1 << 24  # bytes


def keep_freed_memory() -> None:
    """Let the allocator keep the memory that one image frees for the next one.

    glibc gives free memory back to the system when it exceeds twice the largest block that was
    ever freed. The arrays of a chain on small images do, and the system clears their pages anew
    for each image: a tenth of the time. A larger block, made and freed without being touched,
    raises that bound; as much memory is kept at most. Elsewhere it does nothing.
    """
    np.empty(_KEPT, np.uint8)


keep_freed_memory()


@cache
def cache_base() -> Path | None:
    """Return the folder that holds all compiled kernels, or None where none can be written.

    `GEOPRIM_CACHE_DIR` overrides the default, `geoprim` below the user's cache folder.
    """
    home = Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser() / "geoprim"
    base = Path(os.environ.get("GEOPRIM_CACHE_DIR") or home)
    try:
        base.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=base):
            return base
    except OSError:
        return None


def kernel_files(source: Path) -> list[Path]:
    """Return a kernel file and all kernel files that it imports, directly or not, sorted."""
    found = {source}
    waiting = [source]
    while waiting:
        for name in _IMPORT.findall(waiting.pop().read_text()):
            path = _ROOT.joinpath(*name.split(".")).with_suffix(".py")
            if path not in found:
                found.add(path)
                waiting.append(path)
    return sorted(found)


@cache
def source_digest(source: Path) -> str:
    """Return a digest of a kernel file, of what it imports, of this one, and of the versions."""
    digest = hashlib.sha256(f"{numba.__version__} {sys.version} {source}".encode())
    for file in (Path(__file__), *kernel_files(source)):
        digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


def kernel(function: Function) -> Function:
    """Compile a numeric function with numba on first call and keep the result on disk.

    Without a writable cache folder the kernel is compiled anew in every process.
    """
    return _compiled(function)


def inlined_kernel(function: Function) -> Function:
    """Compile like `kernel`, into each of its callers: a loop around a call is not vectorised.

    For what is called in such a loop and is too long for the compiler to inline it by itself.
    """
    return _compiled(function, inline="always")


def inner_kernel(function: Function) -> Function:
    """Compile like `kernel`, for what other kernels call and what allocates and returns no array.

    References to arrays are not counted: the caller holds them. Elsewhere each call counts each
    array up and down, which are two atomic operations of some twenty cycles; without them a
    detection takes a tenth less.
    """
    return _compiled(function, _nrt=False)


def summing_kernel(function: Function) -> Function:
    """Compile like `inner_kernel`, with sums taken in as many parts as the processor has lanes.

    For sums over many numbers whose last digit does not matter: it depends on the processor. A
    product and a sum are one rounding where it can. The order is that of the compiled code, so the
    same numbers have the same sum each time.
    """
    return _compiled(function, fastmath={"contract", "reassoc"}, _nrt=False)


@contextmanager
def telling_of_compiling(tell: Callable[[], object]) -> Iterator[None]:
    """Call `tell` once, before a kernel is compiled that is not on disk yet."""
    with event.install_listener("numba:compile", _Once(tell)):
        yield


class _Once(event.Listener):  # type: ignore[misc]
    """Calls a function at the first event."""

    def __init__(self, tell: Callable[[], object]) -> None:
        self._waiting = [tell]

    def on_start(self, event: Any) -> None:
        """Call it, if it has not been called yet."""
        while self._waiting:
            self._waiting.pop()()

    def on_end(self, event: Any) -> None:
        """Do nothing."""


def _compiled(function: Function, **options: Any) -> Function:
    # The last is said of each, or a kernel has it from whatever is compiled first that calls it.
    options = {"nogil": True, "error_model": "numpy", "_nrt": True} | options
    base = cache_base()
    if base is None:
        return cast(Function, numba.njit(**options)(function))
    before = numba.config.CACHE_DIR
    source = Path(function.__code__.co_filename)
    # Read once, while the function is decorated.
    numba.config.CACHE_DIR = str(base / f"{source.stem.lstrip('_')}-{source_digest(source)}")
    try:
        return cast(Function, numba.njit(cache=True, **options)(function))
    finally:
        numba.config.CACHE_DIR = before
