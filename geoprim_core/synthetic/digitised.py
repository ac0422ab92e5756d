"""Digitised curves with the true tangent at every pixel: circles, ellipses, flower curves.

Digitisation is that of the grid's lines: wherever the curve crosses a line of the grid, the pixel
on this line nearest to the crossing is taken. The pixels are 8-connected and thin, straight pieces
are digital straight segments, and no pixel is more than half a pixel from the curve along its
line.

The true tangent of a pixel is that of the curve at its point nearest to the pixel's centre, looked
for within one pixel along the curve from the crossing that gave the pixel (so that another branch
of the curve that passes nearby does not count). It points in the direction of travel.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from geoprim_core import _check
from geoprim_core._check import FloatArray, IntArray
from geoprim_core.errors import InputError
from geoprim_core.types import Contours

Curve = Callable[[FloatArray], FloatArray]
"""Parameters (n,) -> points (n, 2); closed, of period 2 pi."""

_PER_PIXEL = 8  # samples a pixel of length
_NEWTON = 10


@dataclass(frozen=True, slots=True, eq=False)
class DigitisedCurve:
    """A closed digital curve with the truth at each pixel.

    Attributes
    ----------
    points : (n, 2) float64
        Pixels (x, y) in order, 8-connected.
    tangent : (n,) float64
        Direction of travel of the curve at its point nearest to the pixel, in radians.
    parameter : (n,) float64
        The curve's parameter at that point.
    """

    points: FloatArray
    tangent: FloatArray
    parameter: FloatArray


def digitise(curve: Curve, derivative: Curve) -> DigitisedCurve:
    """Digitise a closed curve of period 2 pi.

    Parameters
    ----------
    curve, derivative : functions
        Parameters (n,) -> points (n, 2) and their derivatives (n, 2) by the parameter.

    Examples
    --------
    >>> curve = lambda t: 9.0 * np.stack([np.cos(t), np.sin(t)], axis=1)
    >>> found = digitise(curve, lambda t: curve(t + np.pi / 2))
    >>> found.points[-1].tolist(), round(float(found.tangent[-1]), 6)
    ([9.0, 0.0], 1.570796)
    """
    t = _samples(curve, derivative)
    points = curve(t)
    points[-1] = points[0]  # a period on, up to rounding: no crossing may be lost at the seam
    pixels, crossing = _crossings(t, points)
    nearest = _nearest(curve, derivative, pixels, crossing)
    dx, dy = derivative(nearest).T
    return DigitisedCurve(pixels, np.arctan2(dy, dx), nearest % (2.0 * np.pi))


def digital_circle(radius: float, centre: tuple[float, float] = (0.0, 0.0)) -> DigitisedCurve:
    """Digitise a circle, travelled from +x towards +y.

    Raises
    ------
    InputError
        The radius is below 1 px.

    Examples
    --------
    >>> len(digital_circle(100.0).points)
    564
    """
    return digital_ellipse(radius, radius, 0.0, centre)


def digital_ellipse(
    semi_major: float,
    semi_minor: float,
    angle: float = 0.0,
    centre: tuple[float, float] = (0.0, 0.0),
) -> DigitisedCurve:
    """Digitise an ellipse, travelled from +x towards +y.

    Parameters
    ----------
    semi_major, semi_minor : float
        In pixels, at least 1.
    angle : float
        Of the major axis, in radians.
    centre : (x, y)

    Raises
    ------
    InputError
        A semi-axis is below 1 px.

    Examples
    --------
    >>> found = digital_ellipse(20.0, 10.0)
    >>> found.points.max(axis=0).tolist()
    [20.0, 10.0]
    """
    for name, value in (("semi_major", semi_major), ("semi_minor", semi_minor)):
        _at_least_one(value, name)
    c, s = math.cos(angle), math.sin(angle)
    axes = np.array([[semi_major * c, semi_major * s], [-semi_minor * s, semi_minor * c]])

    def curve(t: FloatArray) -> FloatArray:
        points: FloatArray = np.stack([np.cos(t), np.sin(t)], axis=1) @ axes
        points += np.asarray(centre)
        return points

    def derivative(t: FloatArray) -> FloatArray:
        slopes: FloatArray = np.stack([-np.sin(t), np.cos(t)], axis=1) @ axes
        return slopes

    return digitise(curve, derivative)


def flower_curve(
    lobes: int,
    outer: float = 100.0,
    depth: float = 0.5,
    centre: tuple[float, float] = (0.0, 0.0),
) -> DigitisedCurve:
    """Digitise the flower curve r = R_out (1 - b sin(n theta)) / (1 + b).

    Parameters
    ----------
    lobes : int
        n, at least 1.
    outer : float
        R_out in pixels, at least 1.
    depth : float
        b, from 0 to below 1; R_in / R_out = (1 - b) / (1 + b).
    centre : (x, y)

    Raises
    ------
    InputError
        An argument is out of its range.

    References
    ----------
    Thesis (3-34).

    Examples
    --------
    >>> r = np.hypot(*flower_curve(5).points.T)
    >>> bool(abs(r.max() - 100.0) < 1) and bool(abs(r.min() - 100.0 / 3.0) < 1)
    True
    """
    _at_least_one(outer, "outer")
    _at_least_one(lobes, "lobes")
    if not 0.0 <= depth < 1.0:
        raise InputError("depth", "a number from 0 to below 1", _check.describe(depth))
    scale = outer / (1.0 + depth)

    def curve(t: FloatArray) -> FloatArray:
        r = scale * (1.0 - depth * np.sin(lobes * t))
        points: FloatArray = np.stack([r * np.cos(t), r * np.sin(t)], axis=1) + np.asarray(centre)
        return points

    def derivative(t: FloatArray) -> FloatArray:
        r = scale * (1.0 - depth * np.sin(lobes * t))
        dr = -scale * depth * lobes * np.cos(lobes * t)
        c, s = np.cos(t), np.sin(t)
        return np.stack([dr * c - r * s, dr * s + r * c], axis=1)

    return digitise(curve, derivative)


def as_contours(curves: list[DigitisedCurve]) -> Contours:
    """Return closed contours of digitised curves, in their order.

    Examples
    --------
    >>> len(as_contours([digital_circle(5.0), digital_circle(7.0)]))
    2
    """
    lengths = [len(curve.points) for curve in curves]
    offsets = np.cumsum([0, *lengths])
    points = np.concatenate([np.zeros((0, 2)), *(curve.points for curve in curves)])
    return Contours(points, offsets, np.ones(len(curves), bool))


def _at_least_one(value: float, argument: str) -> None:
    if not (math.isfinite(value) and value >= 1):
        raise InputError(argument, "a number of at least 1", _check.describe(value))


def _samples(curve: Curve, derivative: Curve) -> FloatArray:
    """Return parameters 0 .. 2 pi spaced evenly along the curve, the last one a period on."""
    coarse = np.linspace(0.0, 2.0 * np.pi, 4097)
    speed = np.hypot(*derivative(coarse).T)
    length = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(coarse))])
    count = max(int(_PER_PIXEL * length[-1]), 64)
    result: FloatArray = np.interp(np.linspace(0.0, length[-1], count + 1), length, coarse)
    return result


def _crossings(t: FloatArray, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the pixels (n, 2) in order without repeats, and the parameters of their crossings.

    A sample on a line of the grid counts as behind it, so that each crossing counts once.
    """
    found, places = [], []
    for axis in (0, 1):
        cell = np.floor(points[:, axis]).astype(np.int64)
        at: IntArray = np.flatnonzero(cell[1:] != cell[:-1])
        line = np.maximum(cell[at], cell[at + 1]).astype(np.float64)
        share = (line - points[at, axis]) / (points[at + 1, axis] - points[at, axis])
        other = points[at, 1 - axis] + share * (points[at + 1, 1 - axis] - points[at, 1 - axis])
        beside = np.floor(other + 0.5)
        pixel = np.stack([line, beside] if axis == 0 else [beside, line], axis=1)
        found.append(pixel)
        places.append(t[at] + share * (t[at + 1] - t[at]))
    pixels, place = np.concatenate(found), np.concatenate(places)
    order = np.argsort(place, kind="stable")
    pixels, place = pixels[order], place[order]
    fresh = (pixels != np.roll(pixels, 1, axis=0)).any(axis=1)
    return pixels[fresh], place[fresh]


def _nearest(
    curve: Curve, derivative: Curve, pixels: FloatArray, crossing: FloatArray
) -> FloatArray:
    """Return the parameters of the nearest points, within a pixel along the curve."""
    step = 1.0 / (_PER_PIXEL * np.hypot(*derivative(crossing).T))
    best, least = crossing, np.full(len(pixels), np.inf)
    for k in range(-_PER_PIXEL, _PER_PIXEL + 1, 2):
        place = crossing + k * step
        far = ((curve(place) - pixels) ** 2).sum(axis=1)
        best, least = np.where(far < least, place, best), np.minimum(far, least)
    for _ in range(_NEWTON):
        slope = derivative(best)
        move = ((pixels - curve(best)) * slope).sum(axis=1) / (slope**2).sum(axis=1)
        best = best + np.clip(move, -step, step)
    return best
