"""The real photographs that an installed scikit-image ships, read as files."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from geoprim_core._check import AnyArray
from geoprim_core.errors import FileError
from geoprim_core.io.images import read_image


class Photograph(NamedTuple):
    """A photograph: file below scikit-image's data folder, what is on it, where it is from."""

    file: str
    content: str
    source: str


PHOTOGRAPHS = {
    "coins": Photograph(
        "coins.png", "Greek coins from Pompeii", "Brooklyn Museum, no known copyright restrictions"
    ),
    "coffee": Photograph("coffee.png", "cup and saucer", "Rachel Michetti, CC0"),
    "clock": Photograph(
        "clock_motion.png", "wall clock, blurred by motion", "Stefan van der Walt, public domain"
    ),
    "motorcycle": Photograph(
        "motorcycle_left.png", "motorcycle in a garage", "Middlebury stereo benchmark 2014"
    ),
    "moon": Photograph("moon.png", "craters of the moon", "as shipped with scikit-image"),
    "retina": Photograph("retina.jpg", "human retina", "Mikael Haggstrom, CC0"),
    "astronaut": Photograph(
        "astronaut.png", "Eileen Collins with her helmet", "NASA, public domain"
    ),
    "chelsea": Photograph("chelsea.png", "eyes of a cat", "Stefan van der Walt, CC0"),
    "camera": Photograph("camera.png", "man with a camera", "Lav Varshney, CC0"),
    "rocket": Photograph("rocket.jpg", "rocket with lights at dusk", "SpaceX, public domain"),
}
"""Name -> photograph."""


BACKGROUNDS = ("gravel.png", "camera.png", "rocket.jpg", "brick.png", "grass.png", "text.png")
"""Further files of that folder, and some of the same, that show nothing round."""


def packaged_photographs() -> dict[str, AnyArray]:
    """Return name -> image of `PHOTOGRAPHS`, gray or BGR, as the files have them.

    Raises
    ------
    FileError
        scikit-image is not installed or lacks a file.

    Examples
    --------
    >>> packaged_photographs()["coins"].shape
    (303, 384)
    """
    folder = _folder()
    return {name: read_image(folder / photograph.file) for name, photograph in PHOTOGRAPHS.items()}


def packaged_backgrounds() -> dict[str, AnyArray]:
    """Return name -> image of `BACKGROUNDS`: ground to put targets of known place on.

    Raises
    ------
    FileError
        scikit-image is not installed or lacks a file.

    Examples
    --------
    >>> packaged_backgrounds()["gravel"].shape
    (512, 512)
    """
    folder = _folder()
    return {Path(file).stem: read_image(folder / file) for file in BACKGROUNDS}


def _folder() -> Path:
    found = find_spec("skimage")
    if found is None or found.origin is None:
        raise FileError("the photographs are missing: scikit-image is not installed")
    return Path(found.origin).parent / "data"
