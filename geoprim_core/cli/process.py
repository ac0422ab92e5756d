"""`geoprim process`: a bag in, a bag with contours, polygons, ellipses and objects out."""

from __future__ import annotations

import argparse
from pathlib import Path

from geoprim_core.applications import SortingParams
from geoprim_core.cli.detector import (
    add_detector_arguments,
    add_overlay_arguments,
    detector_params,
    overlay_params,
)
from geoprim_core.cli.values import whole
from geoprim_core.ecc import DetectorParams
from geoprim_core.io.config import Config, load_config
from geoprim_core.io.process import process_bag


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("bag", type=Path, metavar="IN.mcap", help="a bag, or a rosbag2 folder")
    parser.add_argument(
        "--output", type=Path, required=True, metavar="OUT.mcap", help="the bag of results"
    )
    parser.add_argument(
        "--overlays", type=Path, metavar="DIR", help="a folder for pictures of the results"
    )
    parser.add_argument(
        "--overlay-every",
        type=whole(0),
        default=1,
        metavar="N",
        help="draw every N-th frame of each sequence; 0: its first one (1)",
    )
    parser.add_argument("--topic", default="image", help="the image topic (default image)")
    parser.add_argument(
        "--config", type=Path, metavar="YAML", help="a scenario file as the nodes take it"
    )
    add_detector_arguments(parser)
    add_overlay_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Process every frame; exit code 1 where frames or parts of the bag were lost, 2 if all."""
    given = arguments.config is not None
    config = load_config(arguments.config) if given else Config(DetectorParams(), SortingParams())
    report = process_bag(
        arguments.bag,
        arguments.output,
        overlays=arguments.overlays,
        overlay_every=arguments.overlay_every,
        params=detector_params(arguments, config.detector),
        sorting=config.sorting,
        plane_distance=config.plane_distance,
        shown=overlay_params(arguments, config.overlay),
        topic=arguments.topic,
    )
    print(report.table())
    pace = report.frames / report.seconds if report.seconds else 0.0
    print(
        f"{report.frames} frames in {report.seconds:.1f} s ({pace:.1f} frames/s): {report.output}"
    )
    if report.overlays:
        print(f"{len(report.overlays)} overlays: {report.overlays[0].parent}")
    if not report.frames and report.losses:
        return 2
    return 1 if report.bad_frames or report.losses else 0
