"""`geoprim bench fitting`: the speed of every ellipse fit, single and in a batch, and of others."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from tqdm import tqdm

from geoprim_core.cli.benchmark_images import write_files
from geoprim_core.cli.values import whole
from geoprim_core.evaluation.fit_speed import fit_speed_markdown, measure_fits
from geoprim_core.io.fit_peers import REFERENCE, peer_calls


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("--arcs", type=whole(), default=10_000, help="arcs in a batch (10000)")
    parser.add_argument("--repeat", type=whole(), default=15, help="runs of a single call (15)")
    parser.add_argument("--output", type=Path, metavar="DIR", help="write the table as Markdown")
    parser.add_argument("--quiet", action="store_true", help="show no progress bar")


def run(arguments: argparse.Namespace) -> int:
    """Print the table; all methods run on one processor and in one thread."""
    peers = peer_calls()
    hidden = True if arguments.quiet else None
    total = arguments.repeat + min(arguments.repeat, 7)
    with tqdm(total=total, unit="round", file=sys.stderr, disable=hidden) as bar:
        rows = measure_fits(
            peers, arcs=arguments.arcs, repeat=arguments.repeat, after_round=bar.update
        )
    markdown = fit_speed_markdown(rows, REFERENCE)
    print(markdown, end="")
    if arguments.output is not None:
        write_files(arguments.output, {"fitting_speed.md": lambda path: path.write_text(markdown)})
    return 0
