"""How far the digitisation of a straight line may move its pixels and turn its slope.

Three rules (errata P4), s being the length of a segment and phi its slope:

`thesis`
    The printed (2-36), (2-37): d_max = s dphi_max, dependent on length and slope. It is called
    an upper bound there, but short digital lines exceed it.
`exact`
    The largest turn that end points moved by at most half a pixel in x and y can give. With
    c = abs(cos phi), n = abs(sin phi) and s > c + n it is the larger one of
    atan((c + n) / (s - abs(c - n))) and atan(abs(c - n) / (s - c - n)), else a right angle.
`released`
    The largest s tan(dphi) over all slopes, where dphi is the printed expression *before* its
    arc tangent is taken and the signs in t are paired with those of the end points. It depends
    on the length alone and reproduces the printed tables of RDP-mod. It is negative for
    s <= sqrt(2), so that no curve hides behind two neighbouring pixels, and between sqrt(2) and
    2, where the formula has a pole and no pair of pixels lies, the value of s = 2 holds.
"""

from __future__ import annotations

import numpy.typing as npt

from geoprim_core import _check
from geoprim_core.errors import ParameterError
from geoprim_core.polygon._kernels import deviation_bound_of, slope_bound_of

RULES = ("thesis", "exact", "released")


def rule_number(rule: str) -> int:
    """Return the number under which the kernels know a bound rule.

    Raises
    ------
    ParameterError
        The rule is unknown.

    Examples
    --------
    >>> rule_number("exact")
    1
    """
    if rule not in RULES:
        raise ParameterError("rule", "one of " + ", ".join(RULES), _check.describe(rule))
    return RULES.index(rule)


def deviation_bound(start: npt.ArrayLike, end: npt.ArrayLike, rule: str = "released") -> float:
    """Return d_max, the largest deviation that digitisation alone explains, in pixels.

    Parameters
    ----------
    start, end : (2,) array
        End points (x, y) of the segment in pixels.
    rule : {"thesis", "exact", "released"}

    Returns
    -------
    float
        In pixels; 0 for coincident end points.

    Raises
    ------
    InputError
        An end point is not two finite numbers.
    ParameterError
        The rule is unknown.

    References
    ----------
    Thesis (2-36), (2-37); errata P4.

    Examples
    --------
    >>> [round(deviation_bound((0, 0), (s, 0)), 3) for s in (3, 5, 10, 20)]
    [1.755, 1.518, 1.438, 1.42]
    """
    dx, dy = _check.finite(end, "end", (2,)) - _check.finite(start, "start", (2,))
    return float(deviation_bound_of(rule_number(rule), dx, dy))


def slope_bound(start: npt.ArrayLike, end: npt.ArrayLike, rule: str = "released") -> float:
    """Return dphi_max, the largest turn of a segment by digitisation alone, in radians.

    Parameters
    ----------
    start, end : (2,) array
        End points (x, y) of the segment in pixels.
    rule : {"thesis", "exact", "released"}

    Returns
    -------
    float
        In radians; a right angle for coincident end points.

    Raises
    ------
    InputError
        An end point is not two finite numbers.
    ParameterError
        The rule is unknown.

    References
    ----------
    Thesis (2-28), (2-36); errata P4.

    Examples
    --------
    >>> round(slope_bound((0, 0), (10, 0), "exact"), 4)  # atan(1 / 9)
    0.1107
    """
    dx, dy = _check.finite(end, "end", (2,)) - _check.finite(start, "start", (2,))
    return float(slope_bound_of(rule_number(rule), dx, dy))
