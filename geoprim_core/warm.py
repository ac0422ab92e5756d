"""Compiling every kernel before it is needed."""

from __future__ import annotations

from collections.abc import Iterable


def warm_kernels(schemes: Iterable[str] | None = None) -> None:
    """Run the chain once on a small scene, so that no later call waits for a compiler.

    Parameters
    ----------
    schemes : names of ECC schemes, default all of them
    """
    from geoprim_core.ecc import TABLE, DetectorParams, detect_ellipses
    from geoprim_core.fitting import TABLE as FITTERS
    from geoprim_core.fitting import fit_ellipse
    from geoprim_core.synthetic import disc_image
    from geoprim_core.tangent import TABLE as TANGENTS
    from geoprim_core.tangent import curvatures

    image = disc_image(96, 80, centre=(48.0, 40.0), radius=25.0)
    for scheme in [row.name for row in TABLE] if schemes is None else schemes:
        detect_ellipses(image, DetectorParams.for_scheme(scheme))
    points = [(30 + 20 * c, 30 + 10 * s) for c, s in ((1, 0), (0, 1), (-1, 0), (0, -1), (0.6, 0.8))]
    for row in FITTERS:
        fit_ellipse(points, row.name)
    corner = [(i, 0) for i in range(25)] + [(24, i) for i in range(1, 25)] + [(25, 25)]
    for row in TANGENTS:
        row.function(corner, closed=False, params=None)
    curvatures(corner, "deb")
