"""RDP: Ramer-Douglas-Peucker splitting with a tolerance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core.params import Params, option
from geoprim_core.polygon._kernels_split import TOLERANCE, split_curves
from geoprim_core.polygon._one_curve import of_one_curve


@dataclass(frozen=True)
class RdpParams(Params):
    """Parameters of RDP."""

    tolerance: float = option(
        1.0,
        "largest deviation of a pixel from its segment, d_tol",
        unit="px",
        low=0.0,
        high=10000.0,
    )


def rdp(
    points: npt.ArrayLike, *, closed: bool = False, params: RdpParams | None = None
) -> IntArray:
    """Approximate a curve by a polygon from which no pixel deviates by more than a tolerance.

    A segment is split at its pixel of largest deviation, the first of those that tie, until that
    is at most the tolerance (the printed (2-55) has < and the pseudo-code <=, which holds here).
    Deviation is the distance from the line through the segment's ends, or from the end where
    both coincide. An open curve keeps both ends; a closed one is first split at its two mutually
    farthest pixels.

    Parameters
    ----------
    points : (n, 2) array
        Points of the curve in order, digital or not; the first is not repeated at the end.
    closed : bool
        Whether the last point leads back to the first.
    params : RdpParams, optional

    Returns
    -------
    (m,) int64
        Indices of the dominant points, strictly increasing; empty for an empty curve.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array.

    References
    ----------
    U. Ramer, "An iterative procedure for the polygonal approximation of plane curves", Computer
    Graphics and Image Processing 1, 1972; D. Douglas and T. Peucker, "Algorithms for the
    reduction of the number of points required to represent a digitized line or its caricature",
    Cartographica 10, 1973; thesis 2.5.1.1, (2-53)-(2-55); errata P6.

    Examples
    --------
    >>> step = [(0, 0), (1, 0), (2, 1), (3, 1)]
    >>> rdp(step).tolist(), rdp(step, params=RdpParams(tolerance=0.3)).tolist()
    ([0, 3], [0, 1, 2, 3])
    """
    return of_one_curve(rdp_batch, points, closed, params, RdpParams)


def rdp_batch(
    points: FloatArray, offsets: IntArray, closed: BoolArray, params: RdpParams
) -> tuple[IntArray, IntArray]:
    """Approximate many curves in one kernel call; arguments as in `Contours`.

    A curve that would cost a plain search more than a few looks at every point, a comb or a
    spiral, is searched through the convex hulls of its blocks, with the same result.

    Returns
    -------
    indices : (M,) int64
    offsets : (K + 1,) int64
        As in `Polygons`.

    Examples
    --------
    >>> import numpy as np
    >>> line = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    >>> indices, offsets = rdp_batch(line, np.array([0, 3]), np.array([False]), RdpParams())
    >>> indices.tolist(), offsets.tolist()
    ([0, 2], [0, 2])
    """
    result: tuple[IntArray, IntArray]
    result = split_curves(points, offsets, closed, TOLERANCE, params.tolerance)
    return result
