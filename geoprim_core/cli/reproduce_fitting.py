"""`geoprim reproduce fitting`: the tables and figures of thesis 4.5, rerun."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from tqdm import tqdm

from geoprim_core.cli.benchmark_images import save, write_files
from geoprim_core.cli.values import whole
from geoprim_core.errors import InputError
from geoprim_core.evaluation.reproduce_fitting import (
    SECTIONS,
    own_fits,
    run_experiments,
    thesis_settings,
)
from geoprim_core.evaluation.reproduce_fitting_claims import check_claims
from geoprim_core.evaluation.reproduce_fitting_outcomes import Outcomes
from geoprim_core.evaluation.reproduce_fitting_report import (
    chooser_lines,
    report_markdown,
    rows_csv,
)
from geoprim_core.io.peer_fits import peer_fits
from geoprim_core.plotting.fitting import plot_experiment


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "--count", type=whole(), default=1000, help="trials a setting; a tenth of it images (1000)"
    )
    parser.add_argument("--seed", type=whole(0), default=0, help="seed of the random curves (0)")
    parser.add_argument(
        "--sections",
        nargs="+",
        metavar="SECTION",
        default=list(SECTIONS),
        help="experiments, by the start of their name (all): " + ", ".join(SECTIONS),
    )
    parser.add_argument("--methods", nargs="+", metavar="METHOD", help="of ours and peers (all)")
    parser.add_argument(
        "--processes",
        type=whole(),
        default=os.cpu_count() or 1,
        help="so many at a time (all processors)",
    )
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="write report, CSV, PNG")
    parser.add_argument("--quiet", action="store_true", help="show no progress bar")


def run(arguments: argparse.Namespace) -> int:
    """Print claims and chooser; with --output write the report, the rows and the figures."""
    own, peers = own_fits(), peer_fits()
    fits = {**own, **peers}
    if arguments.methods:
        unknown = sorted(set(arguments.methods) - set(fits))
        if unknown:
            raise InputError("methods", "some of " + ", ".join(fits), ", ".join(unknown))
        fits = {name: fit for name, fit in fits.items() if name in arguments.methods}
    starts = tuple(arguments.sections)
    settings = [setting for setting in thesis_settings() if setting.section.startswith(starts)]
    if not settings:
        raise InputError("sections", "some of " + ", ".join(SECTIONS), ", ".join(starts))
    work = run_experiments(settings, fits, arguments.count, arguments.seed, arguments.processes)
    hidden = True if arguments.quiet else None
    bar = tqdm(work, total=len(settings), unit="setting", file=sys.stderr, disable=hidden)
    outcomes = Outcomes(outcome for found in bar for outcome in found)
    _show(
        outcomes, arguments.output, [m for m in fits if m in own], [m for m in fits if m in peers]
    )
    return 0


def _show(
    outcomes: Outcomes, output: Path | None, own: Sequence[str], peers: Sequence[str]
) -> None:
    claims = check_claims(outcomes)
    for claim in claims:
        print(f"{claim.section:15} {claim.verdict:15} {claim.text}: {claim.figures}")
    chooser = "\n".join(chooser_lines(outcomes, own))
    print("\n" + chooser)
    if output is None:
        return
    report = report_markdown(outcomes, claims, own, peers)
    files: dict[str, Callable[[Path], object]] = {
        "report.md": lambda path: path.write_text(report),
        "chooser.md": lambda path: path.write_text(chooser),
        "rows.csv": lambda path: path.write_text(rows_csv(outcomes.all)),
    }
    for section in outcomes.sections():
        files[f"{section.replace(' ', '_')}.png"] = partial(_plot, outcomes, section, peers)
    write_files(output, files)


def _plot(outcomes: Outcomes, section: str, peers: Sequence[str], path: Path) -> None:
    save(plot_experiment(outcomes, section, peers), path)
