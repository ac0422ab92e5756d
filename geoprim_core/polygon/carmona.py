"""Carmona: suppression of break points in sweeps of growing tolerance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import IntArray
from geoprim_core.params import Params, as_params, option
from geoprim_core.polygon._kernels_break import break_points_of
from geoprim_core.polygon._kernels_carmona import carmona_of
from geoprim_core.polygon.break_points import EXACT

STOPS = ("above", "below")


@dataclass(frozen=True)
class CarmonaParams(Params):
    """Parameters of Carmona-Poyato's method; 0.45 is the ratio of the thesis' experiment 4."""

    ratio: float = option(
        0.45, "r_tol: the sweeps end when r_i has passed it", low=0.0, high=1000.0
    )
    stop: str = option("above", "side of r_tol on which r_i ends the sweeps", choices=STOPS)


def carmona(
    points: npt.ArrayLike, *, closed: bool = False, params: CarmonaParams | None = None
) -> IntArray:
    """Approximate a curve by deleting break points near their neighbours' line, sweep by sweep.

    Sweep i goes along the curve once and deletes each vertex whose distance (2-63) from the line
    of its present neighbours is below d_tol = i / 2 pixels (as the pseudo-code; the text would
    go back to the first vertex after every deletion). A closed curve starts at the break point
    that is farthest from its neighbours' line; that one stays, and one other.

    After a sweep r_i is the largest loss of perimeter by one of its deletions (2-64) over the
    largest deviation (2-65). The printed rule ends when r_i < r_tol, which contradicts Table
    2.5-3, where the higher r_tol never has more vertices (errata P9). Here the sweeps end when
    r_i >= r_tol (`stop="above"`), with which the number of vertices never grows with r_tol;
    `stop="below"` is the printed rule. A sweep that deletes nothing says nothing: the next one
    follows, and d_tol skips to where a vertex can go. Neither rule reproduces the printed rows
    of the original method; where r_i never reaches r_tol hardly a vertex is left, and
    `carmona_mod` is the better choice.

    Parameters
    ----------
    points : (n, 2) array
        Points of the curve in order, digital or not; the first is not repeated at the end.
    closed : bool
        Whether the last point leads back to the first.
    params : CarmonaParams, optional

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
    A. Carmona-Poyato, F. J. Madrid-Cuevas, R. Medina-Carnicer and R. Munoz-Salinas, "Polygonal
    approximation of digital planar curves through break point suppression", Pattern Recognition
    43, 2010; thesis 2.5.3.1, (2-63)-(2-65), Figure 2.5-5(a); errata P9.

    Examples
    --------
    >>> step = [(0, 0), (1, 0), (2, 0), (3, 1), (4, 1), (5, 1), (5, 2), (5, 3), (5, 4), (5, 5)]
    >>> carmona(step, params=CarmonaParams(ratio=0.1)).tolist()
    [0, 5, 9]
    """
    chosen: CarmonaParams = as_params(params, CarmonaParams)
    curve = _check.points(points)
    start = break_points_of(curve, bool(closed), EXACT)
    above = chosen.stop == "above"
    indices: IntArray = carmona_of(curve, bool(closed), start, -1, chosen.ratio, above, False)
    return indices
