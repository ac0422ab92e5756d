"""Compiling every kernel before it is needed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context

from geoprim_core._check import AnyArray
from geoprim_core.errors import InputError


def _detection() -> None:
    """Extract edges and detect by the default scheme, a rough outline too."""
    import numpy as np

    from geoprim_core.ecc import detect_ellipses
    from geoprim_core.ecc.refined_arcs import gather_edges
    from geoprim_core.ecc.refined_params import RefinedParams
    from geoprim_core.ecc.refined_rough import find_rough_outlines
    from geoprim_core.edges import extract_contours
    from geoprim_core.synthetic import disc_image

    detect_ellipses(_scene())
    contours = extract_contours(disc_image(120, 120, centre=(60.0, 60.0), radius=45.0))
    params = RefinedParams()
    unclaimed = np.zeros(len(contours.points), np.bool_)
    find_rough_outlines(
        gather_edges(contours, params), contours, unclaimed, np.empty((0, 5)), params
    )


def _schemes() -> None:
    """Detect by each of the schemes of the thesis."""
    from geoprim_core.ecc import TABLE, DetectorParams, detect_ellipses

    for row in TABLE:
        detect_ellipses(_scene(), DetectorParams.for_scheme(row.name))


def _fitting() -> None:
    """Fit ellipses, one at a time and many at once."""
    from geoprim_core.fitting import TABLE, fit_ellipse, fit_ellipses

    corners = ((1, 0), (0, 1), (-1, 0), (0, -1), (0.6, 0.8))
    points = [(30 + 20 * c, 30 + 10 * s) for c, s in corners]
    for row in TABLE:
        fit_ellipse(points, row.name)
        fit_ellipses([points], row.name)


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

    contours = extract_contours(_scene())
    for row in TABLE:
        find_polygons(contours, DetectorParams(polygon_method=row.name))


def _scene() -> AnyArray:
    from geoprim_core.synthetic import disc_image

    return disc_image(96, 80, centre=(48.0, 40.0), radius=25.0)


# What takes long first: two processes then end at about the same time.
PARTS: dict[str, Callable[[], None]] = {
    "detection": _detection,
    "fitting": _fitting,
    "schemes": _schemes,
    "polygons": _polygons,
    "tangents": _tangents,
}


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
