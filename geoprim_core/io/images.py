"""Image files in and out."""

from __future__ import annotations

import os
from pathlib import Path
from typing import cast

import cv2
import numpy as np

from geoprim_core import _check
from geoprim_core._check import AnyArray
from geoprim_core.errors import FileError, InputError
from geoprim_core.io.files import make_folder

SUFFIXES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".pgm", ".ppm", ".webp")
"""The names, in small letters, by which `list_images` tells images from other files."""


def read_image(path: str | os.PathLike[str]) -> AnyArray:
    """Return the image of a file as its pixels stand there; an EXIF turn is not carried out.

    Parameters
    ----------
    path : path of a PNG, JPEG, TIFF, BMP, PGM, ... file

    Returns
    -------
    (H, W), (H, W, 3) or (H, W, 4) array
        Gray, BGR or BGRA; of the depth that the file has.

    Raises
    ------
    FileError
        The file is missing, cannot be read or is not an image.
    """
    try:
        data = np.frombuffer(Path(path).read_bytes(), np.uint8)
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}") from None
    if not len(data):
        raise FileError(f"{path} is empty: 0 bytes")
    try:
        # Decoding bytes works with any name; OpenCV's own reading does not everywhere.
        image = cv2.imdecode(data, cv2.IMREAD_UNCHANGED)
    except cv2.error as error:
        raise FileError(f"{path} cannot be decoded: {error.err}") from None
    if image is None:
        raise FileError(f"{path} is not an image that can be decoded")
    try:
        return _check.image(image)
    except InputError as error:
        raise FileError(f"{path} holds no image that can be used: {error}") from None


def list_images(path: str | os.PathLike[str]) -> list[Path]:
    """Return the image files of a folder, by name, or the one file that the path names.

    Raises
    ------
    FileError
        There is no such file or folder.
    """
    place = Path(path)
    if not place.exists():
        raise FileError(f"cannot read {place}: no such file or folder")
    if not place.is_dir():
        return [place]
    return sorted(p for p in place.iterdir() if p.suffix.lower() in SUFFIXES)


def resize_image(image: AnyArray, size: tuple[int, int]) -> AnyArray:
    """Return an image brought to a (width, height); one higher than wide to it on its side.

    Raises
    ------
    InputError
        A size below one pixel.

    Examples
    --------
    >>> resize_image(np.zeros((300, 200), np.uint8), (64, 48)).shape
    (64, 48)
    """
    if min(size) < 1:
        raise InputError("size", "a width and a height of at least 1", f"{tuple(size)}")
    width, height = max(size), min(size)
    if image.shape[0] > image.shape[1]:
        width, height = height, width
    return cast(AnyArray, cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA))


def write_image(path: str | os.PathLike[str], image: AnyArray) -> None:
    """Write an image file in the format that its suffix names, with the folders above it.

    Parameters
    ----------
    path : path of the file
    image : (H, W), (H, W, 3) or (H, W, 4) array
        Gray, BGR or BGRA.

    Raises
    ------
    FileError
        The format is not known or cannot hold the image, or the file cannot be written.
    """
    target = Path(path)
    array = _check.image(image)
    try:
        done, data = cv2.imencode(target.suffix or "none", array)
    except cv2.error:
        done = False
    if not done and target.suffix.lower() not in SUFFIXES:
        raise FileError(
            f"cannot write {target}: expected a name that ends in {', '.join(SUFFIXES)}"
        )
    if not done:
        raise FileError(f"cannot write {target}: the format holds no {_check.describe(array)}")
    make_folder(target.parent)
    try:
        target.write_bytes(data.tobytes())
    except OSError as error:
        raise FileError(f"cannot write {target}: {error.strerror or error}") from None
