"""A rendered picture together with the truth about it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geoprim_core import _check
from geoprim_core._check import AnyArray, BoolArray, FloatArray
from geoprim_core.errors import InputError
from geoprim_core.types import Camera, Ellipses


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """A rendered image and its true ellipses.

    Attributes
    ----------
    image : (H, W) uint8 grey levels or (H, W, 3) uint8 colours in the order blue, green, red
    ellipses : Ellipses, n of them
    visible : (n,) float64
        Share of each outline, by length, that lies in the frame and is not hidden.
    labels : n texts
    required : (n,) bool
        True where a detector is expected to find the ellipse; the others count neither as hit
        nor as miss.
    camera : Camera or None

    Raises
    ------
    InputError
        The columns do not have one entry an ellipse.

    Examples
    --------
    >>> from geoprim_core.synthetic import thesis_image
    >>> scene = thesis_image(4, seed=1)
    >>> scene.image.shape, len(scene.ellipses) == len(scene.visible)
    ((300, 300), True)
    """

    image: AnyArray
    ellipses: Ellipses
    visible: FloatArray
    labels: tuple[str, ...]
    required: BoolArray
    camera: Camera | None = None

    def __post_init__(self) -> None:
        count = len(self.ellipses)
        object.__setattr__(self, "image", _check.image(self.image))
        object.__setattr__(self, "visible", _check.finite(self.visible, "visible", (count,)))
        object.__setattr__(self, "labels", tuple(self.labels))
        required = np.asarray(self.required)
        if len(self.labels) != count or required.shape != (count,) or required.dtype != np.bool_:
            raise InputError("labels, required", f"{count} texts and flags", "others")
        object.__setattr__(self, "required", required)

    @property
    def image_size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.image.shape[1], self.image.shape[0]
