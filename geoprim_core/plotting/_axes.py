"""Axes to draw on, made without a display where none are given."""

from __future__ import annotations

from typing import Any

import numpy as np

from geoprim_core import _check
from geoprim_core._check import AnyArray


def axes_or_new(ax: Any | None, width: float, height: float) -> Any:
    """Return the given axes, or those of a new figure of width by height inches.

    A new figure belongs to no window and no global state; it is freed with its last reference.
    """
    if ax is not None:
        return ax
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure.add_subplot()


def image_axes(image: AnyArray | None, size: tuple[int, int] | None, ax: Any | None) -> Any:
    """Return axes that show an image (or an empty frame of a size), y pointing down."""
    if image is not None:
        size = (image.shape[1], image.shape[0])
    width, height = size or (640, 480)
    axes = axes_or_new(ax, 8.0, max(8.0 * height / width, 1.0))
    if image is not None:
        axes.imshow(_displayed(image), cmap="gray", interpolation="nearest")
    axes.set(xlim=(-0.5, width - 0.5), ylim=(height - 0.5, -0.5), aspect="equal")
    axes.set_axis_off()
    return axes


def _displayed(image: AnyArray) -> AnyArray:
    """Return an image as matplotlib takes it: red first, numbers in its range."""
    checked = _check.image(image)
    if checked.ndim == 3:
        checked = checked[:, :, 2::-1]
    if checked.dtype == np.uint8:
        return checked
    low, high = float(checked.min()), float(checked.max())
    scaled: AnyArray = (checked.astype(np.float64) - low) / max(high - low, 1e-300)
    return scaled
