"""`geoprim calibrate`: tell whether scores are probabilities and covariances hold."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from geoprim_core.cli.benchmark_images import save, write_files
from geoprim_core.cli.values import ratio, whole
from geoprim_core.ecc import DetectorParams, detect_ellipses
from geoprim_core.ecc.refined.score import SCORE_MAP
from geoprim_core.evaluation import (
    Coverage,
    GroundTruth,
    ScoredDetections,
    collect_scores,
    cross_scores,
    fit_score,
    load_ground_truth,
    measure_coverage,
    measure_reliability,
    reliability_table,
)
from geoprim_core.io.images import read_image
from geoprim_core.plotting import plot_coverage, plot_reliability
from geoprim_core.synthetic import assorted_scenes
from geoprim_core.types import EllipseDetections

_PHOTOGRAPHS = "photographs"
# There are many synthetic sets, one of photographs, and a robot sees the latter.
_WEIGHT_OF_PHOTOGRAPHS = 4.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "folder",
        nargs="?",
        type=Path,
        metavar="FOLDER",
        help="photographs with ground-truth files (*.json) to judge scores by too",
    )
    parser.add_argument(
        "--images", type=Path, metavar="DIR", help="where the images of the ground truth lie"
    )
    parser.add_argument(
        "--scenes", type=whole(), default=4, help="scenes a synthetic set (default 4)"
    )
    parser.add_argument(
        "--singles",
        type=whole(0),
        default=1000,
        help="pictures of one ellipse to judge covariances by; 0: do not (default 1000)",
    )
    parser.add_argument("--seed", type=whole(0), default=0, help="seed of all scenes (default 0)")
    parser.add_argument(
        "--min-score", type=ratio, default=0.0, help="least score of a detection (default 0)"
    )
    parser.add_argument(
        "--fit", action="store_true", help="fit the map from evidence to score, and print it"
    )
    parser.add_argument(
        "--output", type=Path, metavar="DIR", help="write reliability.png and coverage.png"
    )


def run(arguments: argparse.Namespace) -> int:
    """Print the tables of the scores and of the covariances."""
    params = DetectorParams().updated({"ecc.refined.min_score": arguments.min_score})
    samples = collect_scores(_pairs(arguments, params))
    print(reliability_table(samples))
    if arguments.fit:
        _print_fit(samples)
    coverage = None
    if arguments.singles > 0:
        coverage = measure_coverage(arguments.singles, seed=arguments.seed)
        print("\n" + coverage.markdown())
    if arguments.output is not None:
        _write(samples, coverage, arguments.output)
    return 0


def _pairs(
    arguments: argparse.Namespace, params: DetectorParams
) -> Iterator[tuple[EllipseDetections, GroundTruth]]:
    """Yield what is found in every scene and photograph, and the truth."""
    for index, (name, scene) in enumerate(assorted_scenes(arguments.scenes, arguments.seed)):
        truth = GroundTruth(f"{name} {index}", scene.ellipses, ~scene.required, group=name)
        yield detect_ellipses(scene.image, params), truth
    if arguments.folder is not None:
        for entry in load_ground_truth(arguments.folder, arguments.images):
            if entry.path is not None and not entry.recall_only:
                found = detect_ellipses(read_image(entry.path), params)
                yield found, replace(entry, group=_PHOTOGRAPHS)


def _print_fit(samples: ScoredDetections) -> None:
    """Print the fitted map as it stands in `ecc/refined/score.py`, and what it does."""
    weights = {_PHOTOGRAPHS: _WEIGHT_OF_PHOTOGRAPHS}
    fitted = fit_score(samples, weights=weights)
    print("\nThe same with this map, photographs each by a map fitted without it:\n")
    print(f"    evidence {fitted.evidence.tolist()}")
    print(f"    log_odds {fitted.log_odds.round(2).tolist()}\n")
    evidence = np.array([SCORE_MAP.evidence_of(score) for score in samples.score])
    scored = samples.rescored(fitted.probability(evidence))
    if _PHOTOGRAPHS in samples.groups:
        outside = [group != _PHOTOGRAPHS for group in scored.groups]
        scored = scored.select(outside) + cross_scores(samples, _PHOTOGRAPHS, weights=weights)
    print(reliability_table(scored))


def _write(samples: ScoredDetections, coverage: Coverage | None, folder: Path) -> None:
    axes = {"reliability.png": plot_reliability(measure_reliability(samples))}
    if coverage is not None:
        axes["coverage.png"] = plot_coverage(coverage)
    write_files(folder, {name: partial(save, plot.figure) for name, plot in axes.items()})
