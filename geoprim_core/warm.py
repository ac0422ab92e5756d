"""Compiling every kernel before it is needed."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from geoprim_core._check import AnyArray
from geoprim_core._jit import cache_base, source_digest
from geoprim_core.errors import InputError


def _detection() -> None:
    """Extract edges and detect by the default scheme."""
    from geoprim_core.ecc import detect_ellipses

    for image in warm_scenes():
        detect_ellipses(image)


def _schemes() -> None:
    """Detect by each of the schemes of the thesis."""
    from geoprim_core.ecc import TABLE, DetectorParams, detect_ellipses

    image, *_ = warm_scenes()
    for row in TABLE:
        detect_ellipses(image, DetectorParams.for_scheme(row.name))


def _fitting() -> None:
    """Fit ellipses, one at a time and many at once, and compare them."""
    from geoprim_core.fitting import TABLE, fit_ellipse, fit_ellipses, overlap_matrix
    from geoprim_core.types import Ellipses

    corners = ((1, 0), (0, 1), (-1, 0), (0, -1), (0.6, 0.8))
    points = [(30 + 20 * c, 30 + 10 * s) for c, s in corners]
    for row in TABLE:
        fit_ellipse(points, row.name)
        fit_ellipses([points], row.name)
    ellipses = Ellipses.from_array([[30, 30, 20, 10, 0]])
    overlap_matrix(ellipses, ellipses)


def _tangents() -> None:
    """Estimate tangents and curvature."""
    from geoprim_core.tangent import TABLE, curvatures

    corner = [(i, 0) for i in range(25)] + [(24, i) for i in range(1, 25)] + [(25, 25)]
    for row in TABLE:
        row.function(corner, closed=False, params=None)
    curvatures(corner, "deb")


def _polygons() -> None:
    """Approximate contours by polygons."""
    from geoprim_core.ecc import DetectorParams, find_polygons
    from geoprim_core.edges import extract_contours
    from geoprim_core.polygon import TABLE

    image, *_ = warm_scenes()
    contours = extract_contours(image)
    for row in TABLE:
        find_polygons(contours, DetectorParams(polygon_method=row.name))


# What takes long first: two processes then end at about the same time.
PARTS: dict[str, Callable[[], None]] = {
    "detection": _detection,
    "fitting": _fitting,
    "schemes": _schemes,
    "polygons": _polygons,
    "tangents": _tangents,
}


def warm_scenes() -> list[AnyArray]:
    """Return small pictures that between them bring every kernel of the detector to run.

    A disc, the same in noise, a drawn circle, and a disc with three dents: noisy pictures, line
    drawings and rough outlines have kernels of their own, for which a node would stop some seconds
    when the first such picture comes.

    Examples
    --------
    >>> [image.shape for image in warm_scenes()]
    [(80, 96), (80, 96), (80, 96), (240, 240)]
    """
    from geoprim_core.synthetic import disc_image

    disc = disc_image(96, 80, centre=(48.0, 40.0), radius=25.0)
    noise = np.random.default_rng(0).normal(0.0, 30.0, disc.shape)
    noisy = np.clip(disc + noise, 0, 255).astype(np.uint8)
    hole = disc_image(96, 80, centre=(48.0, 40.0), radius=23.0, inside=180, outside=0)
    y, x = np.mgrid[-120.0:120.0, -120.0:120.0]
    outside = np.hypot(x, y) - 90.0 * (1.0 + 0.028 * np.cos(3.0 * np.arctan2(y, x)))
    dented = (200.0 - 110.0 * np.clip(0.5 - outside, 0.0, 1.0)).astype(np.uint8)
    return [disc, noisy, disc - hole, dented]


def remove_other_kernels() -> int:
    """Remove what other versions and places of the package have left in the cache folder.

    They compile it again where they are still used.

    Returns
    -------
    int
        So many kernel files are forgotten.
    """
    base, rooms = cache_base(), Path(__file__).parent
    files = [] if base is None else rooms.rglob("_kernels*.py")
    ours = {f"{file.stem.lstrip('_')}-{source_digest(file)}" for file in files}
    found = [] if base is None else base.glob("kernels*-" + 16 * "[0-9a-f]")
    others = [folder for folder in found if folder.name not in ours]
    for folder in others:
        shutil.rmtree(folder, ignore_errors=True)
    return len(others)


def warm_kernels(
    parts: Sequence[str] = tuple(PARTS),
    processes: int = 1,
    step: Callable[[str], object] | None = None,
) -> None:
    """Run every method once on a small scene, so that no later call waits for a compiler.

    Parameters
    ----------
    parts : names of `PARTS`
        What to compile.
    processes : int
        So many parts at a time, each in a process of its own, which leaves the kernels in the
        cache folder; with 1 this process has them loaded afterwards.
    step : function of a name, optional
        Called with each part that is ready.

    Raises
    ------
    InputError
        There is no part of such a name, or not at least one process.

    Examples
    --------
    >>> warm_kernels(["polygons"], step=print)
    polygons
    """
    if not set(parts) <= set(PARTS):
        raise InputError("parts", f"some of {', '.join(PARTS)}", f"{list(parts)}")
    if processes < 1:
        raise InputError("processes", "at least 1", f"{processes}")
    ready = step or (lambda name: None)
    if processes == 1:
        for name in parts:
            PARTS[name]()
            ready(name)
        return
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        work = {pool.submit(PARTS[name]): name for name in parts}
        for done in as_completed(work):
            done.result()
            ready(work[done])
