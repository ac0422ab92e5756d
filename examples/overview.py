"""Draws docs/overview.png: the README's picture, one overlay of each kind of scene."""

from __future__ import annotations

from pathlib import Path

from geoprim_core import detect_ellipses
from geoprim_core.io.drawing import draw_overlay
from geoprim_core.io.images import write_image
from geoprim_core.io.mosaic import mosaic
from geoprim_core.io.photographs import packaged_photographs
from geoprim_core.io.shown import OverlayParams
from geoprim_core.synthetic import SORTING_LINES, sorting_sequence

ROOT = Path(__file__).resolve().parents[1]
FRAME = 20


def main() -> None:
    """Detect and draw with the default parameters; nothing is picked by hand."""
    photographs = packaged_photographs()
    images = [photographs["coins"], photographs["coffee"]]
    for line in SORTING_LINES:
        images.append(list(sorting_sequence(line, seed=11, frames=FRAME + 1))[FRAME].image)
    bold = OverlayParams(size=2.0)  # as the sheet is smaller than the pictures
    overlays = [
        draw_overlay(image, detections=detect_ellipses(image), params=bold, labels=False)
        for image in images
    ]
    write_image(ROOT / "docs" / "overview.png", mosaic(overlays, columns=3, cell=(400, 300)))


if __name__ == "__main__":
    main()
