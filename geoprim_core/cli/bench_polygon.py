"""`geoprim bench polygon`: the polygon methods beside shapely and OpenCV, on one processor."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from geoprim_core.cli.benchmark_images import write_files
from geoprim_core.cli.values import whole
from geoprim_core.errors import InputError
from geoprim_core.evaluation.polygon_speed import (
    PEERS,
    WORKLOADS,
    measure_optimal,
    measure_polygons,
)
from geoprim_core.polygon import TABLE


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "--methods", nargs="+", choices=TABLE.names, default=TABLE.names, help="ours (all)"
    )
    parser.add_argument(
        "--workloads",
        nargs="+",
        type=whole(1, len(WORKLOADS)),
        default=list(range(1, len(WORKLOADS) + 1)),
        help="; ".join(f"{k}: {name} points" for k, name in enumerate(WORKLOADS, 1)) + " (all)",
    )
    parser.add_argument(
        "--peer-python",
        action="append",
        default=[],
        metavar="[NAME=]PYTHON",
        help=f"the Python that runs a peer ({', '.join(PEERS)}), or all of them; default this one",
    )
    parser.add_argument("--repeat", type=whole(), default=5, help="runs; the least counts (5)")
    parser.add_argument("--output", type=Path, metavar="DIR", help="write the table as Markdown")


def run(arguments: argparse.Namespace) -> int:
    """Print the table; with --output write it."""
    pythons = dict.fromkeys(PEERS, sys.executable)
    for given in arguments.peer_python:
        name, _, python = given.rpartition("=")
        if name and name not in PEERS:
            raise InputError("--peer-python", "one of " + ", ".join(PEERS), repr(name))
        pythons.update(dict.fromkeys([name] if name else PEERS, python))
    names = list(WORKLOADS)
    chosen = {names[k - 1]: WORKLOADS[names[k - 1]] for k in arguments.workloads}
    times = measure_polygons(arguments.methods, chosen, pythons, arguments.repeat)
    markdown = times.markdown()
    if "optimal" in arguments.methods:
        markdown += "\n" + measure_optimal(repeat=arguments.repeat)
    print(markdown, end="")
    if arguments.output is not None:
        write_files(arguments.output, {"polygon_speed.md": lambda path: path.write_text(markdown)})
    return 0
