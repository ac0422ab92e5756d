"""The work of `geoprim bench ros`, whose arguments stand in `geoprim_core.cli.bench_ros`."""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from tqdm import tqdm

from geoprim_core.errors import FileError
from geoprim_ros.bench.cases import Case, cases_of
from geoprim_ros.bench.pictures import render
from geoprim_ros.bench.processes import Bench
from geoprim_ros.bench.report import Measured, markdown, write_csv, write_plot
from geoprim_ros.bench.runs import Run, find_highest


def run(arguments: argparse.Namespace) -> int:
    """Measure every case and print the table; with --output write tables and a picture too."""
    wanted = {"compressed": not arguments.raw_only, "stock": not arguments.own_profile_only}
    cases = list(cases_of(arguments.graphs, arguments.sizes, **wanted))
    words = ["--params-file", str(arguments.config)] if arguments.config else []
    hidden = True if arguments.quiet else None
    with (
        tempfile.TemporaryDirectory(prefix="geoprim_bench_") as folder,
        tqdm(total=len(cases), unit="case", file=sys.stderr, disable=hidden) as bar,
    ):
        measured = [_measured(case, Path(folder), words, arguments, bar) for case in cases]
    print(markdown(measured), end="")
    if arguments.output is not None:
        _write(measured, arguments.output)
    return 0


def _measured(
    case: Case, folder: Path, words: list[str], arguments: argparse.Namespace, bar: tqdm[None]
) -> Measured:
    first = case.pictures.first_rate
    bar.set_description(f"{case.pictures.name}, {case.graph.name}, {case.profile}")

    def measure(rate: float) -> Run:
        bar.set_postfix_str(f"{rate:g} frames/s")
        return bench.measure(rate, max(2, round(rate * arguments.seconds)))

    with Bench(case, render(case.pictures, folder), folder, words) as bench:
        rates = (first,) if arguments.no_search else case.pictures.rates
        runs = find_highest(measure, rates, first)
    bar.update()
    return Measured(case, tuple(runs))


def _write(measured: list[Measured], folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "ros.md").write_text(markdown(measured))
        write_csv(measured, folder / "ros.csv")
        write_plot(measured, folder / "ros_latency.png")
    except OSError as problem:
        raise FileError(f"cannot write to {folder}: {problem.strerror}") from None
    print(f"\nwritten to {folder}: ros.md, ros.csv, ros_latency.png")
