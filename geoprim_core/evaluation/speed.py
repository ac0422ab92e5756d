"""How long each stage of the chain takes, measured on one processor."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from geoprim_core._check import AnyArray, FloatArray
from geoprim_core.ecc import (
    DetectorParams,
    detect_ellipses,
    detect_from_contours,
    find_polygons,
)
from geoprim_core.ecc.refined.arcs import gather_edges, split_arcs
from geoprim_core.ecc.refined.candidates import pair_arcs, verify, vote
from geoprim_core.ecc.refined.detector import accept, cross_check, refit_chosen
from geoprim_core.edges import extract_contours
from geoprim_core.evaluation.peer_runner import CLOCKS

STAGES = ("edges", "polygons", "ecc")
REFINED_STAGES = ("edges", "arcs", "pairs", "verification", "selection and last refit")
"""Those of the `refined` scheme, which reads no polygons."""


@dataclass(frozen=True)
class ChainTimes:
    """Times of the chain, each the median over the repeats.

    Attributes
    ----------
    names : texts
    sizes : (width, height) of each image
    stages : texts
    seconds : (images, stages + 1) float64
        The last column is that of `detect_ellipses`, timed by itself.
    """

    names: tuple[str, ...]
    sizes: tuple[tuple[int, int], ...]
    stages: tuple[str, ...]
    seconds: FloatArray

    def markdown(self) -> str:
        """Return the table: stage, median and 95th percentile over the images, share."""
        columns = self.seconds * 1e3
        share = self.seconds.sum(axis=0) / self.seconds[:, :-1].sum() * 100
        lines = ["| stage | median ms | p95 ms | share |", "|---|---:|---:|---:|"]
        for i, stage in enumerate((*self.stages, "whole chain")):
            part = f"{share[i]:.0f} %" if i < len(self.stages) else "100 %"
            median, late = np.percentile(columns[:, i], [50, 95])
            lines.append(f"| {stage} | {median:.2f} | {late:.2f} | {part} |")
        width, height = np.median(self.sizes, axis=0)
        lines.append(f"\n{len(self.names)} images, median size {width:.0f}x{height:.0f}.")
        return "\n".join(lines)

    def rows(self) -> Iterator[list[str | int | float]]:
        """Yield one row an image: name, width, height, milliseconds of each stage and in all."""
        for name, size, times in zip(self.names, self.sizes, self.seconds * 1e3, strict=True):
            yield [name, *size, *(round(float(t), 4) for t in times)]


def measure_chain(
    images: Mapping[str, AnyArray],
    params: DetectorParams,
    repeat: int = 7,
    *,
    clock: str = "elapsed",
) -> ChainTimes:
    """Time the stages of the chain on images; each figure is the median of `repeat` runs.

    Parameters
    ----------
    images : name -> image
    params : DetectorParams
    repeat : int
    clock : str
        "elapsed" or "processor", which is steadier on a busy machine.

    Examples
    --------
    >>> from geoprim_core.synthetic import disc_image
    >>> disc = disc_image(64, 64, centre=(32, 32), radius=20)
    >>> times = measure_chain({"disc": disc}, DetectorParams.for_scheme("1"), repeat=1)
    >>> times.stages, times.seconds.shape, bool((times.seconds > 0).all())
    (('edges', 'polygons', 'ecc'), (1, 4), True)
    """
    now = CLOCKS[clock]
    steps = params.ecc.scheme == "refined"
    stages, time_stages = (REFINED_STAGES, _time_steps) if steps else (STAGES, _time_stages)
    with one_processor():
        seconds = [
            np.median([time_stages(image, params, now) for _ in range(repeat + 1)][1:], axis=0)
            for image in images.values()
        ]
    sizes = tuple((image.shape[1], image.shape[0]) for image in images.values())
    table = np.array(seconds).reshape(-1, len(stages) + 1)
    return ChainTimes(tuple(images), sizes, stages, table)


def _time_stages(image: AnyArray, params: DetectorParams, now: Callable[[], float]) -> list[float]:
    clock = [now()]
    contours = extract_contours(image, params.edges)
    clock.append(now())
    polygons = find_polygons(contours, params)
    clock.append(now())
    detect_from_contours(contours, polygons, params.ecc)
    clock.append(now())
    return [*np.diff(clock), _time_whole(image, params, now)]


def _time_steps(image: AnyArray, params: DetectorParams, now: Callable[[], float]) -> list[float]:
    settings = params.ecc.refined
    clock = [now()]
    contours = extract_contours(image, params.edges)
    clock.append(now())
    edges = gather_edges(contours, settings)
    arcs = split_arcs(edges, contours, settings)
    clock.append(now())
    candidates = vote(edges, pair_arcs(edges, arcs, settings), settings)
    clock.append(now())
    verified = verify(edges, arcs, candidates, settings)
    clock.append(now())
    verified = cross_check(edges, verified, settings)
    verified, chosen = accept(edges, arcs, verified, settings)
    refit_chosen(edges, arcs, verified, chosen, contours.image_size, settings)
    clock.append(now())
    return [*np.diff(clock), _time_whole(image, params, now)]


def _time_whole(image: AnyArray, params: DetectorParams, now: Callable[[], float]) -> float:
    start = now()
    detect_ellipses(image, params)
    return now() - start


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
