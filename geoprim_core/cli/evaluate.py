"""`geoprim evaluate`: precision, recall and F, one to one, per sequence and pooled."""

from __future__ import annotations

import argparse
from pathlib import Path

from geoprim_core.cli.detector import add_detector_arguments, detector_params
from geoprim_core.ecc import detect_ellipses
from geoprim_core.errors import FileError
from geoprim_core.evaluation import Report, evaluate_images, load_ground_truth
from geoprim_core.io.images import read_image
from geoprim_core.io.score_bag import score_bag
from geoprim_core.plotting import plot_scores


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "path",
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
    parser.add_argument(
        "--overlap", type=float, nargs="+", default=[0.8, 0.95], help="least overlap of a hit"
    )
    parser.add_argument(
        "--output", type=Path, metavar="DIR", help="write scores.csv, images.csv and scores.png"
    )
    add_detector_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the table; with --output write it as CSV and as a plot."""
    report = _report(arguments)
    print(report.markdown(), end="")
    if arguments.output is not None:
        _write(report, arguments.output)
    return 0


def _report(arguments: argparse.Namespace) -> Report:
    if not arguments.path.exists():
        raise FileError(f"{arguments.path}: no such file or folder")
    if arguments.path.suffix == ".mcap" or list(arguments.path.glob("*.mcap")):
        return score_bag(arguments.path, found=arguments.topic, overlaps=arguments.overlap)
    truth = load_ground_truth(arguments.path, arguments.images)
    params = detector_params(arguments)
    return evaluate_images(
        lambda image: detect_ellipses(image, params), truth, read_image, overlaps=arguments.overlap
    )


def _write(report: Report, folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "scores.csv").write_text(report.csv())
        (folder / "images.csv").write_text(report.csv_images())
        plot_scores(report).figure.savefig(folder / "scores.png", dpi=150, bbox_inches="tight")
    except OSError as problem:
        raise FileError(f"cannot write to {folder}: {problem.strerror}") from None
    print(f"\nwritten: {folder / 'scores.csv'}, images.csv, scores.png")
