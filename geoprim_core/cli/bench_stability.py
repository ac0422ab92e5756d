"""`geoprim bench stability`: F of turned, mirrored, shifted and brightened images."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

from tqdm import tqdm

from geoprim_core.cli.bench_detectors import DEFAULT_SETS
from geoprim_core.cli.benchmark_images import (
    BenchmarkImages,
    Image,
    add_image_arguments,
    truth_of_folders,
)
from geoprim_core.cli.detector import add_detector_arguments, detector_params
from geoprim_core.evaluation.comparison import compare_detectors
from geoprim_core.evaluation.peers import OwnDetector
from geoprim_core.evaluation.stability import changed_images, stability_markdown


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_image_arguments(parser)
    add_detector_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the table: F as it is, and how it differs after each change."""
    truth = truth_of_folders(arguments.folders)
    images = BenchmarkImages(arguments, truth, default_sets=DEFAULT_SETS)
    detector = OwnDetector(arguments.scheme or "refined", detector_params(arguments))
    with images.bar() as bar:
        comparison = compare_detectors([detector], changed_images(_counted(images, bar)))
    print(stability_markdown(comparison), end="")
    return 0


def _counted(images: BenchmarkImages, bar: tqdm[None]) -> Iterator[Image]:
    """Yield the images; the bar moves on when all is done with one."""
    for image in images:
        yield image
        bar.update()
