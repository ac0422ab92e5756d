"""Detectors side by side: ours in this process, any other one in a process of its own."""

from __future__ import annotations

import io
import os
import select
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any, Protocol

import numpy as np

from geoprim_core import _check
from geoprim_core._check import AnyArray, FloatArray, describe
from geoprim_core.ecc import DetectorParams, detect_ellipses
from geoprim_core.errors import GeoprimError, InputError
from geoprim_core.evaluation.peer_runner import CLOCKS, HEAD, as_npy
from geoprim_core.evaluation.speed import one_processor
from geoprim_core.types import Ellipses

_RUNNER = Path(__file__).with_name("peer_runner.py")
_START_LIMIT = 120.0
_LONGEST_LIMIT = 86400.0
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """What one detector answered to one image.

    Attributes
    ----------
    ellipses : Ellipses, n of them
    score : (n,) float64 or None
        None: the detector gives no scores.
    seconds : float
        Time inside the detector; NaN where it did not answer.
    problem : str
        Why there is no answer; empty where there is one.
    """

    ellipses: Ellipses
    score: FloatArray | None
    seconds: float
    problem: str = ""


class DetectorUnderTest(Protocol):
    """A detector with a name; `close` ends what it holds."""

    @property
    def name(self) -> str:
        """The name in the tables."""

    def run(self, image: AnyArray) -> Run:
        """Detect the ellipses of an image."""

    def close(self) -> None:
        """End what the detector holds."""


@dataclass(frozen=True, slots=True, eq=False)
class OwnDetector:
    """`detect_ellipses` with its parameters, timed in this process by "elapsed" or "processor"."""

    name: str
    params: DetectorParams = field(default_factory=DetectorParams)
    clock: str = "elapsed"

    def run(self, image: AnyArray) -> Run:
        """Detect the ellipses of an image.

        Examples
        --------
        >>> OwnDetector("refined").run(np.zeros((40, 50), np.uint8)).problem
        ''
        """
        clock = CLOCKS[self.clock]
        start = clock()
        try:
            found = detect_ellipses(image, self.params)
        except GeoprimError as problem:
            return _failed(str(problem))
        return Run(found.ellipses, found.score, clock() - start)

    def close(self) -> None:
        """Nothing is held."""


class Peer:
    """Any detector, given as "module:callable", in a process of its own.

    The callable takes an image, (H, W) or (H, W, 3) uint8 in the order blue, green, red, and
    returns rows (n, 5) or (n, 6): x, y, semi_major, semi_minor in pixels, angle in radians, and a
    score if it has one. One that raises, ends or does not answer in time has a `problem` for that
    image, and is started again for the next one where it has to be.

    Parameters
    ----------
    name : str
    target : str
        "module:callable", found from the current folder on, or "file.py:callable".
    python : path or None
        The Python that runs it, which needs numpy; None: this one.
    time_limit : float
        Longest time of one image in seconds.
    clock : "elapsed" or "processor"
        The time that passes in the detector, or that its process spends on the processor.

    Raises
    ------
    InputError
        The time limit is not above 0 or is above a day, the clock unknown, or the process or the
        callable cannot be started.
    """

    def __init__(
        self,
        name: str,
        target: str,
        *,
        python: str | os.PathLike[str] | None = None,
        time_limit: float = 30.0,
        clock: str = "elapsed",
    ) -> None:
        if not 0 < time_limit <= _LONGEST_LIMIT:
            expected = f"seconds above 0, at most {_LONGEST_LIMIT:g}"
            raise InputError("time_limit", expected, f"{time_limit}")
        if clock not in CLOCKS:
            raise InputError("clock", f"one of {', '.join(CLOCKS)}", repr(clock))
        self.name = name
        self._command = [os.fspath(python or sys.executable), str(_RUNNER), target, clock]
        self._time_limit = time_limit
        self._process: subprocess.Popen[bytes] | None = None
        self._complaints: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115, closed by `close`
        problem = self._start()
        if problem:
            self.close()
            raise InputError(f"peer {name}", "a callable that can be loaded", problem)

    def run(self, image: AnyArray) -> Run:
        """Detect the ellipses of an image.

        Raises
        ------
        ImageError
            That is no image.
        """
        problem = "" if self._process else self._start()
        if problem:
            return _failed(problem)
        content = as_npy(as_bytes(image))
        try:
            self._stdin.write(struct.pack("<Q", len(content)) + content)
            self._stdin.flush()
        except OSError:
            return _failed(self._ended())
        letter, seconds, body = self._answer(self._time_limit)
        if letter != b"R":
            return _failed(body.decode(errors="replace"))
        return _checked_run(np.load(io.BytesIO(body), allow_pickle=False), seconds)

    def close(self) -> None:
        """End the process."""
        self._end()
        self._complaints.close()

    @property
    def _stdin(self) -> IO[bytes]:
        assert self._process is not None and self._process.stdin is not None
        return self._process.stdin

    def _start(self) -> str:
        """Start the process; return what went wrong."""
        environment = {**os.environ, **dict.fromkeys(_THREADS, "1")}
        try:
            with one_processor():  # the process inherits it
                self._process = subprocess.Popen(
                    self._command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                    stderr=self._complaints, env=environment, bufsize=0,
                )  # fmt: skip
        except OSError as error:
            return f"{self._command[0]}: {error.strerror}"
        letter, _, body = self._answer(_START_LIMIT)
        if letter == b"R":
            return ""
        self._end()
        return body.decode(errors="replace")

    def _answer(self, limit: float) -> tuple[bytes, float, bytes]:
        """Return letter, seconds and content of the next answer; E where there is none."""
        deadline = time.monotonic() + limit
        try:
            head = self._read(struct.calcsize(HEAD), deadline)
            letter, seconds, length = struct.unpack(HEAD, head)
            return letter, seconds, self._read(length, deadline)
        except TimeoutError:
            self._end()
            return b"E", np.nan, f"no answer within {limit:g} s".encode()
        except EOFError:
            return b"E", np.nan, self._ended().encode()

    def _read(self, count: int, deadline: float) -> bytes:
        assert self._process is not None and self._process.stdout is not None
        pipe, content = self._process.stdout, b""
        while len(content) < count:
            left = deadline - time.monotonic()
            if left <= 0 or not select.select([pipe], [], [], left)[0]:
                raise TimeoutError
            part = os.read(pipe.fileno(), min(count - len(content), 1 << 20))
            if not part:
                raise EOFError
            content += part
        return content

    def _ended(self) -> str:
        """Reap a process that went away by itself; return how it ended."""
        assert self._process is not None
        try:
            code = self._process.wait(timeout=5.0)
        except subprocess.TimeoutExpired:
            code = None  # it closed its output only
        self._complaints.seek(0)
        lines = self._complaints.read().decode(errors="replace").strip().splitlines()
        self._end()
        return f"ended with code {code}" + (f": {lines[-1]}" if lines else "")

    def _end(self) -> None:
        if self._process is None:
            return
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                pipe.close()
        self._process = None


