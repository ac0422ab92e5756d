"""How far the digitisation of a straight line may move its pixels and turn its slope.

Six rules, s being the length of a segment and phi its slope. Three for the bound of the thesis
(errata P4):

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

And those that the thesis compares it with (2.4.3):

`dss4`
    d_DSS = abs(sin phi) + abs(cos phi), the width of a 4-connected digital straight segment.
`dss8`
    max(abs(sin phi), abs(cos phi)), that of an 8-connected one (errata P5). No pixel of a
    digital straight segment is as far as that from the chord between its ends.
`tan`
    d_tan = s asin(sqrt(2) / s), from end points moved by at most half a pixel's diagonal; the
    turn is a right angle for s <= sqrt(2). It depends on the length alone.
"""

from __future__ import annotations

import numpy.typing as npt

from geoprim_core import _check
from geoprim_core.errors import ParameterError
from geoprim_core.polygon._kernels import deviation_bound_of, slope_bound_of

RULES = ("thesis", "exact", "released", "dss4", "dss8", "tan")


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
    rule : {"thesis", "exact", "released", "dss4", "dss8", "tan"}

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
    Thesis (2-36), (2-37), (2-46), (2-49); errata P4, P5.

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
    rule : {"thesis", "exact", "released", "dss4", "dss8", "tan"}

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
    Thesis (2-28), (2-36), (2-48); errata P4, P5.

    Examples
    --------
    >>> round(slope_bound((0, 0), (10, 0), "exact"), 4)  # atan(1 / 9)
    0.1107
    """
    dx, dy = _check.finite(end, "end", (2,)) - _check.finite(start, "start", (2,))
    return float(slope_bound_of(rule_number(rule), dx, dy))


def dss_bound(start: npt.ArrayLike, end: npt.ArrayLike, connectivity: int = 8) -> float:
    """Return d_DSS, the width of a digital straight segment of this slope, in pixels.

    Parameters
    ----------
    start, end : (2,) array
        End points (x, y) of the segment in pixels.
    connectivity : 4 or 8
        Whether neighbouring pixels share a side or also a corner only.

    Returns
    -------
    float
        In pixels; 0 for coincident end points.

    Raises
    ------
    InputError
        An end point is not two finite numbers.
    ParameterError
        The connectivity is neither 4 nor 8.

    References
    ----------
    J.-P. Reveilles, "Geometrie discrete, calcul en nombres entiers et algorithmique", these
    d'etat, Strasbourg, 1991; thesis 2.4.3.1, (2-46); errata P5.

    Examples
    --------
    >>> round(dss_bound((0, 0), (4, 3)), 3), round(dss_bound((0, 0), (4, 3), connectivity=4), 3)
    (0.8, 1.4)
    """
    if connectivity not in (4, 8):
        raise ParameterError("connectivity", "4 or 8", _check.describe(connectivity))
    return deviation_bound(start, end, f"dss{connectivity}")


def tan_bound(start: npt.ArrayLike, end: npt.ArrayLike) -> float:
    """Return d_tan, the deviation that the simplified turn of a segment gives, in pixels.

    Raises
    ------
    InputError
        An end point is not two finite numbers.

    References
    ----------
    Thesis 2.4.3.2, (2-48), (2-49).

    Examples
    --------
    >>> [round(tan_bound((0, 0), (s, 0)), 3) for s in (2, 5, 1000)]
    [1.571, 1.434, 1.414]
    """
    return deviation_bound(start, end, "tan")
