"""Overlays: contours, polygons and ellipses drawn thinly, at sub-pixel positions, on an image."""

from __future__ import annotations

import cv2
import numpy as np

from geoprim_core import _check
from geoprim_core._check import AnyArray, FloatArray
from geoprim_core.applications import ellipse_outlines
from geoprim_core.errors import InputError
from geoprim_core.io.lettering import Legend, Page, draw_caption
from geoprim_core.io.shown import OverlayParams, Shown, to_show
from geoprim_core.tangent import normals
from geoprim_core.types import Contours, Detections, EllipseDetections, Polygons, Tangents

_SHIFT = 4  # OpenCV draws at sixteenths of a pixel
_FAR = 30_000.0  # drawing ends this many pixels outside, where coordinates still fit
_CONTOUR = (255, 160, 60)
_POLYGON = (80, 220, 255)
_NORMAL = (80, 255, 80)
_EDGE = (0.0, 0.0, 0.0)
VGA = 640.0
"""Width of an image whose letters have size 1, in pixels."""


def draw_overlay(
    image: AnyArray,
    contours: Contours | None = None,
    polygons: Polygons | None = None,
    ellipses: EllipseDetections | None = None,
    detections: Detections | EllipseDetections | None = None,
    *,
    params: OverlayParams | None = None,
    labels: bool = True,
    scheme: str = "",
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
        Outlines, coloured by score from violet over orange to yellow, with a black edge. An
        ellipse that is among the detections is drawn once. Where there is no room for a text
        it is shortened to its number or left out, the lower scores first.
    params : OverlayParams, optional
        What is written, and the scale of the colours.
    labels : bool
        False: outlines only, no text and no legend. Without ellipses and detections, which it
        tells of, there is no legend anyway, nor where it would cover more than 6 % of the image;
        `draw_picture` puts it beside the image then.
    scheme : str
        A line of the legend, what found the ellipses; `params.title` takes its place.
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
    >>> overlay[20, 20].tolist(), (overlay[20, 32] > 150).tolist()  # yellow on the outline
    ([0, 0, 0], [False, True, True])
    """
    canvas = displayed(image)
    params = params or OverlayParams()
    page = Page(canvas, params.size or overlay_scale(canvas.shape))
    if contours is not None:
        _draw_contours(canvas, contours)
    if polygons is not None:
        if contours is None:
            raise InputError("contours", "the Contours that the polygons belong to", "None")
        _draw_polygons(page, polygons, contours)
    shown = to_show(ellipses, detections, params)
    outlines = ellipse_outlines(shown.ellipses, 128)
    _draw_outlines(page, outlines, shown, params)
    if caption:
        draw_caption(page, caption)
    if labels and not (ellipses is None and detections is None):
        legend = legend_of(shown, params, scheme)
        if params.legend and legend.fits(page):
            legend.draw_in_corner(page, outlines.reshape(-1, 2))
        _write_texts(page, outlines, shown, params)
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
        Of a normal, in pixels; on an image larger than VGA it grows with the image.

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
    canvas = displayed(image)
    _draw_contours(canvas, contours)
    place = np.arange(len(contours.points)) - np.repeat(
        contours.offsets[:-1], np.diff(contours.offsets)
    )
    chosen = (place % spacing == 0) & ~np.isnan(tangents.angle)
    scale = overlay_scale(canvas.shape)
    ends = contours.points[chosen] + length * scale * normals(tangents.angle[chosen])
    lines = np.stack([_fixed(contours.points[chosen]), _fixed(ends)], axis=1)
    cv2.polylines(canvas, list(lines), False, _NORMAL, round(scale), cv2.LINE_AA, _SHIFT)
    return canvas


def displayed(image: AnyArray) -> AnyArray:
    """Return a copy (H, W, 3) uint8 in BGR order of an image, other depths stretched.

    Examples
    --------
    >>> displayed(np.array([[0.0, 0.5], [1.0, 0.25]]))[:, :, 0].tolist()
    [[0, 127], [255, 63]]
    """
    array = _check.image(image)
    if array.dtype != np.uint8:
        low, high = float(array.min()), float(array.max())
        array = ((array - low) * (255.0 / max(high - low, 1e-12))).astype(np.uint8)
    if array.ndim == 2:
        colour: AnyArray = cv2.cvtColor(np.ascontiguousarray(array), cv2.COLOR_GRAY2BGR)
        return colour
    return np.array(array[:, :, :3], order="C")


def overlay_scale(shape: tuple[int, ...]) -> float:
    """Return how much larger than on a VGA image lines and letters have to be.

    A larger picture is looked at from nearer, hence the root.

    Parameters
    ----------
    shape : (height, width, ...)

    Examples
    --------
    >>> overlay_scale((480, 640)), overlay_scale((1920, 2560))
    (1.0, 2.0)
    """
    return float(max(1.0, np.sqrt(max(shape[:2]) / VGA)))


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


def _draw_polygons(page: Page, polygons: Polygons, contours: Contours) -> None:
    vertices = _fixed(polygons.vertices(contours))
    canvas, thickness = page.canvas, round(page.scale)
    curves = [vertices[a:b] for a, b in zip(polygons.offsets, polygons.offsets[1:], strict=False)]
    for closed in (False, True):
        chosen = [c for c, flag in zip(curves, polygons.closed, strict=True) if flag == closed]
        cv2.polylines(canvas, chosen, closed, _POLYGON, thickness, cv2.LINE_AA, _SHIFT)
    for x, y in vertices.tolist():
        cv2.circle(canvas, (x, y), 24 * thickness, _POLYGON, -1, cv2.LINE_AA, _SHIFT)


def _draw_outlines(page: Page, outlines: FloatArray, shown: Shown, params: OverlayParams) -> None:
    """Draw all edges first, then the colours, the best on top."""
    fixed, colours = list(_fixed(outlines)), _bgr(shown.colours(params))
    pen = max(1, round(page.scale))
    for i in reversed(range(len(shown))):
        for paint, width in ((_EDGE, pen + 1), (colours[i], pen)):
            cv2.polylines(page.canvas, [fixed[i]], True, paint, width, cv2.LINE_AA, _SHIFT)


def _write_texts(page: Page, outlines: FloatArray, shown: Shown, params: OverlayParams) -> None:
    """Write number, class and score, the best first; where there is no room less, or nothing."""
    numbers = [f"#{i}" * params.ids for i in shown.ids]
    colours = _bgr((1.0 + shown.colours(params)) / 2)  # the darkest are read on any ground
    for i, text in enumerate(shown.texts(params)):
        page.write_at(outlines[i], text, numbers[i], colours[i])


def legend_of(shown: Shown, params: OverlayParams, scheme: str = "") -> Legend:
    """Return the legend of what is shown: how many, what found them, and the scale of colours."""
    noun = "ellipse" if len(shown) == 1 else "ellipses"
    title = params.title or scheme
    lines = (f"{len(shown)} {noun}", title) if title else (f"{len(shown)} {noun}",)
    return Legend(lines, params.score_low, params.score_high)


def _bgr(colours: FloatArray) -> list[tuple[float, ...]]:
    return [tuple(row) for row in (255 * colours[:, ::-1]).round().tolist()]
