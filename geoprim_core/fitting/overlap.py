"""Overlap of ellipses, exact and without a raster."""

from __future__ import annotations

import numpy as np

from geoprim_core._check import FloatArray, describe
from geoprim_core.errors import InputError
from geoprim_core.fitting._kernels_overlap import overlap_of, overlap_table
from geoprim_core.fitting.shape import ellipse_row
from geoprim_core.types import Ellipse, Ellipses


def overlap_ratio(a: Ellipse, b: Ellipse) -> float:
    """Return the overlap ratio of two ellipses: shared area divided by the area of the union.

    The areas are those of the continuous ellipses, so the ratio does not depend on a pixel
    grid; it is exact up to rounding.

    Parameters
    ----------
    a, b : Ellipse
        In pixels.

    Returns
    -------
    float
        In [0, 1]; 1 for equal ellipses, 0 for separate ones.

    Raises
    ------
    InputError
        An argument is not an Ellipse.

    References
    ----------
    Thesis (5-9), there by counting pixels; the Jaccard index.

    Examples
    --------
    >>> outer, inner = Ellipse(50, 40, 30, 20, 0.5), Ellipse(50, 40, 15, 10, 0.5)
    >>> round(overlap_ratio(outer, inner), 12)
    0.25
    """
    return float(overlap_of(ellipse_row(a, "a"), ellipse_row(b, "b")))


def overlap_matrix(a: Ellipses, b: Ellipses) -> FloatArray:
    """Return the overlap ratio of every ellipse of one set with every ellipse of another.

    Parameters
    ----------
    a, b : Ellipses
        n and m ellipses in pixels.

    Returns
    -------
    (n, m) float64
        Overlap ratios in [0, 1], as `overlap_ratio` gives them.

    Raises
    ------
    InputError
        An argument is not an Ellipses.

    References
    ----------
    Thesis (5-9).

    Examples
    --------
    >>> discs = Ellipses([0, 100], [0, 0], [10, 10], [10, 10], [0, 0])
    >>> overlap_matrix(discs, discs).tolist()
    [[1.0, 0.0], [0.0, 1.0]]
    """
    for name, value in (("a", a), ("b", b)):
        if not isinstance(value, Ellipses):
            raise InputError(name, "an Ellipses", describe(value))
    first, second = np.ascontiguousarray(a.array()), np.ascontiguousarray(b.array())
    table: FloatArray = overlap_table(first, second)
    return table
