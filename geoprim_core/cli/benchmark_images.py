"""What the commands that judge detectors share: which images, and the files that they write."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from tqdm import tqdm

from geoprim_core.cli.values import positive, ratio, whole
from geoprim_core.errors import FileError, InputError
from geoprim_core.evaluation import GroundTruth, load_ground_truth
from geoprim_core.evaluation.benchmark_sets import (
    BENCHMARK_SETS,
    BenchmarkImage,
    BenchmarkSet,
    select_sets,
)
from geoprim_core.evaluation.comparison import Comparison
from geoprim_core.evaluation.comparison_tables import comparison_csv, comparison_images_csv
from geoprim_core.io.files import make_folder
from geoprim_core.io.images import read_image
from geoprim_core.io.photographs import packaged_backgrounds
from geoprim_core.plotting import plot_precision_recall, plot_time_accuracy
from geoprim_core.plotting.comparison import draw_alpha_panels, has_alpha, set_overlaps

FOLDER_OVERLAPS = (0.8,)

Image = tuple[BenchmarkImage, Sequence[float]]


def add_image_arguments(parser: argparse.ArgumentParser) -> None:
    """Add folders and what `add_set_arguments` adds."""
    parser.add_argument(
        "folders",
        nargs="*",
        type=Path,
        metavar="FOLDER",
        help="images with ground truth (*.json, or in the subfolder gt)",
    )
    add_set_arguments(parser)


def add_set_arguments(parser: argparse.ArgumentParser) -> None:
    """Add rendered sets, their number of images and seed, overlaps, and the progress bar."""
    families = sorted({row.family for row in BENCHMARK_SETS.values()})
    parser.add_argument(
        "--sets",
        nargs="+",
        default=[],
        metavar="SET",
        help=f"rendered sets, by name or family: all, {', '.join(families)}; "
        + ", ".join(BENCHMARK_SETS),
    )
    parser.add_argument(
        "--count", type=whole(), default=24, help="images a rendered set; best a multiple of 6 (24)"
    )
    parser.add_argument("--seed", type=whole(0), default=0, help="seed of the rendered sets (0)")
    parser.add_argument(
        "--overlap",
        type=ratio,
        nargs="+",
        metavar="RATIO",
        help="least overlaps of a hit (default: 0.8, rendered sets what belongs to them)",
    )
    parser.add_argument("--quiet", action="store_true", help="show no progress bar")


def add_time_limit(parser: argparse.ArgumentParser) -> None:
    """Add how long a detector in another process may take."""
    parser.add_argument(
        "--time-limit",
        type=positive,
        default=30.0,
        metavar="SECONDS",
        help="longest time of another detector for an image, which then counts as one where "
        "nothing was found [s] (30)",
    )


class BenchmarkImages:
    """The images that the arguments name, read or rendered one by one.

    Parameters
    ----------
    arguments : argparse.Namespace
        With what `add_set_arguments` added.
    truth : sequence of GroundTruth
        Of image files.
    default_sets : names
        The rendered sets that are taken where neither sets nor files are named.
    overlaps : floats
        For the image files, where the arguments give none.
    """

    def __init__(
        self,
        arguments: argparse.Namespace,
        truth: Sequence[GroundTruth],
        *,
        default_sets: Sequence[str] = (),
        overlaps: Sequence[float] = FOLDER_OVERLAPS,
    ) -> None:
        self._arguments = arguments
        self._truth = truth
        self._overlaps = arguments.overlap or overlaps
        self._sets = select_sets(arguments.sets or ([] if truth else default_sets))
        if not self._sets and not truth:
            raise InputError("path, --sets", "images with ground truth or a rendered set", "none")

    def __len__(self) -> int:
        """Return the number of images."""
        return len(self._truth) + len(self._sets) * int(self._arguments.count)

    def __iter__(self) -> Iterator[Image]:
        """Iterate over the images with the overlaps that they are judged at."""
        for row in self._sets:
            for image in self._rendered(row):
                yield image, self._arguments.overlap or row.overlaps
        for truth in self._truth:
            yield BenchmarkImage(self.image_of(truth), truth), self._overlaps

    def bar(self) -> tqdm[None]:
        """Return a progress bar; it hides itself where there is no terminal."""
        hidden = True if self._arguments.quiet else None
        return tqdm(total=len(self), unit="image", file=sys.stderr, disable=hidden)

    def image_of(self, truth: GroundTruth) -> Any:
        """Return the image of a truth again."""
        if truth.path is not None:
            return read_image(truth.path)
        images = self._rendered(BENCHMARK_SETS[truth.group])
        return next(image.image for image in images if image.truth.name == truth.name)

    def _rendered(self, row: BenchmarkSet) -> Iterator[BenchmarkImage]:
        backgrounds = packaged_backgrounds() if row.family == "discs" else None
        count, seed = self._arguments.count, self._arguments.seed
        return row.images(count, seed=seed, backgrounds=backgrounds)


def truth_of_folders(folders: Sequence[Path]) -> list[GroundTruth]:
    """Return the truth of image folders, each as one group."""
    truth = list[GroundTruth]()
    for folder in folders:
        if not folder.is_dir():
            raise FileError(f"{folder}: no such folder")
        name = folder.resolve().name
        truth += [replace(entry, group=name) for entry in load_ground_truth(folder)]
    return truth


def write_files(folder: Path, files: dict[str, Callable[[Path], object]]) -> None:
    """Write files into a folder, made where it is missing, and say which."""
    make_folder(folder)
    try:
        for name, write in files.items():
            write(folder / name)
    except OSError as problem:
        raise FileError(f"cannot write to {folder}: {problem.strerror}") from None
    print(f"\nwritten to {folder}: {', '.join(files)}")


def comparison_files(comparison: Comparison, markdown: str) -> dict[str, Callable[[Path], object]]:
    """Return name -> writer of a comparison's tables and plots; a further plot is a further entry.

    `comparison_tables.scored_detections` gives what a reliability diagram needs.
    """
    files: dict[str, Callable[[Path], object]] = {
        "scores.md": lambda path: path.write_text(markdown),
        "scores.csv": lambda path: path.write_text(comparison_csv(comparison)),
        "images.csv": lambda path: path.write_text(comparison_images_csv(comparison)),
        "time_accuracy.png": lambda path: save(plot_time_accuracy(comparison).figure, path),
    }
    for name, overlap in set_overlaps(comparison):
        stem = f"{name or 'images'}_{overlap:g}"
        files[f"precision_recall_{stem}.png"] = _precision_recall_writer(comparison, name, overlap)
        if has_alpha(comparison, name):
            files[f"alpha_{stem}.png"] = _alpha_writer(comparison, name, overlap)
    return files


def save(figure: Any, path: Path) -> None:
    """Write a figure as PNG."""
    figure.savefig(path, dpi=130, bbox_inches="tight")


def _precision_recall_writer(
    comparison: Comparison, name: str, overlap: float
) -> Callable[[Path], object]:
    return lambda path: save(plot_precision_recall(comparison, name, overlap).figure, path)


def _alpha_writer(comparison: Comparison, name: str, overlap: float) -> Callable[[Path], object]:
    return lambda path: save(draw_alpha_panels(comparison, name, overlap), path)
