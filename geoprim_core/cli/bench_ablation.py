"""`geoprim bench ablation`: F with all departures from the thesis, and what each one adds."""

from __future__ import annotations

import argparse
from pathlib import Path

from geoprim_core.cli.bench_detectors import DEFAULT_SETS
from geoprim_core.cli.benchmark_images import (
    BenchmarkImages,
    add_image_arguments,
    comparison_files,
    truth_of_folders,
    write_files,
)
from geoprim_core.cli.detector import add_detector_arguments, detector_params
from geoprim_core.cli.values import whole
from geoprim_core.errors import InputError
from geoprim_core.evaluation.ablation import (
    DEPARTURES,
    EVERYTHING,
    ablation_detectors,
    ablation_markdown,
)
from geoprim_core.evaluation.comparison import compare_detectors


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_image_arguments(parser)
    parser.add_argument(
        "--only",
        nargs="+",
        metavar="WORD",
        help="the departures with one of these words in their name (all)",
    )
    parser.add_argument(
        "--repeat", type=whole(), default=1, help="runs an image; the least counts (1)"
    )
    parser.add_argument("--output", type=Path, metavar="DIR", help="write the tables as files")
    add_detector_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the table; with --output write it and the scores behind it."""
    truth = truth_of_folders(arguments.folders)
    images = BenchmarkImages(arguments, truth, default_sets=DEFAULT_SETS)
    words = arguments.only or [""]
    chosen = [d for d in DEPARTURES if any(word in d.name for word in words)]
    if not chosen:
        names = "; ".join(d.name for d in DEPARTURES)
        raise InputError("--only", f"words of: {names}", " ".join(words))
    detectors = ablation_detectors(chosen, detector_params(arguments))
    with images.bar() as bar:
        comparison = compare_detectors(
            detectors, images, repeat=arguments.repeat, reference=EVERYTHING, after_image=bar.update
        )
    markdown = ablation_markdown(comparison)
    print(markdown, end="")
    if arguments.output is not None:
        files = comparison_files(comparison, markdown)
        tables = {name: write for name, write in files.items() if not name.endswith(".png")}
        write_files(arguments.output, tables)
    return 0
