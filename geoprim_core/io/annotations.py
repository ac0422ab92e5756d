"""Annotations of an image as Foxglove draws them, as plain values.

Our pixel centres are at integers; in Foxglove's pictures the corner of the first pixel is (0, 0),
so that its centre is at (0.5, 0.5). `corner_based` is the one place that knows it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core.applications import ellipse_outlines
from geoprim_core.io.shown import OverlayParams, Shown
from geoprim_core.types import Contours, Polygons

_VERTICES = 64


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """A line on an image: (n, 2) points from the corner of the image, red, green, blue, closed."""

    points: FloatArray
    colour: tuple[float, float, float]
    closed: bool
    thickness: float


@dataclass(frozen=True, slots=True, eq=False)
class Text:
    """A text on an image: where its lower left corner is, from the corner of the image."""

    text: str
    at: tuple[float, float]
    colour: tuple[float, float, float]
    size: float


def corner_based(points: FloatArray) -> FloatArray:
    """Return points measured from the corner of the first pixel instead of from its centre.

    Examples
    --------
    >>> corner_based(np.array([[0.0, 0.0]])).tolist()
    [[0.5, 0.5]]
    """
    shifted: FloatArray = points + 0.5
    return shifted


def ellipse_lines(shown: Shown, params: OverlayParams, scale: float = 1.0) -> list[Line]:
    """Return the outline of every ellipse, coloured by score, in the order of the ellipses."""
    outlines = corner_based(ellipse_outlines(shown.ellipses, _VERTICES))
    colours = shown.colours(params).tolist()
    return [
        Line(o, (c[0], c[1], c[2]), True, 2.0 * scale)
        for o, c in zip(outlines, colours, strict=True)
    ]


def ellipse_texts(shown: Shown, params: OverlayParams, scale: float = 1.0) -> list[Text]:
    """Return number, class and score of every ellipse, above its outline."""
    outlines = corner_based(ellipse_outlines(shown.ellipses, _VERTICES))
    colours, texts = shown.colours(params).tolist(), shown.texts(params)
    return [
        Text(text, (float(o[:, 0].min()), float(o[:, 1].min())), (c[0], c[1], c[2]), 12.0 * scale)
        for text, o, c in zip(texts, outlines, colours, strict=True)
        if text
    ]


def contour_lines(contours: Contours) -> list[Line]:
    """Return every contour as a thin blue line, at its sub-pixel positions."""
    return _lines(corner_based(contours.positions), contours, (0.25, 0.6, 1.0))


def polygon_lines(polygons: Polygons, contours: Contours) -> list[Line]:
    """Return every polygon as a thin green line."""
    return _lines(corner_based(polygons.vertices(contours)), polygons, (0.4, 0.9, 0.5))


def _lines(
    points: FloatArray, curves: Contours | Polygons, colour: tuple[float, float, float]
) -> list[Line]:
    parts = np.split(points, curves.offsets[1:-1])
    return [
        Line(p, colour, bool(closed), 1.0) for p, closed in zip(parts, curves.closed, strict=False)
    ]
