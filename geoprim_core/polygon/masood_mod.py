"""Masood-mod: suppression of break points by the largest deviation, up to the digital bound."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import IntArray
from geoprim_core.params import Params, as_params, option
from geoprim_core.polygon._kernels_break import break_points_of
from geoprim_core.polygon._kernels_masood import masood_of
from geoprim_core.polygon.bounds import RULES, rule_number
from geoprim_core.polygon.break_points import EXACT


@dataclass(frozen=True)
class MasoodModParams(Params):
    """Parameters of Masood-mod.

    The default rule is the printed one: it comes nearest to the published tables, whose largest
    deviations lie between 0.79 and 1.27 pixels.
    """

    bound: str = option("thesis", "rule for the largest deviation of a segment", choices=RULES)
    refuse: bool = option(
        False, "refuse deletions beyond the bound instead of ending before the first one"
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


def masood_mod(
    points: npt.ArrayLike, *, closed: bool = False, params: MasoodModParams | None = None
) -> IntArray:
    """Approximate a digital curve by deleting break points without any tolerance to choose.

    As `masood`, but a vertex moves to where the larger deviation of both adjacent edges is
    least, the associated error value (AEV) is a largest deviation, and the method ends before a
    deletion whose AEV exceeds the digital bound of the new edge (2-61). Where the text is
    unclear (errata P7) this holds: both edges of a moved vertex count, not only one; the AEV
    (2-60) is taken over the edges that change (the others take part in the printed maximum but
    would decide nothing: a method that ends at the first excess has none before); "s phi" in
    (2-62) is s dphi_max, a bound rule; the new edge is the one between the moved neighbours, and
    two neighbouring points always pass. With `refuse` every edge that changes is held against
    its own bound, such deletions are refused and others go on: then no edge exceeds its bound.

    Parameters
    ----------
    points : (n, 2) array
        Points of the curve in order, digital or not; the first is not repeated at the end.
    closed : bool
        Whether the last point leads back to the first.
    params : MasoodModParams, optional

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
    point detection methods non-parametric", Image and Vision Computing 30, 2012; thesis 2.5.2.2,
    (2-59)-(2-62), Figure 2.5-3(b); errata P4, P7.

    Examples
    --------
    >>> corner = [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (4, 1), (4, 2), (4, 3), (4, 4)]
    >>> masood_mod(corner).tolist()
    [0, 4, 8]
    """
    chosen: MasoodModParams = as_params(params, MasoodModParams)
    curve = _check.points(points)
    start = break_points_of(curve, bool(closed), EXACT)
    rule = rule_number(chosen.bound)
    indices: IntArray = masood_of(
        curve, bool(closed), start, rule, 0.0, chosen.refuse, chosen.window, chosen.moves
    )
    return indices
