"""Pictures of results for the eye: a small image enlarged, the legend where it hides nothing."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

import numpy as np

from geoprim_core._check import AnyArray
from geoprim_core.io.drawing import VGA, displayed, draw_overlay, legend_of, overlay_scale
from geoprim_core.io.lettering import Box, Legend, Page
from geoprim_core.io.shown import OverlayParams, to_show
from geoprim_core.types import Detections, EllipseDetections, Ellipses

_MOST_TIMES = 8

D = TypeVar("D", bound=EllipseDetections | Detections)


def draw_picture(
    image: AnyArray,
    ellipses: EllipseDetections | None = None,
    detections: Detections | EllipseDetections | None = None,
    *,
    params: OverlayParams | None = None,
    scheme: str = "",
) -> AnyArray:
    """Return a picture of an image with results drawn on it, for a file that is looked at.

    As `draw_overlay`, which keeps the size of the image; here letters always have room. An image
    smaller than VGA is enlarged a whole number of times, up to eight, as its letters cannot be
    smaller. A legend that would cover more than 6 % of the picture stands below it, or to the
    right of one that is narrower than the legend.

    Parameters
    ----------
    image, ellipses, detections, params, scheme : see `draw_overlay`

    Returns
    -------
    (H', W', 3) uint8 array in BGR order
        The upper left part shows the image, each pixel as a square.

    Raises
    ------
    InputError
        The image cannot be used.

    Examples
    --------
    >>> none = EllipseDetections.empty()
    >>> draw_picture(np.zeros((480, 640)), none).shape, draw_picture(np.zeros((60, 80)), none).shape
    ((480, 640, 3), (480, 640, 3))
    """
    params = params or OverlayParams()
    shown = displayed(image)
    times = enlargement(shown.shape)
    found, objects = _enlarged(ellipses, times), _enlarged(detections, times)
    if times > 1:
        shown = shown.repeat(times, axis=0).repeat(times, axis=1)
    picture = draw_overlay(shown, ellipses=found, detections=objects, params=params, scheme=scheme)
    legend = legend_of(to_show(found, objects, params), params, scheme)
    return _with_legend(picture, legend, params) if params.legend else picture


def enlargement(shape: tuple[int, ...]) -> int:
    """Return how many times larger an image (height, width, ...) is shown.

    Examples
    --------
    >>> enlargement((480, 640)), enlargement((240, 320)), enlargement((8, 8))
    (1, 2, 8)
    """
    return min(max(round(VGA / max(shape[:2])), 1), _MOST_TIMES)


def _enlarged(found: D | None, times: int) -> D | None:
    """Return results in the enlarged picture, whose pixel centres are at integers again."""
    if found is None or times == 1:
        return found
    rows = found.ellipses.array() * [times, times, times, times, 1]
    rows[:, :2] += (times - 1) / 2
    return replace(found, ellipses=Ellipses.from_array(rows))


def _with_legend(picture: AnyArray, legend: Legend, params: OverlayParams) -> AnyArray:
    """Return a picture, larger where its legend would have covered too much of it."""
    page = Page(picture, params.size or overlay_scale(picture.shape))
    if legend.fits(page):
        return picture  # that has it
    height, width = picture.shape[:2]
    wide, high = map(int, np.ceil(legend.size(page)))
    below = wide <= width
    size = (height + high, width) if below else (max(height, high), width + wide)
    sheet = np.zeros((*size, 3), np.uint8)
    sheet[:height, :width] = picture
    left, top = (0, height) if below else (width, 0)
    legend.draw(Page(sheet, page.scale), Box(left, top, left + wide, top + high))
    return sheet
