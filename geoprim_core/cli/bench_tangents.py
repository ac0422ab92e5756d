"""`geoprim bench tangents`: nanoseconds a pixel of every tangent method."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tqdm import tqdm

from geoprim_core.cli.benchmark_images import write_files
from geoprim_core.cli.values import whole
from geoprim_core.evaluation.tangent_speed import SIZES, measure_tangents
from geoprim_core.tangent import TABLE

_SHORTEST = 16  # pixels, below which there is no digital circle


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "--methods", nargs="+", choices=TABLE.names, metavar="NAME", default=TABLE.names,
        help="default: all 73",
    )  # fmt: skip
    parser.add_argument(
        "--sizes", nargs="+", type=whole(_SHORTEST), metavar="PIXELS", default=SIZES,
        help="lengths of the digital circles [px] (default 1000 and 1000000; hybrids up to 100000)",
    )  # fmt: skip
    parser.add_argument("--repeat", type=whole(), default=5, help="runs; the least time counts (5)")
    parser.add_argument("--output", type=Path, metavar="DIR", help="write the table as Markdown")
    parser.add_argument("--quiet", action="store_true", help="show no progress bar")


def run(arguments: argparse.Namespace) -> int:
    """Print the table; with --output write it too."""
    hidden = True if arguments.quiet else None
    with tqdm(total=len(arguments.methods), unit="method", file=sys.stderr, disable=hidden) as bar:
        times = measure_tangents(
            arguments.methods, arguments.sizes, repeat=arguments.repeat, after_method=bar.update
        )
    markdown = times.markdown() + "\n"
    print(markdown, end="")
    if arguments.output is not None:
        write_files(arguments.output, {"tangents.md": lambda path: path.write_text(markdown)})
    return 0
