"""`geoprim tangents`: the tangents of the edge contours of an image, and their normals drawn."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geoprim_core.cli.detector import IMAGE
from geoprim_core.cli.options import add_params, given_params
from geoprim_core.edges import EdgeParams, extract_contours
from geoprim_core.errors import ParameterError
from geoprim_core.io.drawing import draw_normals
from geoprim_core.io.files import write_table
from geoprim_core.io.images import read_image, write_image
from geoprim_core.params import Params, group
from geoprim_core.tangent import TABLE, estimate_tangents
from geoprim_core.types import Contours, Tangents


@dataclass(frozen=True)
class _Stages(Params):
    edges: EdgeParams = group(EdgeParams)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("image", type=Path, metavar="IMAGE", help=IMAGE)
    parser.add_argument(
        "--method", choices=TABLE.names, default="deb", metavar="NAME",
        help=f"one of {', '.join(TABLE.names[:13])}, or a hybrid as lr1_h10 (choices of the "
        "window: 10, 11, 12, 2, 3, 4); default deb",
    )  # fmt: skip
    parser.add_argument(
        "-o", "--overlay", type=Path, metavar="PNG", help="draw the contours and normals"
    )
    parser.add_argument(
        "--csv",
        type=Path,
        metavar="FILE",
        help="write one row a pixel: contour, x, y [px], angle [rad]",
    )
    for params in _params_classes():
        names = [row.name for row in TABLE if row.params is params]
        add_params(parser, params, f"parameters of {names[0]}" + (" .." if names[1:] else ""))
    add_params(parser, _Stages, "parameters of the edges")


def run(arguments: argparse.Namespace) -> int:
    """Print how many pixels have a tangent; draw them, write them."""
    row = TABLE[arguments.method]
    for params in _params_classes():
        for name in given_params(arguments, params):
            if params is not row.params:
                raise ParameterError(name, f"a parameter of {row.name}", params.__name__)
    settings = row.params().updated(given_params(arguments, row.params))
    edges = _Stages().updated(given_params(arguments, _Stages)).edges
    image = read_image(arguments.image)
    contours = extract_contours(image, edges)
    tangents = estimate_tangents(contours, row.name, settings)
    defined = np.count_nonzero(~np.isnan(tangents.angle))
    print(
        f"{arguments.image}: {len(contours)} contours, {len(tangents.angle)} pixels, "
        f"{defined} with a tangent ({row.name})"
    )
    if arguments.overlay is not None:
        write_image(arguments.overlay, draw_normals(image, contours, tangents))
    if arguments.csv is not None:
        _write(arguments.csv, contours, tangents)
    return 0


def _params_classes() -> list[type[Params]]:
    return list(dict.fromkeys(row.params for row in TABLE))


def _write(path: Path, contours: Contours, tangents: Tangents) -> None:
    owner = np.repeat(np.arange(len(contours)), np.diff(contours.offsets))
    columns = zip(owner, contours.points, tangents.angle, strict=True)
    rows = ([k, *point, angle] for k, point, angle in columns)
    write_table(path, ["contour", "x", "y", "angle"], rows)
