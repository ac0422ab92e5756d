"""The images of the measurement: rendered once, kept in files that the camera maps."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from geoprim_core.io.images import write_image
from geoprim_core.synthetic import sorting_sequence
from geoprim_ros.bench.cases import Pictures

_RAW = "pictures.npy"


def render(pictures: Pictures, folder: Path) -> Path:
    """Render cans on a belt and return the file, or folder, that `load` reads."""
    width, height = pictures.size
    place = folder / f"{width}x{height}_{pictures.transport}"
    if place.exists():
        return place
    place.mkdir()
    images = [
        scene.image
        for scene in sorting_sequence("cans", seed=0, frames=pictures.count, size=pictures.size)
    ]
    if pictures.transport == "raw":
        np.save(place / _RAW, np.stack(images))
    else:
        for number, image in enumerate(images):
            write_image(place / f"{number:03d}.jpg", image)
    return place


def load(place: Path) -> list[bytes] | list[np.ndarray[tuple[int, ...], np.dtype[np.uint8]]]:
    """Return the images of a place: arrays (H, W, 3), or JPEG files."""
    if (place / _RAW).is_file():
        return list(np.load(place / _RAW))
    return [path.read_bytes() for path in sorted(place.glob("*.jpg"))]
