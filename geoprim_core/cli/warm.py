"""`geoprim warm`: compile the numeric kernels ahead of time."""

from __future__ import annotations

import argparse
import os
import sys
import time

from tqdm import tqdm

from geoprim_core._jit import cache_base
from geoprim_core.cli.values import whole
from geoprim_core.warm import PARTS, remove_other_kernels, warm_kernels


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "parts",
        nargs="*",
        metavar="PART",
        default=tuple(PARTS),
        help=f"what to compile, of {', '.join(PARTS)} (all)",
    )
    parser.add_argument(
        "--processes",
        type=whole(),
        default=os.cpu_count() or 1,
        help="so many at a time (all processors)",
    )
    parser.add_argument(
        "--clean", action="store_true", help="remove the kernels of other versions and places first"
    )


def run(arguments: argparse.Namespace) -> int:
    """Run every scheme and method once on a small scene."""
    start = time.perf_counter()
    if arguments.clean:
        print(f"kernels of {remove_other_kernels()} other files removed")
    parts = arguments.parts
    with tqdm(total=len(parts), unit="part", file=sys.stderr, leave=False) as bar:
        warm_kernels(parts, processes=arguments.processes, step=lambda name: bar.update())
    where = cache_base() or "nowhere: the cache folder cannot be written"
    print(f"kernels ready after {time.perf_counter() - start:.1f} s, kept in {where}")
    return 0
