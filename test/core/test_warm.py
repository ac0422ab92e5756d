"""Compiling ahead of time: every part, in this process or in others."""

import subprocess
import sys

import pytest

from geoprim_core.errors import InputError
from geoprim_core.warm import PARTS, warm_kernels


@pytest.mark.parametrize("processes", [1, 2])
def test_every_part_is_compiled_once(processes):
    ready = []
    warm_kernels(processes=processes, step=ready.append)
    assert sorted(ready) == sorted(PARTS)


def test_unknown_parts_and_no_process_are_refused():
    with pytest.raises(
        InputError, match=r"parts: expected some of detection, .* got \['tangent'\]"
    ):
        warm_kernels(["tangent"])
    with pytest.raises(InputError, match="processes: expected at least 1, got 0"):
        warm_kernels(processes=0)


def test_what_a_plain_scene_lacks_is_compiled_too():
    """Rough outlines are rare: the first one must not wait for a compiler either."""
    script = """
from geoprim_core.ecc import _kernels_refined_rough_choice as choice
from geoprim_core.warm import warm_kernels

warm_kernels(["detection"])
assert choice.choose_rough.signatures and choice.rough_evidence.signatures
"""
    subprocess.run([sys.executable, "-c", script], check=True)