def as_bytes(image: AnyArray) -> AnyArray:
    """Return an image as other detectors take it: uint8, (H, W) or (H, W, 3), C order.

    Sixteen bits lose their lower eight, numbers are stretched from their lowest to their highest,
    alpha is dropped.

    Examples
    --------
    >>> as_bytes(np.array([[0, 65535]], np.uint16)).tolist()
    [[0, 255]]
    """
    checked = _check.image(image)
    if checked.ndim == 3:
        checked = checked[:, :, :3]
    if checked.dtype == np.uint16:
        checked = (checked >> 8).astype(np.uint8)
    elif checked.dtype != np.uint8:
        low, high = float(checked.min()), float(checked.max())
        checked = ((checked - low) * (255.0 / max(high - low, 1e-300))).round().astype(np.uint8)
    return np.ascontiguousarray(checked)


def _failed(problem: str) -> Run:
    return Run(Ellipses.from_array([]), None, float("nan"), problem)


def _checked_run(rows: Any, seconds: float) -> Run:
    """Return the answer, or refuse rows that are no ellipses and say which."""
    try:
        ellipses, score = ellipse_rows(rows)
    except InputError as refusal:
        return _failed(str(refusal))
    return Run(ellipses, score, seconds)


def ellipse_rows(rows: Any) -> tuple[Ellipses, FloatArray | None]:
    """Return the ellipses and scores of a detector's rows; any angle will do.

    Parameters
    ----------
    rows : (n, 5) or (n, 6)
        x, y, semi_major, semi_minor, angle in radians, and a score.

    Raises
    ------
    InputError
        Another shape, a number that is not finite, or axes that are none; it names the row.

    Examples
    --------
    >>> ellipses, score = ellipse_rows([[9, 8, 5, 4, -0.5, 0.9]])
    >>> ellipses.angle.round(3).tolist(), score.tolist()
    ([2.642], [0.9])
    """
    array = np.asarray(rows)
    if array.size == 0:
        return Ellipses.from_array([]), None
    if array.ndim != 2 or array.shape[1] not in (5, 6) or array.dtype.kind not in "iuf":
        raise InputError("rows", "an array (n, 5) or (n, 6)", describe(array))
    values = array.astype(np.float64)
    a, b = values[:, 2], values[:, 3]
    bad = ~np.isfinite(values).all(axis=1) | ~(a >= b) | ~(b > 0)
    if bad.any():
        worst = int(np.flatnonzero(bad)[0])
        expected = "finite numbers with semi_major >= semi_minor > 0"
        raise InputError("rows", expected, f"{values[worst].tolist()} in row {worst}")
    values[:, 4] %= np.pi
    values[values[:, 4] >= np.pi, 4] = 0.0  # the remainder of a tiny negative angle
    score = values[:, 5].copy() if values.shape[1] == 6 else None
    return Ellipses.from_array(values[:, :5]), score


def own_detectors(schemes: Sequence[str], clock: str = "elapsed") -> list[OwnDetector]:
    """Return our detector with the settings of each scheme.

    Examples
    --------
    >>> [detector.name for detector in own_detectors(["refined", "3"])]
    ['refined', 'scheme 3']
    """
    names = [scheme if scheme == "refined" else f"scheme {scheme}" for scheme in schemes]
    return [
        OwnDetector(name, DetectorParams.for_scheme(scheme), clock)
        for name, scheme in zip(names, schemes, strict=True)
    ]
