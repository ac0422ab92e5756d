"""`geoprim detect`: find ellipses in image files."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from geoprim_core.cli.detector import (
    IMAGE,
    add_detector_arguments,
    add_overlay_arguments,
    detector_params,
    overlay_params,
)
from geoprim_core.ecc import detect_ellipses
from geoprim_core.errors import FileError, GeoprimError
from geoprim_core.io.images import read_image, write_image
from geoprim_core.io.picture import draw_picture
from geoprim_core.types import EllipseDetections

COLUMNS = ("x", "y", "semi_major", "semi_minor", "angle")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("images", nargs="+", type=Path, metavar="IMAGE", help=IMAGE)
    parser.add_argument(
        "--overlay",
        type=Path,
        metavar="PNG",
        help="draw the ellipses on the image, a small one enlarged; with several images a folder",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object an image")
    add_detector_arguments(parser)
    add_overlay_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Detect in every image; an image that cannot be used is reported and makes the exit code 1."""
    params, shown = detector_params(arguments), overlay_params(arguments)
    failed = 0
    for path in arguments.images:
        try:
            image = read_image(path)
            found = detect_ellipses(image, params)
        except GeoprimError as problem:
            said = problem if isinstance(problem, FileError) else f"{path}: {problem}"
            print(f"geoprim detect: {said}", file=sys.stderr)
            failed += 1
            continue
        if not found.complete:
            print(f"geoprim detect: {path}: incomplete: {found.reason}", file=sys.stderr)
        if arguments.overlay is not None:
            target = _overlay_path(arguments.overlay, path, len(arguments.images))
            scheme = params.ecc.scheme
            picture = draw_picture(image, ellipses=found, params=shown, scheme=scheme)
            write_image(target, picture)
        print(json.dumps(as_json(path, found)) if arguments.json else as_table(path, found))
    return 1 if failed else 0


def as_json(path: Path, found: EllipseDetections) -> dict[str, Any]:
    """Return the detections of one image as plain data."""
    size = found.image_size or (None, None)
    numbers = {
        "score": found.score, "coverage": found.coverage,
        "alignment": found.alignment, "continuity": found.continuity,
    }  # fmt: skip
    rows = [
        {
            **dict(zip(COLUMNS, map(float, row), strict=True)),
            **{name: float(column[i]) for name, column in numbers.items()},
        }
        for i, row in enumerate(found.ellipses.array())
    ]
    return {
        "image": str(path), "width": size[0], "height": size[1],
        "complete": found.complete, "reason": found.reason, "ellipses": rows,
    }  # fmt: skip


def as_table(path: Path, found: EllipseDetections) -> str:
    """Return the detections of one image as a text table."""
    noun = "ellipse" if len(found) == 1 else "ellipses"
    lines = [f"{path}: {len(found)} {noun}"]
    if len(found):
        lines.append("         x        y  semi_major  semi_minor  angle_deg  score")
    for i, ellipse in enumerate(found.ellipses):
        lines.append(
            f"  {ellipse.x:8.2f} {ellipse.y:8.2f}  {ellipse.semi_major:10.2f}  "
            f"{ellipse.semi_minor:10.2f}  {ellipse.angle * 57.29577951308232:9.2f}  "
            f"{found.score[i]:5.3f}"
        )
    return "\n".join(lines)


def _overlay_path(overlay: Path, image: Path, count: int) -> Path:
    if count == 1 and overlay.suffix:
        return overlay
    if overlay.exists() and not overlay.is_dir():
        raise FileError(f"{overlay}: expected a folder for the overlays of {count} images")
    return overlay / f"{image.stem}.png"
