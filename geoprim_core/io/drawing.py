"""Overlays: contours, polygons and ellipses drawn thinly, at sub-pixel positions, on an image."""

from __future__ import annotations

import cv2
import numpy as np

from geoprim_core import _check
from geoprim_core._check import AnyArray, BoolArray, FloatArray
from geoprim_core.applications import ellipse_outlines
from geoprim_core.errors import InputError
from geoprim_core.tangent import normals
from geoprim_core.types import Contours, Detections, EllipseDetections, Polygons, Tangents

_SHIFT = 4  # OpenCV draws at sixteenths of a pixel
_FAR = 30_000.0  # drawing ends this many pixels outside, where coordinates still fit
_FONT = cv2.FONT_HERSHEY_SIMPLEX
_CONTOUR = (255, 160, 60)
_POLYGON = (80, 220, 255)
_NORMAL = (80, 255, 80)
# Colours of the scores 0, 1/2 and 1: blue, green and red channels.
_RAMP = ((255.0, 0.0, 60.0), (40.0, 220.0, 255.0), (255.0, 255.0, 40.0))


def draw_overlay(
    image: AnyArray,
    contours: Contours | None = None,
    polygons: Polygons | None = None,
    ellipses: EllipseDetections | None = None,
    detections: Detections | EllipseDetections | None = None,
    *,
    labels: bool = True,
    caption: str = "",
) -> AnyArray:
    """Return a copy of an image with results drawn on it.

    Parameters
    ----------
    image : (H, W), (H, W, 3) or (H, W, 4) array, gray, BGR or BGRA
        Other depths than uint8 are stretched to the full range.
    contours : Contours, optional
        Their pixels are coloured.
    polygons : Polygons, optional
        Drawn with their vertices; needs the contours they belong to.
    ellipses, detections : EllipseDetections or Detections, optional
        Outlines, coloured from magenta (score 0) over yellow to green (score 1). An ellipse
        that is among the detections is drawn once.
    labels : bool
        Write the labels and scores of the detections, or the scores of the ellipses where there
        are no detections.
    caption : str
        A line of text for the top left corner.

    Returns
    -------
    (H, W, 3) uint8 array in BGR order

    Raises
    ------
    InputError
        Polygons come without their contours, or the image cannot be used.

    Examples
    --------
    >>> scene = np.zeros((40, 40), np.uint8)
    >>> from geoprim_core.types import Ellipses
    >>> disc = Ellipses.from_array([[20, 20, 12, 12, 0]])
    >>> found = Detections(("coin",), score=[1.0], boxes=[[8, 8, 32, 32]], ellipses=disc)
    >>> overlay = draw_overlay(scene, detections=found, labels=False)
    >>> overlay[20, 20].tolist(), overlay[20, 32].argmax().tolist()  # green on the outline
    ([0, 0, 0], 1)
    """
    canvas = _canvas(image)
    if contours is not None:
        _draw_contours(canvas, contours)
    if polygons is not None:
        if contours is None:
            raise InputError("contours", "the Contours that the polygons belong to", "None")
        _draw_polygons(canvas, polygons, contours)
    objects = detections is not None and len(detections) > 0
    if ellipses is not None:
        others = ellipses.select(_not_among(ellipses, detections))
        _draw_found(canvas, others, labels and not objects)
    if detections is not None:
        _draw_found(canvas, detections, labels)
    if caption:
        _write(canvas, caption, (4.0, 4.0 + 14.0 * _scale(canvas)), (255, 255, 255))
    return canvas


def draw_normals(
    image: AnyArray,
    contours: Contours,
    tangents: Tangents,
    *,
    spacing: int = 5,
    length: float = 8.0,
) -> AnyArray:
    """Return a copy of an image with contours and normals to the right of their way of travel.

    Parameters
    ----------
    image : (H, W), (H, W, 3) or (H, W, 4) array, gray, BGR or BGRA
    contours : Contours
    tangents : Tangents
        Of these contours.
    spacing : int
        Every so many pixels of a contour one normal is drawn, where it is defined.
    length : float
        Of a normal, in pixels; on an image wider than 1600 it grows with the image.

    Returns
    -------
    (H, W, 3) uint8 array in BGR order

    Raises
    ------
    InputError
        The tangents belong to other contours, or the image cannot be used.

    Examples
    --------
    >>> line = Contours([(x, 10) for x in range(20)], [0, 20], [False])
    >>> picture = draw_normals(np.zeros((30, 20)), line, Tangents(np.zeros(20), [0, 20]))
    >>> picture[14, 10].argmax().tolist(), picture[6, 10].any().tolist()  # right of +x is down
    (1, False)
    """
    if not np.array_equal(tangents.offsets, contours.offsets):
        raise InputError("tangents", "the Tangents of these contours", "others")
    canvas = _canvas(image)
    _draw_contours(canvas, contours)
    place = np.arange(len(contours.points)) - np.repeat(
        contours.offsets[:-1], np.diff(contours.offsets)
    )
    chosen = (place % spacing == 0) & ~np.isnan(tangents.angle)
    ends = contours.points[chosen] + length * _scale(canvas) * normals(tangents.angle[chosen])
    lines = np.stack([_fixed(contours.points[chosen]), _fixed(ends)], axis=1)
    thickness = round(_scale(canvas))
    cv2.polylines(canvas, list(lines), False, _NORMAL, thickness, cv2.LINE_AA, _SHIFT)
    return canvas


