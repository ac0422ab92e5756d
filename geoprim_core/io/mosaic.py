"""Many pictures on one sheet."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from geoprim_core._check import AnyArray
from geoprim_core.errors import InputError


def mosaic(
    images: Sequence[AnyArray], *, columns: int = 4, cell: tuple[int, int] = (480, 360)
) -> AnyArray:
    """Return images side by side in rows, each shrunk into a cell of one size.

    Parameters
    ----------
    images : (H, W, 3) uint8 arrays
    columns : int
        Images a row.
    cell : (width, height) in pixels

    Returns
    -------
    (rows * height, columns * width, 3) uint8 array

    Raises
    ------
    InputError
        There is no image.

    Examples
    --------
    >>> mosaic([np.zeros((10, 20, 3), np.uint8)] * 5, columns=2, cell=(40, 30)).shape
    (90, 80, 3)
    """
    if not images:
        raise InputError("images", "at least one image", "none")
    width, height = cell
    columns = min(columns, len(images))
    rows = -(-len(images) // columns)
    sheet = np.full((rows * height, columns * width, 3), 30, np.uint8)
    for i, image in enumerate(images):
        scale = min(width / image.shape[1], height / image.shape[0])
        size = (max(1, int(image.shape[1] * scale)), max(1, int(image.shape[0] * scale)))
        small = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
        top, left = (i // columns) * height, (i % columns) * width
        sheet[top : top + size[1], left : left + size[0]] = small
    return sheet
