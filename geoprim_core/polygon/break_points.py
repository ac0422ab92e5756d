"""Break points: where a curve leaves the straight line, the start of the suppressing methods."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import IntArray
from geoprim_core.params import Params, as_params, option
from geoprim_core.polygon._kernels_break import break_points_of

EXACT = 1e-9  # px; what rounding does to points on a line stays below it


@dataclass(frozen=True)
class BreakPointsParams(Params):
    """Parameters of the break points."""

    tolerance: float = option(
        EXACT,
        "distance of a point from its neighbours' line that is no bend",
        unit="px",
        low=0.0,
        high=1000.0,
    )


def break_points(
    points: npt.ArrayLike, *, closed: bool = False, params: BreakPointsParams | None = None
) -> IntArray:
    """Return the points at which a curve changes its direction.

    On a digital curve these are the pixels where the Freeman code changes, so that every other
    pixel lies exactly on an edge of the polygon; on a real-valued curve nearly all points. Of
    repeated points the first counts. A closed curve has two at least.

    Parameters
    ----------
    points : (n, 2) array
        Points of the curve in order; the first is not repeated at the end.
    closed : bool
        Whether the last point leads back to the first.
    params : BreakPointsParams, optional

    Returns
    -------
    (m,) int64
        Indices, strictly increasing; empty for an empty curve.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array.

    References
    ----------
    A. Masood, "Optimized polygonal approximation by dominant point deletion", Pattern
    Recognition 41, 2008; thesis 2.5.2.1, 2.6.5.

    Examples
    --------
    >>> break_points([(0, 0), (1, 0), (2, 0), (3, 1), (4, 2)]).tolist()
    [0, 2, 4]
    """
    chosen: BreakPointsParams = as_params(params, BreakPointsParams)
    indices: IntArray
    indices = break_points_of(_check.points(points), bool(closed), chosen.tolerance)
    return indices
