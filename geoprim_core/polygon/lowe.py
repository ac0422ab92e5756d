"""Lowe: splitting all the way, then the segments of highest significance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import IntArray
from geoprim_core.params import Params, as_params, option
from geoprim_core.polygon._kernels_lowe import lowe_of


@dataclass(frozen=True)
class LoweParams(Params):
    """Parameters of Lowe's method."""

    shortest: float = option(
        4.0, "segments shorter than this are not split", unit="px", low=0.0, high=10000.0
    )
    floor: float = option(
        1.0, "deviations below this count as this", unit="px", low=1e-6, high=10000.0
    )


def lowe(
    points: npt.ArrayLike, *, closed: bool = False, params: LoweParams | None = None
) -> IntArray:
    """Approximate a curve by the segments that are longest for their deviation.

    The curve is split at the point of largest deviation, as by `rdp`, down to short segments.
    Back up the tree, a segment takes the place of all those below it unless one of them is more
    significant; the significance is s / max(d), length over largest deviation.

    Two things are decided here. Segments whose deviation is at least `shortest` are split even
    if their ends are near each other, else a hairpin would be one segment. Straight runs along
    an axis have no deviation and would be infinitely significant: deviations below `floor` count
    as that; at the default of one pixel, which no digital straight segment reaches, any such
    segment is at least as significant as each of its parts.

    Parameters
    ----------
    points : (n, 2) array
        Points of the curve in order, digital or not; the first is not repeated at the end.
    closed : bool
        Whether the last point leads back to the first; the curve is first split at its two
        mutually farthest points.
    params : LoweParams, optional

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
    D. G. Lowe, "Three-dimensional object recognition from single two-dimensional images",
    Artificial Intelligence 31, 1987; thesis 2.6.3.

    Examples
    --------
    >>> corner = [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (4, 1), (4, 2), (4, 3), (4, 4)]
    >>> lowe(corner).tolist()
    [0, 4, 8]
    """
    chosen: LoweParams = as_params(params, LoweParams)
    indices: IntArray
    indices = lowe_of(_check.points(points), bool(closed), chosen.shortest, chosen.floor)
    return indices
