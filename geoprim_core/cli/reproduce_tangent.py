"""`geoprim reproduce tangent`: the experiments of thesis chapter 3, rerun with every method."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

from tqdm import tqdm

from geoprim_core.cli.benchmark_images import save, write_files
from geoprim_core.cli.values import whole
from geoprim_core.evaluation.claims import claim_text
from geoprim_core.evaluation.reproduce_tangent_claims import check_claims
from geoprim_core.evaluation.reproduce_tangent_report import chooser_markdown, report_markdown
from geoprim_core.evaluation.reproduce_tangent_run import (
    Extent,
    Results,
    directions_csv,
    records_csv,
    run_experiments,
    sensitivity_csv,
    task_count,
)
from geoprim_core.plotting.tangents import tangent_figures
from geoprim_core.tangent import TABLE

_QUICK = 3


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "--count", type=whole(), help="curves a setting, 100 eccentricities among them (100)"
    )
    parser.add_argument("--quick", action="store_true", help=f"the same as --count {_QUICK}")
    parser.add_argument(
        "--methods",
        nargs="+",
        default=TABLE.names,
        metavar="METHOD",
        help="only these and deb (all)",
    )
    parser.add_argument("--seed", type=whole(0), default=0, help="seed of the curves' centres (0)")
    parser.add_argument("--processes", type=whole(), help="so many at a time (all processors)")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="DIR", help="write report, tables and plots"
    )
    parser.add_argument(
        "--chooser", type=Path, metavar="FILE", help="write which method suits which curve"
    )
    parser.add_argument("--quiet", action="store_true", help="show no progress bar")


def run(arguments: argparse.Namespace) -> int:
    """Print which claims are reproduced; write report, tables and plots where asked to."""
    extent = Extent.of(_count(arguments), arguments.methods)
    started = time.perf_counter()
    results = _results(arguments, extent)
    seconds = time.perf_counter() - started
    claims = check_claims(results)
    for claim in claims:
        print(claim_text(claim))
    if arguments.output is not None:
        report = report_markdown(results, claims, extent, arguments.seed, seconds)
        write_files(arguments.output, _files(results, report))
    if arguments.chooser is not None:
        text = chooser_markdown(results, extent, arguments.seed)
        file = {arguments.chooser.name: lambda path: path.write_text(text)}
        write_files(arguments.chooser.parent, file)
    return 0


def _count(arguments: argparse.Namespace) -> int:
    return int(arguments.count or (_QUICK if arguments.quick else Extent().count))


def _results(arguments: argparse.Namespace, extent: Extent) -> Results:
    hidden = True if arguments.quiet else None
    with tqdm(total=task_count(extent), unit="task", file=sys.stderr, disable=hidden) as bar:
        return run_experiments(
            extent, arguments.seed, workers=arguments.processes, step=lambda: bar.update()
        )


def _files(results: Results, report: str) -> dict[str, Callable[[Path], object]]:
    tables = {
        "sweep.csv": records_csv(results.sweep),
        "rows.csv": records_csv(results.rows),
        "grid.csv": records_csv(results.grid),
        "bounds.csv": records_csv(results.bounds),
        "walks.csv": records_csv(results.walks),
        "sensitivity.csv": sensitivity_csv(results),
        "directions.csv": directions_csv(results),
    }
    files: dict[str, Callable[[Path], object]] = {"report.md": lambda p: p.write_text(report)}
    for name, text in tables.items():
        files[name] = lambda path, text=text: path.write_text(text)  # type: ignore[misc]
    for stem, draw in tangent_figures(results).items():
        files[f"{stem}.png"] = lambda path, draw=draw: save(draw(), path)  # type: ignore[misc]
    return files
