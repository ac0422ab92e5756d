"""Compiling ahead of time: every part, in this process or in others."""

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
