"""Carmona-mod: sweeps of break point suppression up to the digital bound."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray, IntArray
from geoprim_core.params import Params, as_params, option
from geoprim_core.polygon._kernels_break import break_points_of
from geoprim_core.polygon._kernels_carmona import carmona_of
from geoprim_core.polygon.bounds import RULES, rule_number
from geoprim_core.polygon.break_points import EXACT


@dataclass(frozen=True)
class CarmonaModParams(Params):
    """Parameters of Carmona-mod; the default rule is the printed one, as in the tables."""

    bound: str = option("thesis", "rule for the largest deviation of a segment", choices=RULES)
    refuse: bool = option(
        False, "refuse single deletions beyond the bound instead of ending with their sweep"
    )


def carmona_mod(
    points: npt.ArrayLike, *, closed: bool = False, params: CarmonaModParams | None = None
) -> IntArray:
    """Approximate a digital curve by sweeps of deletions without any tolerance to choose.

    The sweeps are those of `carmona`; the sweep after which the deviation of an edge exceeds
    its digital bound is the last, and its result is returned (errata P8: with the state before
    it the tables would hold a hundred vertices; "s phi" in (2-66) is s dphi_max, a bound rule).
    With `refuse` a deletion whose new edge would exceed its bound is refused instead, and the
    sweeps go on until no vertex can go: then no edge ever exceeds its bound.

    The break points are those of the curve's pixels, each the first point in it: where a
    real-valued curve has many points a pixel, all of them are break points close to their
    neighbours' line, and the first sweep would delete nearly all. The printed row of the sinc
    curve (Table 2.7-8) comes out so.

    Parameters
    ----------
    points : (n, 2) array
        Points of the curve in order, digital or not; the first is not repeated at the end.
    closed : bool
        Whether the last point leads back to the first.
    params : CarmonaModParams, optional

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
    D. K. Prasad, M. K. H. Leung, C. Quek and S.-Y. Cho, "A novel framework for making dominant
    point detection methods non-parametric", Image and Vision Computing 30, 2012; thesis 2.5.3.2,
    (2-66), (2-67), Figure 2.5-5(b); errata P4, P8.

    Examples
    --------
    >>> corner = [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (4, 1), (4, 2), (4, 3), (4, 4)]
    >>> carmona_mod(corner, params=CarmonaModParams(refuse=True)).tolist()
    [0, 4, 8]
    """
    chosen: CarmonaModParams = as_params(params, CarmonaModParams)
    curve = _check.points(points)
    start = break_points_of(_pixels(curve), bool(closed), EXACT)
    if len(start) <= 2:  # a curve within few pixels
        start = break_points_of(curve, bool(closed), EXACT)
    rule = rule_number(chosen.bound)
    indices: IntArray = carmona_of(curve, bool(closed), start, rule, 0.0, True, chosen.refuse)
    return indices


def _pixels(curve: FloatArray) -> FloatArray:
    """Return the pixels of points; one half-way between two stays there, mirrored or not."""
    pixels: FloatArray = 0.5 * (np.ceil(curve - 0.5) + np.floor(curve + 0.5))
    return pixels
