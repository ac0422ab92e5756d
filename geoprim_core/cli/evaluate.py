"""`geoprim evaluate`: precision, recall and F, one to one, per sequence and pooled."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from geoprim_core.cli.benchmark_images import (
    BenchmarkImages,
    add_set_arguments,
    add_time_limit,
    comparison_files,
    write_files,
)
from geoprim_core.cli.detector import add_detector_arguments, detector_params
from geoprim_core.cli.overlays import write_overlays
from geoprim_core.cli.values import whole
from geoprim_core.errors import FileError, InputError
from geoprim_core.evaluation import OVERLAPS, Report, load_ground_truth
from geoprim_core.evaluation.comparison import Comparison, compare_detectors
from geoprim_core.evaluation.comparison_tables import worst_markdown
from geoprim_core.evaluation.peers import DetectorUnderTest, OwnDetector, Peer
from geoprim_core.io.score_bag import score_bag
from geoprim_core.plotting import plot_scores

Files = dict[str, Callable[[Path], object]]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "path",
        nargs="?",
        type=Path,
        metavar="BAG|FOLDER",
        help="a bag with results and ground truth, or a folder with ground-truth files (*.json)",
    )
    parser.add_argument(
        "--images", type=Path, metavar="DIR", help="where the images of the ground truth lie"
    )
    parser.add_argument(
        "--topic",
        default="ellipses",
        help="what is scored of a bag: ellipses (default), or detections, the labelled objects",
    )
    add_set_arguments(parser)
    parser.add_argument(
        "--detector",
        metavar="MODULE:CALLABLE",
        help="judge another detector; see `geoprim bench detectors --help`",
    )
    parser.add_argument(
        "--detector-python", metavar="PYTHON", help="the Python that runs it (this one)"
    )
    add_time_limit(parser)
    parser.add_argument("--worst", type=whole(0), default=5, help="images listed as the worst (5)")
    parser.add_argument(
        "--output", type=Path, metavar="DIR", help="write tables (Markdown, CSV) and plots"
    )
    parser.add_argument(
        "--overlays", type=Path, metavar="DIR", help="draw the worst images: hits, misses, false"
    )
    add_detector_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the tables; with --output write them and the plots, with --overlays pictures."""
    path = arguments.path
    if path is not None and not path.exists():
        raise FileError(f"{path}: no such file or folder")
    if path is not None and path.is_file() and path.suffix != ".mcap":
        raise FileError(f"{path}: expected a bag (.mcap) or a folder with ground truth, got a file")
    if _is_bag(arguments.path):
        _evaluate_bag(arguments)
    else:
        _evaluate_images(arguments)
    return 0


def _is_bag(path: Path | None) -> bool:
    return path is not None and (path.suffix == ".mcap" or any(path.glob("*.mcap")))


def _evaluate_bag(arguments: argparse.Namespace) -> None:
    if arguments.overlays is not None:
        raise InputError("--overlays", "images; a bag's are drawn by `geoprim process`", "a bag")
    overlaps = arguments.overlap or OVERLAPS
    report = score_bag(arguments.path, found=arguments.topic, overlaps=overlaps)
    markdown = report.markdown()
    print(markdown, end="")
    if arguments.output is not None:
        write_files(arguments.output, _report_files(report, markdown))


def _evaluate_images(arguments: argparse.Namespace) -> None:
    folder = arguments.path
    truth = () if folder is None else load_ground_truth(folder, arguments.images)
    images = BenchmarkImages(arguments, truth, overlaps=OVERLAPS)
    detector = _detector(arguments)
    try:
        with images.bar() as bar:
            comparison = compare_detectors([detector], images, after_image=bar.update)
    finally:
        detector.close()
    report, markdown = comparison.report(detector.name), _markdown(comparison, arguments.worst)
    print(markdown, end="")
    if arguments.output is not None:
        compared = comparison_files(comparison, markdown)
        plots: Files = {n: write for n, write in compared.items() if n.endswith(".png")}
        write_files(arguments.output, _report_files(report, markdown) | plots)
    if arguments.overlays is not None:
        write_overlays(arguments.overlays, comparison, images, arguments.worst)


def _detector(arguments: argparse.Namespace) -> DetectorUnderTest:
    if arguments.detector is None:
        return OwnDetector("geoprim", detector_params(arguments))
    name = arguments.detector.rpartition(":")[2]
    python, limit = arguments.detector_python, arguments.time_limit
    return Peer(name, arguments.detector, python=python, time_limit=limit)


def _markdown(comparison: Comparison, worst: int) -> str:
    """Return the report, what gave no answer, and the worst images at the least overlap."""
    (name,) = comparison.detectors
    text = comparison.report(name).markdown()
    if comparison.problems:
        text += "\nWithout an answer:\n\n" + "".join(f"- {p}\n" for p in comparison.problems)
    measured = comparison.of(name)
    for overlap in sorted({m.matchings[0][0] for m in measured}) if worst > 0 else ():
        chosen = [m for m in measured if m.matchings[0][0] == overlap]
        text += f"\nThe worst, overlap {overlap:g}:\n\n{worst_markdown(chosen, overlap, worst)}"
    return text


def _report_files(report: Report, markdown: str) -> Files:
    return {
        "scores.md": lambda path: path.write_text(markdown),
        "scores.csv": lambda path: path.write_text(report.csv()),
        "images.csv": lambda path: path.write_text(report.csv_images()),
        "scores.png": lambda path: plot_scores(report).figure.savefig(
            path, dpi=150, bbox_inches="tight"
        ),
    }
