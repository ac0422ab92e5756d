"""`geoprim reproduce polygon`: the tables and figures of thesis chapter 2, rerun."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from tqdm import tqdm

from geoprim_core._check import AnyArray, FloatArray
from geoprim_core.cli.benchmark_images import save, write_files
from geoprim_core.errors import FileError
from geoprim_core.evaluation.claims import claim_text
from geoprim_core.evaluation.reproduce_polygon import (
    PROPOSED,
    VARIANTS,
    Row,
    available,
    curve_rows,
    duality_rows,
    formula_rows,
    image_rows,
    noisy_rows,
    own_curves,
    scaled_rows,
)
from geoprim_core.evaluation.reproduce_polygon_claims import check_claims
from geoprim_core.evaluation.reproduce_polygon_report import report_markdown, rows_csv
from geoprim_core.io.chain_codes import read_chain_codes, read_published_rows
from geoprim_core.io.images import list_images, read_image
from geoprim_core.plotting.polygons import plot_polygons

_SCALED_SHOWN = 2  # curves that the experiments on scale and noise take


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "folder",
        nargs="?",
        type=Path,
        metavar="FOLDER",
        help="JSON chain codes, CSV of published rows, images; default: own silhouettes",
    )
    parser.add_argument("--curves", type=int, default=0, help="take so many curves at most (all)")
    parser.add_argument("--output", type=Path, metavar="DIR", help="write report, CSV and PNG")
    parser.add_argument("--quiet", action="store_true", help="show no progress bar")


def run(arguments: argparse.Namespace) -> int:
    """Print which claims are reproduced; with --output write the report, the rows and figures."""
    folder = arguments.folder
    curves, published, images = _inputs(folder)
    curves = dict(list(curves.items())[: arguments.curves or None])
    chosen = _of_the_thesis(curves)
    rows: list[Row] = []
    with tqdm(unit="row", file=sys.stderr, disable=True if arguments.quiet else None) as bar:
        for row in _rows(curves, chosen):
            rows.append(row)
            bar.update()
        sets = image_rows(images, bar.update)
    claims = check_claims(rows)
    report = report_markdown(rows, claims, duality_rows(), sets, published)
    for claim in claims:
        print(claim_text(claim))
    missing = sorted({v.method for v in VARIANTS} - {v.method for v in available()})
    if missing:
        print("methods that this version lacks: " + ", ".join(missing))
    if arguments.output is not None:
        write_files(arguments.output, _files(curves, report, rows))
    return 0


def _inputs(
    folder: Path | None,
) -> tuple[dict[str, FloatArray], list[dict[str, str]], dict[str, AnyArray]]:
    """Return curves, published rows and images of a folder, or the project's own curves."""
    if folder is None:
        return own_curves(), [], {}
    if not folder.is_dir():
        raise FileError(f"{folder}: no such folder")
    curves: dict[str, FloatArray] = {}
    for path in sorted(folder.glob("*.json")):
        try:
            curves.update(read_chain_codes(path))
        except FileError as problem:
            print(f"skipped {problem}", file=sys.stderr)
    published = [row for path in sorted(folder.glob("*.csv")) for row in read_published_rows(path)]
    images = {path.name: read_image(path) for path in list_images(folder)}
    return curves or own_curves(), published, images


def _of_the_thesis(curves: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Return the curves for scale and noise: the thesis' tin opener and Africa, or the first."""
    known = {n: c for n, c in curves.items() if n.lower().startswith(("tin", "africa"))}
    return known or dict(list(curves.items())[:_SCALED_SHOWN])


def _rows(curves: dict[str, FloatArray], chosen: dict[str, FloatArray]) -> Iterator[Row]:
    yield from curve_rows(curves)
    yield from scaled_rows(chosen)
    yield from noisy_rows(chosen)
    yield from formula_rows()


def _files(
    curves: dict[str, FloatArray], report: str, rows: list[Row]
) -> dict[str, Callable[[Path], object]]:
    files: dict[str, Callable[[Path], object]] = {
        "report.md": lambda path: path.write_text(report),
        "rows.csv": lambda path: path.write_text(rows_csv(rows)),
    }
    for variant in available(("PRO(0.4)", "RDP(1.0)", *PROPOSED)):
        panels = [
            (f"{name}: N = {len(found)}", curve, found)
            for name, curve in curves.items()
            for found in (variant.polygon(curve, closed=True),)
        ]
        stem = "".join(c if c.isalnum() else "_" for c in variant.label.lower()).strip("_")
        files[f"polygons_{stem}.png"] = lambda path, panels=panels: save(  # type: ignore[misc]
            plot_polygons(panels), path
        )
    return files
