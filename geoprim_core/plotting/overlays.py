"""Contours and ellipses drawn over their image."""

from __future__ import annotations

from typing import Any

import numpy as np

from geoprim_core._check import AnyArray, FloatArray, describe
from geoprim_core.errors import InputError
from geoprim_core.plotting._axes import image_axes
from geoprim_core.types import Contours, Detections, EllipseDetections, Ellipses

_OUTLINE_POINTS = 181


def plot_detections(
    image: AnyArray,
    detections: EllipseDetections | Detections | Ellipses,
    ax: Any | None = None,
    *,
    color: str | None = None,
) -> Any:
    """Draw ellipses over an image.

    Parameters
    ----------
    image : (H, W) or (H, W, 3)
        Grey, or colour in the order blue, green, red.
    detections : EllipseDetections, Detections or Ellipses
        Labelled objects get one colour a label and their label; ellipses with a score run from
        dark (0) to bright (1).
    ax : matplotlib Axes or None
        None: a new figure without a window.
    color : matplotlib colour or None
        One colour for all.

    Returns
    -------
    matplotlib Axes

    Raises
    ------
    InputError
        The detections are of another type.

    Examples
    --------
    >>> from geoprim_core.synthetic import thesis_image
    >>> scene = thesis_image(4, seed=1)
    >>> axes = plot_detections(scene.image, scene.ellipses)
    >>> len(axes.lines) == len(scene.ellipses)
    True
    """
    ellipses = detections if isinstance(detections, Ellipses) else None
    if isinstance(detections, EllipseDetections | Detections):
        ellipses = detections.ellipses
    if ellipses is None:
        expected = "EllipseDetections, Detections or Ellipses"
        raise InputError("detections", expected, describe(detections))
    axes = image_axes(image, None, ax)
    colors = [color] * len(ellipses) if color else _colors(detections)
    for row, tone in zip(ellipses.array(), colors, strict=True):
        x, y = _outline(row)
        axes.plot(x, y, color=tone, linewidth=1.5)
    if isinstance(detections, Detections):
        for label, row, tone in zip(detections.labels, ellipses.array(), colors, strict=True):
            axes.text(row[0], row[1], label, color=tone, ha="center", va="center", fontsize=7)
    return axes


def plot_contours(contours: Contours, image: AnyArray | None = None, ax: Any | None = None) -> Any:
    """Draw edge contours, each in its own colour, over an image or on an empty frame.

    Parameters
    ----------
    contours : Contours
    image : (H, W), (H, W, 3) or None
    ax : matplotlib Axes or None
        None: a new figure without a window.

    Returns
    -------
    matplotlib Axes

    Raises
    ------
    InputError
        The contours are of another type.

    Examples
    --------
    >>> square = Contours([[5, 5], [6, 5], [6, 6], [5, 6]], [0, 4], [True], image_size=(12, 12))
    >>> axes = plot_contours(square)
    >>> axes.lines[0].get_xydata()[-1].tolist()  # a closed contour returns to its start
    [5.0, 5.0]
    """
    if not isinstance(contours, Contours):
        raise InputError("contours", "Contours", describe(contours))
    axes = image_axes(image, contours.image_size, ax)
    positions = contours.positions
    for k in range(len(contours)):
        line = positions[contours.offsets[k] : contours.offsets[k + 1]]
        if contours.closed[k]:
            line = np.vstack([line, line[:1]])
        axes.plot(line[:, 0], line[:, 1], color=f"C{k % 10}", linewidth=1.0)
    return axes


def _colors(detections: EllipseDetections | Detections | Ellipses) -> list[Any]:
    if isinstance(detections, Detections):
        known = sorted(set(detections.labels))
        return [f"C{known.index(label) % 10}" for label in detections.labels]
    if isinstance(detections, EllipseDetections):
        from matplotlib import colormaps

        return [colormaps["plasma"](0.25 + 0.7 * score) for score in detections.score]
    return ["tab:red"] * len(detections)


def _outline(row: FloatArray) -> tuple[FloatArray, FloatArray]:
    x, y, a, b, angle = row
    t = np.linspace(0, 2 * np.pi, _OUTLINE_POINTS)
    u, v = a * np.cos(t), b * np.sin(t)
    return x + u * np.cos(angle) - v * np.sin(angle), y + u * np.sin(angle) + v * np.cos(angle)
