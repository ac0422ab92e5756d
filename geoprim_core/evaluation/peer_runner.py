"""The other end of `evaluation.peers`: runs one detector in its own Python, which needs only numpy.

    python peer_runner.py MODULE:CALLABLE [elapsed|processor]

Reads an image (npy) after its length in 8 bytes from standard input; answers with one letter (R:
rows, E: error), the detector's seconds as a float64, the length in 8 bytes, and the rows (npy) or
the error's text. It is started as a file, so it imports nothing of the package.
"""

from __future__ import annotations

import importlib
import importlib.util
import io
import os
import struct
import sys
import time
from collections.abc import Callable
from typing import Any, BinaryIO

import numpy as np

HEAD = "<cdQ"
CLOCKS = {"elapsed": time.perf_counter, "processor": time.process_time}


def load_callable(target: str) -> Any:
    """Return the callable that "module:callable" or "file.py:callable" names."""
    module_name, _, name = target.rpartition(":")
    if not module_name or not name:
        raise ValueError(f"expected module:callable or file.py:callable, got {target!r}")
    if module_name.endswith(".py"):
        path = os.path.abspath(module_name)
        stem = os.path.splitext(os.path.basename(path))[0]
        spec = importlib.util.spec_from_file_location(stem, path)
        if spec is None or spec.loader is None or not os.path.exists(path):
            raise FileNotFoundError(f"no file {path}")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    else:
        module = importlib.import_module(module_name)
    found = getattr(module, name)
    if not callable(found):
        raise TypeError(f"{target} is not callable")
    return found


def answer(out: BinaryIO, letter: bytes, seconds: float, content: bytes) -> None:
    """Write one answer."""
    out.write(struct.pack(HEAD, letter, seconds, len(content)) + content)
    out.flush()


def read_exactly(source: BinaryIO, count: int) -> bytes:
    """Read so many bytes, or fewer where the input ends."""
    content = b""
    while len(content) < count:
        part = source.read(count - len(content))
        if not part:
            break
        content += part
    return content


def as_npy(array: Any) -> bytes:
    """Return an array as the bytes of an npy file."""
    content = io.BytesIO()
    np.save(content, array, allow_pickle=False)
    return content.getvalue()


def one_thread() -> None:
    """Keep the libraries that were loaded, and have a switch for it, to one thread."""
    for name, switch in (("cv2", "setNumThreads"), ("torch", "set_num_threads")):
        module = sys.modules.get(name)
        if module is not None and hasattr(module, switch):
            getattr(module, switch)(1)


def run_once(detector: Any, image: Any, out: BinaryIO, clock: Callable[[], float]) -> None:
    """Run the detector on one image and answer with its rows or its error."""
    start = clock()
    try:
        rows = np.asarray(detector(image), dtype=np.float64)
        seconds = clock() - start
        answer(out, b"R", seconds, as_npy(rows))
    except Exception as error:  # whatever a foreign detector raises is its answer
        text = f"{type(error).__name__}: {error}"
        answer(out, b"E", clock() - start, text.encode())


def main() -> int:
    """Serve images until the input ends."""
    # What the detector prints must not get into the answers.
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    sys.path[0] = os.getcwd()
    try:
        detector = load_callable(sys.argv[1])
    except Exception as error:
        answer(out, b"E", 0.0, f"{type(error).__name__}: {error}".encode())
        return 1
    one_thread()
    clock = CLOCKS[sys.argv[2] if len(sys.argv) > 2 else "elapsed"]
    answer(out, b"R", 0.0, b"")
    while len(head := read_exactly(sys.stdin.buffer, 8)) == 8:
        content = read_exactly(sys.stdin.buffer, struct.unpack("<Q", head)[0])
        run_once(detector, np.load(io.BytesIO(content), allow_pickle=False), out, clock)
    return 0


if __name__ == "__main__":
    sys.exit(main())
