"""Compiling ahead of time: every part, in this process or in others."""

import subprocess
import sys
from pathlib import Path

import pytest

from geoprim_core.errors import InputError
from geoprim_core.fitting import _kernels_fit
from geoprim_core.warm import PARTS, remove_other_kernels, warm_kernels


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


def test_kernels_of_other_versions_are_removed(tmp_path, monkeypatch):
    """Each version and each folder leaves some forty megabytes behind."""
    kept = Path(_kernels_fit.reduced._cache.cache_path).parent.name
    folders = [kept, "kernels_fit-0123456789abcdef", "kernels-notes", "else-0123456789abcdef"]
    for name in folders:
        (tmp_path / name / "inner").mkdir(parents=True)
    monkeypatch.setattr("geoprim_core.warm.cache_base", lambda: tmp_path)
    assert remove_other_kernels() == 1
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(folders[:1] + folders[2:])


LATER = """
import sys
import numpy as np
from geoprim_core import detect_ellipses
from geoprim_core.synthetic import circles_image, thesis_image
from geoprim_core.warm import warm_kernels

def compiled():
    rooms = ("edges", "polygon", "tangent", "fitting", "ecc", "digital")
    return {
        f"{module.__name__}.{name}": len(kernel.signatures)
        for module in list(sys.modules.values())
        if module.__name__.startswith(tuple(f"geoprim_core.{room}._kernels" for room in rooms))
        for name, kernel in vars(module).items()
        if hasattr(kernel, "signatures")
    }

warm_kernels(["detection"])
before = compiled()
for hard in (False, True):
    for noise in (0.0, 25.0, 60.0):
        for drawing in ("filled", "outlines"):
            detect_ellipses(circles_image(9, 1, drawing=drawing, noise=noise, hard=hard).image)
for kind in ("occluded", "overlapping"):
    for drawing in ("filled", "outlines"):
        grey = thesis_image(8, 1, kind=kind, drawing=drawing, inks=drawing == "outlines").image
        detect_ellipses(grey)
        detect_ellipses(np.dstack([grey, grey // 2, grey // 3]))
        detect_ellipses(grey.astype(np.uint16) * 200)
        detect_ellipses(grey / 255.0)
print(len(before), *(name for name, count in compiled().items() if count > before.get(name, 0)))
"""


def test_no_picture_waits_for_a_compiler_afterwards():
    """A live graph stood still for 12 s at its first noisy picture."""
    words = [sys.executable, "-c", LATER]
    answer = subprocess.run(words, capture_output=True, text=True, check=True, timeout=300)
    known, *late = answer.stdout.split()
    assert int(known) > 100
    assert late == []
