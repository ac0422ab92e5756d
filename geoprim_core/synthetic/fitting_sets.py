"""Point sets for ellipse fits: the settings of thesis 4.5.1, 4.5.2, 4.5.4 and 4.5.5."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core.errors import InputError
from geoprim_core.fitting import point_at
from geoprim_core.types import Ellipse

CONIC_KINDS = ("analytic", "digital", "noisy")
"""How the points of a conic are made: exact, rounded to pixels, or scattered."""

_CENTRE = 150.0
_SEMI_AXES = (20.0, 150.0)
_LATUS = (20.0, 150.0)
_ECCENTRICITY = (1.0, 2.0)
_SIDE = 300
_STEP = math.radians(10.0)
_ANALYTIC_STEP = math.radians(1.0)
_DENSE = 0.2  # pixels between samples before they are rounded


def random_ellipse(random: np.random.Generator) -> Ellipse:
    """Draw an ellipse of thesis 4.5.1: b in [20, 150], a in [b, 150], any angle, centre (150, 150).

    Examples
    --------
    >>> drawn = random_ellipse(np.random.default_rng(0))
    >>> drawn.x, 20 <= drawn.semi_minor <= drawn.semi_major <= 150
    (150.0, True)
    """
    semi_minor = random.uniform(*_SEMI_AXES)
    semi_major = random.uniform(semi_minor, _SEMI_AXES[1])
    return Ellipse(_CENTRE, _CENTRE, semi_major, semi_minor, random.uniform(0, np.pi))


def elliptic_arc(random: np.random.Generator, span: float) -> tuple[Ellipse, FloatArray]:
    """Draw a digital elliptic arc of thesis 4.5.1: the pixels along [start, start + span].

    The angle is the eccentric one, as in `point_at`; its start is drawn at random.

    Parameters
    ----------
    random : numpy Generator
    span : float
        In radians, in (0, 2 pi].

    Returns
    -------
    (Ellipse, (n, 2) float64)
        The ellipse and the pixels in order, none twice in a row.

    Raises
    ------
    InputError
        The span is outside its range.

    Examples
    --------
    >>> ellipse, pixels = elliptic_arc(np.random.default_rng(0), np.pi)
    >>> bool((pixels == pixels.round()).all())
    True
    """
    _check_span(span)
    ellipse = random_ellipse(random)
    start = random.uniform(0, 2 * np.pi)
    count = int(span * ellipse.semi_major / _DENSE) + 2
    return ellipse, _rounded(point_at(ellipse, start + np.linspace(0, span, count)))


def noisy_ellipse(
    random: np.random.Generator, percent: float, span: float = 2 * np.pi
) -> tuple[Ellipse, FloatArray]:
    """Draw a noisy cluster around an ellipse, thesis 4.5.2: a point every ten degrees.

    The noise is Gaussian; its standard deviations in x and y are `percent` hundredths of the
    largest distances of the points from the centre in x and y. A sector of less than the whole
    starts at a random angle, and both its ends have a point.

    Raises
    ------
    InputError
        The span is outside (0, 2 pi], or the noise is negative.

    Examples
    --------
    >>> ellipse, points = noisy_ellipse(np.random.default_rng(0), 20)
    >>> points.shape
    (36, 2)
    """
    _check_span(span)
    _check_percent(percent)
    ellipse = random_ellipse(random)
    whole = span > 2 * np.pi - 1e-9
    angles = np.arange(36 if whole else round(span / _STEP) + 1) * _STEP
    start = 0.0 if whole else random.uniform(0, 2 * np.pi)
    return ellipse, _scattered(random, point_at(ellipse, start + angles), percent)


def open_conic(
    random: np.random.Generator, half_span: float, kind: str = "analytic", percent: float = 0.0
) -> FloatArray:
    """Draw points of a parabola or hyperbola in an image of 300 x 300, thesis 4.5.4 and 4.5.5.

    Semi-latus rectum in [20, 150], eccentricity in [1, 2], focus (150, 150), angles within
    `half_span` of 180 degrees. Of a hyperbola only the branch about 180 degrees counts: where
    1 - e cos(theta) <= 0 the formula gives the other one (errata E8). The thesis does not tell
    the sampling: exact points lie one degree apart, digital ones are the pixels of a dense
    sampling in order, scattered ones start ten degrees apart as those around ellipses.

    Parameters
    ----------
    random : numpy Generator
    half_span : float
        In radians, in (0, pi].
    kind : "analytic", "digital" or "noisy"
    percent : float
        Standard deviation of the noise in x and y, in hundredths of the largest distance of the
        points from the focus in x and y; for the kind "noisy".

    Returns
    -------
    (n, 2) float64

    Raises
    ------
    InputError
        An argument is outside its range.

    References
    ----------
    Thesis (4-61); errata E8.

    Examples
    --------
    >>> points = open_conic(np.random.default_rng(0), np.pi / 2)
    >>> bool((points >= 0).all() and (points <= 299).all())
    True
    """
    _check_span(half_span, "half_span", np.pi)
    _check_percent(percent)
    if kind not in CONIC_KINDS:
        raise InputError("kind", "one of " + ", ".join(CONIC_KINDS), repr(kind))
    latus, eccentricity = random.uniform(*_LATUS), random.uniform(*_ECCENTRICITY)
    if kind == "digital":
        return _rounded(_dense_conic(latus, eccentricity, half_span))
    step = _STEP if kind == "noisy" else _ANALYTIC_STEP
    count = int(half_span / step + 1e-9)
    angles: FloatArray = np.pi + step * np.arange(-count, count + 1, dtype=np.float64)
    points = _conic_points(latus, eccentricity, angles)
    return _scattered(random, points, percent) if kind == "noisy" else points


def _conic_points(latus: float, eccentricity: float, angles: FloatArray) -> FloatArray:
    """Return the points of (4-61) at angles, those on the branch and in the image."""
    below = 1.0 - eccentricity * np.cos(angles)
    on_branch = below > 1e-9
    radius = latus / below[on_branch]
    x = radius * np.cos(angles[on_branch]) + _CENTRE
    y = radius * np.sin(angles[on_branch]) + _CENTRE
    inside = (np.minimum(x, y) >= 0) & (np.maximum(x, y) <= _SIDE - 1)
    return np.stack([x[inside], y[inside]], axis=1)


def _dense_conic(latus: float, eccentricity: float, half_span: float) -> FloatArray:
    """Return points of the conic, at most about a fifth of a pixel apart."""
    reach = math.sqrt(2.0) * _SIDE  # the curve leaves the image before its radius is as large
    cosine = (1.0 - latus / reach) / eccentricity
    half = min(half_span, np.pi - math.acos(max(-1.0, min(1.0, cosine))))
    coarse = np.pi + np.linspace(-half, half, 4000)
    below = 1.0 - eccentricity * np.cos(coarse)
    curve = (latus / below)[:, None] * np.stack([np.cos(coarse), np.sin(coarse)], axis=1)
    length = np.append(0.0, np.hypot(*np.diff(curve, axis=0).T).cumsum())
    even = np.linspace(0.0, length[-1], int(length[-1] / _DENSE) + 2)
    angles: FloatArray = np.interp(even, length, coarse).astype(np.float64)
    return _conic_points(latus, eccentricity, angles)


def _rounded(points: FloatArray) -> FloatArray:
    """Return the pixels of a dense sampling in order, none twice in a row."""
    pixels = np.floor(points + 0.5)
    changed = (np.diff(pixels, axis=0) != 0).any(axis=1)
    chosen: FloatArray = pixels[np.append(True, changed)]
    return chosen


def _scattered(random: np.random.Generator, points: FloatArray, percent: float) -> FloatArray:
    deviation = percent / 100 * np.abs(points - _CENTRE).max(axis=0)
    scattered: FloatArray = points + random.normal(size=points.shape) * deviation
    return scattered


def _check_span(span: float, name: str = "span", most: float = 2 * np.pi) -> None:
    if not 0 < span <= most + 1e-9:
        raise InputError(name, f"an angle in (0, {most:.4f}] radians", f"{span}")


def _check_percent(percent: float) -> None:
    if not 0 <= percent < np.inf:
        raise InputError("percent", "a number of at least 0", f"{percent}")
