"""`geoprim warm`: compile the numeric kernels ahead of time."""

from __future__ import annotations

import argparse
import time

from geoprim_core._jit import cache_base


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command: it has none."""


def run(arguments: argparse.Namespace) -> int:
    """Run every scheme and method once on a small scene."""
    from geoprim_core.warm import warm_kernels

    start = time.perf_counter()
    warm_kernels()
    where = cache_base() or "nowhere: the cache folder cannot be written"
    print(f"kernels ready after {time.perf_counter() - start:.1f} s, kept in {where}")
    return 0
