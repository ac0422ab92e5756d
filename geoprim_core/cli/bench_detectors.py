"""`geoprim bench detectors`: our schemes and any other detector over the same images in one run."""

from __future__ import annotations

import argparse
from contextlib import ExitStack
from pathlib import Path

from geoprim_core.cli.benchmark_images import (
    BenchmarkImages,
    add_image_arguments,
    add_time_limit,
    comparison_files,
    truth_of_folders,
    write_files,
)
from geoprim_core.cli.overlays import write_overlays
from geoprim_core.cli.values import whole
from geoprim_core.ecc import TABLE
from geoprim_core.errors import InputError
from geoprim_core.evaluation.comparison import Comparison, compare_detectors
from geoprim_core.evaluation.comparison_tables import (
    comparison_markdown,
    summary_markdown,
    worst_markdown,
)
from geoprim_core.evaluation.peer_runner import CLOCKS
from geoprim_core.evaluation.peers import DetectorUnderTest, Peer, own_detectors

DEFAULT_SETS = ("thesis", "discs", "circles", "noise")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_image_arguments(parser)
    schemes = [row.name for row in TABLE]
    parser.add_argument(
        "--schemes", nargs="*", choices=schemes, default=["refined"], help="ours (refined)"
    )
    parser.add_argument(
        "--peer",
        action="append",
        default=[],
        metavar="NAME=MODULE:CALLABLE",
        help="another detector: takes an image (uint8, gray or BGR), returns rows x, y, "
        "semi_major, semi_minor, angle (radians)[, score]; also NAME=FILE.py:CALLABLE",
    )
    parser.add_argument(
        "--peer-python",
        action="append",
        default=[],
        metavar="[NAME=]PYTHON",
        help="the Python that runs a peer, or all of them; it needs numpy only (this one)",
    )
    add_time_limit(parser)
    parser.add_argument(
        "--repeat", type=whole(), default=3, help="runs an image; the least counts (3)"
    )
    parser.add_argument(
        "--clock",
        choices=list(CLOCKS),
        default="elapsed",
        help="time that passes (elapsed), or time on the processor, steadier on a busy machine",
    )
    parser.add_argument("--worst", type=whole(0), default=5, help="images listed as the worst (5)")
    parser.add_argument(
        "--output", type=Path, metavar="DIR", help="write the tables as Markdown and CSV, and plots"
    )
    parser.add_argument(
        "--overlays", type=Path, metavar="DIR", help="draw the worst images of every detector"
    )


def run(arguments: argparse.Namespace) -> int:
    """Print the table and each detector's worst images; with --output write files."""
    truth = truth_of_folders(arguments.folders)
    images = BenchmarkImages(arguments, truth, default_sets=DEFAULT_SETS)
    with ExitStack() as stack:
        detectors = _detectors(arguments, stack)
        peers = [detector.name for detector in detectors if isinstance(detector, Peer)]
        bar = stack.enter_context(images.bar())
        comparison = compare_detectors(
            detectors, images, repeat=arguments.repeat, after_image=bar.update,
            reference=peers[0] if peers else detectors[0].name,
        )  # fmt: skip
    markdown = report_markdown(comparison, arguments.worst)
    print(markdown, end="")
    if arguments.output is not None:
        write_files(arguments.output, comparison_files(comparison, markdown))
    if arguments.overlays is not None:
        write_overlays(arguments.overlays, comparison, images, arguments.worst)
    return 0


def report_markdown(comparison: Comparison, worst: int) -> str:
    """Return the tables, then the worst images of the first detector at its least overlap."""
    text = (
        "F of the images' mean (of the pooled counts), median ms, median time ratio to "
        f"{comparison.reference}:\n\n{summary_markdown(comparison)}\n"
        f"In full:\n\n{comparison_markdown(comparison)}"
    )
    own = comparison.of(comparison.detectors[0])
    for group in dict.fromkeys(m.truth.group for m in own) if worst > 0 else ():
        chosen = [m for m in own if m.truth.group == group]
        overlap = chosen[0].matchings[0][0]
        title = f"The worst of {group or 'images'}, {chosen[0].detector}, overlap {overlap:g}"
        text += f"\n{title}:\n\n{worst_markdown(chosen, overlap, worst)}"
    return text


def _detectors(arguments: argparse.Namespace, stack: ExitStack) -> list[DetectorUnderTest]:
    detectors: list[DetectorUnderTest] = [*own_detectors(arguments.schemes, arguments.clock)]
    pythons = _pythons(arguments.peer_python)
    for given in arguments.peer:
        name, equals, target = given.partition("=")
        if not (name and equals and ":" in target):
            raise InputError("--peer", "NAME=MODULE:CALLABLE", repr(given))
        python = pythons.get(name, pythons.get(""))
        limit, clock = arguments.time_limit, arguments.clock
        peer = Peer(name, target, python=python, time_limit=limit, clock=clock)
        stack.callback(peer.close)
        detectors.append(peer)
    if not detectors:
        raise InputError("--schemes, --peer", "at least one detector", "none")
    return detectors


def _pythons(given: list[str]) -> dict[str, str]:
    """Return peer -> Python; the empty name stands for all others."""
    pairs = (text.rpartition("=") for text in given)
    return {name: python for name, _, python in pairs}
