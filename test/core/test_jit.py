"""The kernel cache: it follows every source, and without a writable folder things still run."""

import os
import platform
import subprocess
import sys

import numpy as np
import pytest
from numba.core.errors import TypingError

from geoprim_core import _jit


def test_the_digest_follows_the_file_and_the_kernel_files_it_imports(tmp_path, monkeypatch):
    monkeypatch.setattr(_jit, "_ROOT", tmp_path)
    (tmp_path / "room").mkdir()
    inner = tmp_path / "room" / "_kernels_inner.py"
    outer = tmp_path / "_kernels.py"
    other = tmp_path / "_kernels_other.py"
    inner.write_text("a = 1")
    other.write_text("b = 1")
    outer.write_text("from geoprim_core.room._kernels_inner import a")
    assert _jit.kernel_files(outer) == [outer, inner]
    digest = _jit.source_digest.__wrapped__
    first = digest(outer), digest(other)
    inner.write_text("a = 2")
    assert digest(outer) != first[0]
    assert digest(other) == first[1]


def test_a_cache_that_cannot_be_written_is_passed_over():
    script = (
        "from geoprim_core import _jit; import numba\n"
        "assert _jit.cache_base() is None\n"
        "before = numba.config.CACHE_DIR\n"
        "double = _jit.kernel(lambda x: 2.0 * x)\n"
        "assert double(21.0) == 42.0 and numba.config.CACHE_DIR == before"
    )
    environment = {**os.environ, "GEOPRIM_CACHE_DIR": "/dev/null/nowhere"}
    subprocess.run([sys.executable, "-c", script], env=environment, check=True)


def test_an_inner_kernel_may_call_what_allocates_but_not_allocate():
    @_jit.kernel
    def doubled(x):
        return np.sum(2.0 * np.ones(3) * x)

    @_jit.inner_kernel
    def calls(values):
        return doubled(values[0])

    @_jit.inner_kernel
    def allocates(values):
        return np.empty(3)[0] + values[0]

    values = np.array([7.0])
    before = sys.getrefcount(values)
    assert [calls(values) for _ in range(3)] == [42.0] * 3
    assert sys.getrefcount(values) == before
    with pytest.raises(TypingError):
        allocates(values)


def test_a_summing_kernel_gives_the_sum_each_time():
    @_jit.summing_kernel
    def squares(values):
        total = 0.0
        for k in range(len(values)):
            total += values[k] * values[k]
        return total

    values = np.random.default_rng(1).normal(size=1001)
    assert abs(squares(values) - np.dot(values, values)) < 1e-9
    assert {squares(values.copy()) for _ in range(20)} == {squares(values)}


def test_every_kernel_has_one_specialisation():
    """As called from Python; in a process of its own, as other tests call them with what they like.

    All kernels are in the cache then: one that is compiled has a form for each literal number too.
    """
    warm = "from geoprim_core.warm import warm_kernels; warm_kernels()"
    subprocess.run([sys.executable, "-c", warm], check=True)
    script = """
from importlib import import_module
from pathlib import Path
import geoprim_core
from geoprim_core.synthetic import sorting_sequence
from geoprim_core.warm import warm_kernels

warm_kernels()
frame = next(iter(sorting_sequence("coins", seed=1, frames=1)))
for image in (frame.image, frame.image[:, :, 0].copy()):
    geoprim_core.detect_ellipses(image)
core = Path(geoprim_core.__file__).parent
for file in core.rglob("_kernels*.py"):
    parts = file.relative_to(core).with_suffix("").parts
    for name, value in vars(import_module("geoprim_core." + ".".join(parts))).items():
        signatures = getattr(value, "signatures", [])
        assert len(signatures) <= 1, f"{file.name}: {name} was compiled for {signatures}"
"""
    subprocess.run([sys.executable, "-c", script], check=True)


def test_repeated_detections_ask_the_system_for_no_memory():
    """The allocator is glibc's own affair: elsewhere nothing is claimed."""
    if platform.libc_ver()[0] != "glibc":
        pytest.skip("another C library")
    script = """
import resource
import numpy as np
import geoprim_core

image = np.zeros((480, 640), np.uint8)  # no larger array has been freed yet
image[100:300, 150:400] = 200
for _ in range(4):
    geoprim_core.detect_ellipses(image)
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range(10):
    geoprim_core.detect_ellipses(image)
faults = (resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before) / 10
assert faults < 100, f"{faults} pages a call, of which an image in float32 alone has 300"
"""
    subprocess.run([sys.executable, "-c", script], check=True)


def test_the_first_compiling_is_told_once_and_what_is_on_disk_is_not(tmp_path):
    """Somebody who installed the package waited two minutes for the first image, without a word."""
    file = tmp_path / "_kernels_pair.py"
    file.write_text(
        "from geoprim_core._jit import kernel\n"
        "@kernel\ndef double(x):\n    return 2.0 * x\n"
        "@kernel\ndef triple(x):\n    return 3.0 * x\n"
    )
    script = (
        "from geoprim_core._jit import telling_of_compiling\n"
        "import _kernels_pair as pair\n"
        "with telling_of_compiling(lambda: print('told')):\n"
        "    pair.double(1.0)\n"
        "    pair.triple(1.0)\n"
    )
    environment = {**os.environ, "GEOPRIM_CACHE_DIR": str(tmp_path)}
    told = [
        subprocess.run(
            [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n{script}"],
            env=environment, check=True, capture_output=True, text=True,
        ).stdout
        for _ in range(2)
    ]  # fmt: skip
    assert told == ["told\n", ""]
