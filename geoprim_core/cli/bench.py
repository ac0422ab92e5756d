"""`geoprim bench`: the speed of the chain, stage by stage, on one processor."""

from __future__ import annotations

import argparse
from pathlib import Path

from geoprim_core.cli.detector import add_detector_arguments, detector_params
from geoprim_core.cli.values import whole
from geoprim_core.errors import FileError
from geoprim_core.evaluation.peer_runner import CLOCKS
from geoprim_core.evaluation.speed import measure_chain, measure_first_detection
from geoprim_core.io.files import write_table
from geoprim_core.io.images import list_images, read_image, resize_image
from geoprim_core.io.photographs import packaged_photographs


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "images",
        nargs="*",
        type=Path,
        metavar="IMAGE|FOLDER",
        help="default: the photographs that the installed scikit-image ships",
    )
    parser.add_argument("--repeat", type=whole(), default=7, help="runs an image (default 7)")
    parser.add_argument(
        "--size",
        type=whole(),
        nargs=2,
        metavar=("WIDTH", "HEIGHT"),
        help="bring every image to this size [px] first, those higher than wide to it turned",
    )
    parser.add_argument(
        "--clock",
        choices=list(CLOCKS),
        default="elapsed",
        help="time that passes (elapsed), or time on the processor, steadier on a busy machine",
    )
    parser.add_argument(
        "--csv", type=Path, metavar="FILE", help="write one row an image, in milliseconds"
    )
    add_detector_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the table: stage, median and p95 milliseconds an image, share."""
    params = detector_params(arguments)
    paths = [p for given in arguments.images for p in list_images(given)]
    if arguments.images and not paths:
        raise FileError("no image found in " + ", ".join(map(str, arguments.images)))
    images = {str(p): read_image(p) for p in paths} or packaged_photographs()
    if arguments.size is not None:
        images = {name: resize_image(image, arguments.size) for name, image in images.items()}
    times = measure_chain(images, params, repeat=arguments.repeat, clock=arguments.clock)
    print(times.markdown())
    print(f"\nFirst detection in a fresh process: {measure_first_detection():.2f} s")
    if arguments.csv is not None:
        heading = ["image", "width", "height", *times.stages, "total"]
        write_table(arguments.csv, heading, times.rows())
    return 0
