"""`geoprim polygons`: the polygonal approximation of the edge contours of an image."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from geoprim_core.cli.detector import IMAGE
from geoprim_core.cli.options import add_params, given_params
from geoprim_core.ecc import DetectorParams
from geoprim_core.ecc.detector import find_polygons
from geoprim_core.edges import extract_contours
from geoprim_core.io.drawing import draw_overlay
from geoprim_core.io.images import read_image, write_image
from geoprim_core.polygon import TABLE
from geoprim_core.types import Contours, Polygons


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("image", type=Path, metavar="IMAGE", help=IMAGE)
    parser.add_argument(
        "--method",
        nargs="+",
        choices=TABLE.names,
        default=["rdp_mod"],
        help="polygonal approximation, or several to compare (rdp_mod)",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="PNG",
        help="draw contours, polygons and vertices; with several methods a folder",
    )
    add_params(parser, DetectorParams, "chain")


def run(arguments: argparse.Namespace) -> int:
    """Print contours, points, vertices and compression ratio of each method; draw them."""
    image = read_image(arguments.image)
    chosen = DetectorParams().updated(given_params(arguments, DetectorParams))
    contours = extract_contours(image, chosen.edges)
    print("method         contours   points  vertices  points/vertex")
    for method in arguments.method:
        polygons = find_polygons(contours, chosen.updated({"polygon_method": method}))
        print(as_row(method, contours, polygons))
        if arguments.output is not None:
            several = len(arguments.method) > 1
            path = arguments.output / f"{method}.png" if several else arguments.output
            caption = f"{method}: {len(polygons.indices)} vertices"
            write_image(path, draw_overlay(image, contours, polygons, caption=caption))
    return 0


def as_row(method: str, contours: Contours, polygons: Polygons) -> str:
    """Return one row of the table.

    Examples
    --------
    >>> line = Contours([(0, 0), (1, 0), (2, 0), (3, 0)], [0, 4], [False])
    >>> as_row("rdp", line, Polygons([0, 3], [0, 2], [False])).split()
    ['rdp', '1', '4', '2', '2.00']
    """
    points, vertices = len(contours.points), len(polygons.indices)
    ratio = points / vertices if vertices else np.nan
    return f"{method:14} {len(contours):8} {points:8} {vertices:9} {ratio:14.2f}"
