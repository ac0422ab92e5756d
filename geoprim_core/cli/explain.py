"""`geoprim explain`: see why an ellipse was found or lost."""

from __future__ import annotations

import argparse
import sys
from dataclasses import asdict, fields
from pathlib import Path

from geoprim_core.cli.detector import IMAGE, add_detector_arguments, detector_params
from geoprim_core.io.explain import Hypothesis, explain_detection
from geoprim_core.io.files import write_table
from geoprim_core.io.images import read_image, write_image


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("image", type=Path, metavar="IMAGE", help=IMAGE)
    parser.add_argument(
        "-o", "--output", type=Path, required=True, metavar="DIR", help="where the pictures go"
    )
    add_detector_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Write one picture a step and hypotheses.csv, and print what became of the hypotheses."""
    explained = explain_detection(read_image(arguments.image), detector_params(arguments))
    for number, (name, picture) in enumerate(explained.pictures.items(), start=1):
        path = arguments.output / f"{number}_{name}.png"
        write_image(path, picture)
        print(path)
    table = arguments.output / "hypotheses.csv"
    heading = [field.name for field in fields(Hypothesis)]
    write_table(table, heading, (asdict(h).values() for h in explained.hypotheses))
    if not explained.detections.complete:
        print(f"incomplete: {explained.detections.reason}", file=sys.stderr)
    print(f"{table}: {len(explained.hypotheses)} judged, {len(explained.detections)} reported")
    return 0
