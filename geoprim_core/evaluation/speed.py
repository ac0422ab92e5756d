"""How long each stage of the chain takes, measured on one processor."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from geoprim_core._check import AnyArray, FloatArray
from geoprim_core.ecc import DetectorParams, detect_from_contours, find_polygons
from geoprim_core.edges import extract_contours

STAGES = ("edges", "polygons", "ecc")


@dataclass(frozen=True)
class ChainTimes:
    """Times of the chain: `seconds` is (images, stages), each the median over the repeats."""

    names: tuple[str, ...]
    sizes: tuple[tuple[int, int], ...]
    seconds: FloatArray

    def markdown(self) -> str:
        """Return the table: stage, median and 95th percentile over the images, share."""
        columns = np.column_stack([self.seconds, self.seconds.sum(axis=1)]) * 1e3
        share = self.seconds.sum(axis=0) / self.seconds.sum() * 100
        lines = ["| stage | median ms | p95 ms | share |", "|---|---:|---:|---:|"]
        for i, stage in enumerate((*STAGES, "whole chain")):
            part = f"{share[i]:.0f} %" if i < len(STAGES) else "100 %"
            median, late = np.percentile(columns[:, i], [50, 95])
            lines.append(f"| {stage} | {median:.2f} | {late:.2f} | {part} |")
        width, height = np.median(self.sizes, axis=0)
        lines.append(f"\n{len(self.names)} images, median size {width:.0f}x{height:.0f}.")
        return "\n".join(lines)

    def rows(self) -> Iterator[list[str | int | float]]:
        """Yield one row an image: name, width, height, milliseconds of each stage and in all."""
        for name, size, times in zip(self.names, self.sizes, self.seconds * 1e3, strict=True):
            yield [name, *size, *(round(float(t), 4) for t in (*times, times.sum()))]


def measure_chain(
    images: Mapping[str, AnyArray], params: DetectorParams, repeat: int = 7
) -> ChainTimes:
    """Time the stages of the chain on images; each figure is the median of `repeat` runs.

    Examples
    --------
    >>> from geoprim_core.synthetic import disc_image
    >>> disc = disc_image(64, 64, centre=(32, 32), radius=20)
    >>> times = measure_chain({"disc": disc}, DetectorParams(), repeat=1)
    >>> times.seconds.shape, bool((times.seconds > 0).all())
    ((1, 3), True)
    """
    with one_processor():
        seconds = [
            np.median([_time_stages(image, params) for _ in range(repeat + 1)][1:], axis=0)
            for image in images.values()
        ]
    sizes = tuple((image.shape[1], image.shape[0]) for image in images.values())
    return ChainTimes(tuple(images), sizes, np.array(seconds).reshape(-1, len(STAGES)))


def _time_stages(image: AnyArray, params: DetectorParams) -> FloatArray:
    clock = [time.perf_counter()]
    contours = extract_contours(image, params.edges)
    clock.append(time.perf_counter())
    polygons = find_polygons(contours, params)
    clock.append(time.perf_counter())
    detect_from_contours(contours, polygons, params.ecc)
    clock.append(time.perf_counter())
    return np.diff(clock)


def measure_first_detection() -> float:
    """Return the seconds from starting a Python process to its first detection."""
    script = (
        "import numpy as np, geoprim_core\n"
        "image = np.zeros((480, 640), np.uint8)\n"
        "y, x = np.mgrid[:480, :640]\n"
        "image[(x - 320) ** 2 + (y - 240) ** 2 < 90 ** 2] = 255\n"
        "assert len(geoprim_core.detect_ellipses(image)) == 1"
    )
    start = time.perf_counter()
    subprocess.run([sys.executable, "-c", script], check=True)
    return time.perf_counter() - start


@contextmanager
def one_processor() -> Iterator[None]:
    """Keep this process on one processor for a while, where the system lets it choose."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(before)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)