def _canvas(image: AnyArray) -> AnyArray:
    array = _check.image(image)
    if array.dtype != np.uint8:
        low, high = float(array.min()), float(array.max())
        array = ((array - low) * (255.0 / max(high - low, 1e-12))).astype(np.uint8)
    if array.ndim == 2:
        colour: AnyArray = cv2.cvtColor(np.ascontiguousarray(array), cv2.COLOR_GRAY2BGR)
        return colour
    return np.array(array[:, :, :3], order="C")


def _scale(canvas: AnyArray) -> float:
    """Return how much larger than on a VGA image lines and letters have to be."""
    return float(max(1.0, max(canvas.shape[:2]) / 1600))


def _fixed(points: FloatArray) -> AnyArray:
    """Return points in OpenCV's fixed-point form."""
    bounded = np.clip(points, -_FAR, _FAR)
    fixed: AnyArray = np.rint(bounded * (1 << _SHIFT)).astype(np.int32)
    return fixed


def _draw_contours(canvas: AnyArray, contours: Contours) -> None:
    pixels = np.rint(contours.points).astype(np.int64)
    height, width = canvas.shape[:2]
    inside = (pixels >= 0).all(axis=1) & (pixels < (width, height)).all(axis=1)
    x, y = pixels[inside].T
    canvas[y, x] = _CONTOUR


def _draw_polygons(canvas: AnyArray, polygons: Polygons, contours: Contours) -> None:
    vertices = _fixed(polygons.vertices(contours))
    thickness = round(_scale(canvas))
    curves = [vertices[a:b] for a, b in zip(polygons.offsets, polygons.offsets[1:], strict=False)]
    for closed in (False, True):
        chosen = [c for c, flag in zip(curves, polygons.closed, strict=True) if flag == closed]
        cv2.polylines(canvas, chosen, closed, _POLYGON, thickness, cv2.LINE_AA, _SHIFT)
    for x, y in vertices.tolist():
        cv2.circle(canvas, (x, y), 24 * thickness, _POLYGON, -1, cv2.LINE_AA, _SHIFT)


def _draw_found(canvas: AnyArray, found: Detections | EllipseDetections, labels: bool) -> None:
    outlines = _fixed(ellipse_outlines(found.ellipses, 128))
    centres, minor = found.ellipses.array()[:, :2].tolist(), found.ellipses.semi_minor.tolist()
    scale = _scale(canvas)
    names = found.labels if isinstance(found, Detections) else ("",) * len(found)
    for i in reversed(range(len(found))):  # the best on top
        colour = _colour(float(found.score[i]))
        cv2.polylines(canvas, [outlines[i]], True, colour, round(scale), cv2.LINE_AA, _SHIFT)
        if labels:
            text = f"{names[i]} {found.score[i]:.2f}".strip()
            width = 6.0 * scale * len(text)
            roomy = minor[i] > 0.6 * width
            above = outlines[i, :, 1].min() / (1 << _SHIFT) - 3 * scale
            y = centres[i][1] + 4 * scale if roomy else above
            _write(canvas, text, (centres[i][0] - width / 2, y), colour)


def _not_among(
    ellipses: EllipseDetections, detections: Detections | EllipseDetections | None
) -> BoolArray:
    """Return which ellipses are not those of a detection."""
    drawn = set() if detections is None else set(map(tuple, detections.ellipses.array().tolist()))
    return np.array([tuple(row) not in drawn for row in ellipses.ellipses.array().tolist()], bool)


def _colour(score: float) -> tuple[float, ...]:
    return tuple(float(np.interp(score, (0.0, 0.5, 1.0), channel)) for channel in _RAMP)


def _write(canvas: AnyArray, text: str, at: tuple[float, float], colour: tuple[float, ...]) -> None:
    """Write text with a shadow; its base line starts at a point, moved where it would not fit."""
    scale = _scale(canvas)
    height, width = canvas.shape[:2]
    x = min(max(at[0], 1.0), max(1.0, width - 6.0 * scale * len(text)))
    y = min(max(at[1], 10.0 * scale), height - 3.0)
    size, step = 0.36 * scale, round(scale)
    for shift, paint in ((step, (0.0, 0.0, 0.0)), (0, colour)):
        place = (round(x) + shift, round(y) + shift)
        cv2.putText(canvas, text, place, _FONT, size, paint, step, cv2.LINE_AA)
