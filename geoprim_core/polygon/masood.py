"""Masood: suppression of break points, with optimised neighbours, by the squared error."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import IntArray
from geoprim_core.params import Params, as_params, option
from geoprim_core.polygon._kernels_break import break_points_of
from geoprim_core.polygon._kernels_masood import masood_of
from geoprim_core.polygon.break_points import EXACT


@dataclass(frozen=True)
class MasoodParams(Params):
    """Parameters of Masood's method; 0.9 is the published limit, a squared deviation."""

    tolerance: float = option(
        0.9, "largest squared deviation of a pixel, d_tol", unit="px^2", low=0.0, high=1e8
    )
    refuse: bool = option(
        False, "refuse deletions beyond the tolerance instead of ending with the first one"
    )
    window: int = option(
        8,
        "search for a vertex's place ends this far beyond the last gain",
        unit="points",
        low=1,
        high=1000000,
    )
    moves: int = option(
        3, "neighbours that may move on either side of a deletion", low=0, high=1000
    )


def masood(
    points: npt.ArrayLike, *, closed: bool = False, params: MasoodParams | None = None
) -> IntArray:
    """Approximate a curve by deleting break points, the one that costs least first.

    The associated error value (AEV) of a vertex is the squared error (ISE) after its deletion
    less that before (errata P7 turns the sign of (2-57)). With a deletion its neighbours move:
    first the one before, between *its* neighbours, to where the ISE of both adjacent edges is
    least, then the one before that, and so on while a move gains; then the same onwards. The
    vertex of least AEV goes (the printed pseudo-code misses that step), of equal ones the first
    on the curve, until the largest squared deviation exceeds the tolerance (2-58). The polygon
    that does is returned, as in the printed tables; with `refuse` such a deletion is refused
    instead, others go on, and the tolerance holds. The ends of an open curve stay; on a closed
    one every vertex may move or go, down to two.

    Values are recomputed only where a deletion was seen and the ISE of a segment comes from
    running moments; with the limits on `moves` and `window`, which the thesis does not have, the
    time grows almost linearly. Large values lift them: on the thesis' curves the number of
    vertices then changes by a few in either direction.

    Parameters
    ----------
    points : (n, 2) array
        Points of the curve in order, digital or not; the first is not repeated at the end.
    closed : bool
        Whether the last point leads back to the first.
    params : MasoodParams, optional

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
    A. Masood, "Optimized polygonal approximation by dominant point deletion", Pattern
    Recognition 41, 2008; thesis 2.5.2.1, (2-56)-(2-58), Figure 2.5-3(a); errata P7.

    Examples
    --------
    >>> masood([(0, 0), (1, 0), (2, 1), (3, 1), (4, 2), (5, 2)]).tolist()
    [0, 5]
    """
    chosen: MasoodParams = as_params(params, MasoodParams)
    curve = _check.points(points)
    start = break_points_of(curve, bool(closed), EXACT)
    indices: IntArray = masood_of(
        curve, bool(closed), start, -1, chosen.tolerance, chosen.refuse, chosen.window, chosen.moves
    )
    return indices
