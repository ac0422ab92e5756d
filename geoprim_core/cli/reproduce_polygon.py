"""`geoprim reproduce polygon`: the tables and figures of thesis chapter 2, rerun."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from tqdm import tqdm

from geoprim_core._check import AnyArray, FloatArray
from geoprim_core.cli.benchmark_images import write_files
from geoprim_core.cli.reproduce_polygon_figures import figures
from geoprim_core.cli.values import whole
from geoprim_core.errors import FileError
from geoprim_core.evaluation.claims import claim_text
from geoprim_core.evaluation.duality import check_duality, duality_rows, piece_rows
from geoprim_core.evaluation.reproduce_polygon import (
    Row,
    curve_rows,
    formula_rows,
    image_rows,
    noisy_rows,
    own_curves,
    scaled_rows,
)
from geoprim_core.evaluation.reproduce_polygon_claims import (
    check_bounds,
    check_claims,
    check_images,
)
from geoprim_core.evaluation.reproduce_polygon_report import Rerun, report_markdown, rows_csv
from geoprim_core.evaluation.thesis_tables import printed_rows
from geoprim_core.io.chain_codes import read_chain_codes, read_published_rows
from geoprim_core.io.images import SUFFIXES, read_image

_SCALED_SHOWN = 2  # curves that the experiments on scale and noise take


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "folder",
        nargs="?",
        type=Path,
        metavar="FOLDER",
        help="JSON chain codes and CSV of published rows in it, images in it and below, a set a "
        "subfolder; default: own silhouettes",
    )
    parser.add_argument(
        "--curves", type=whole(0), default=0, help="take so many curves at most; 0: all (0)"
    )
    parser.add_argument("--output", type=Path, metavar="DIR", help="write report, CSV and PNG")
    parser.add_argument("--quiet", action="store_true", help="show no progress bar")


def run(arguments: argparse.Namespace) -> int:
    """Print which claims are reproduced; with --output write the report, the rows and figures."""
    folder = arguments.folder
    if folder is not None and not folder.is_dir():
        raise FileError(f"{folder}: no such folder")
    curves, published = _inputs(folder)
    curves = dict(list(curves.items())[: arguments.curves or None])
    chosen = _of_the_thesis(curves)
    pictures = figures(curves, chosen)
    with tqdm(unit="row", file=sys.stderr, disable=True if arguments.quiet else None) as bar:
        rerun = _rerun(curves, chosen, published, _images(folder), bar.update, sorted(pictures))
    for claim in rerun.claims:
        print(claim_text(claim))
    if arguments.output is not None:
        files: dict[str, Callable[[Path], object]] = {
            "report.md": lambda path: path.write_text(report_markdown(rerun)),
            "rows.csv": lambda path: path.write_text(rows_csv(rerun.rows)),
        }
        write_files(arguments.output, {**files, **pictures})
    return 0


def _rerun(
    curves: dict[str, FloatArray],
    chosen: dict[str, FloatArray],
    published: list[dict[str, str]],
    images: Iterator[tuple[str, AnyArray]],
    after_each: Callable[[], object],
    names: list[str],
) -> Rerun:
    rows = []
    for row in _rows(curves, chosen):
        rows.append(row)
        after_each()
    sets = image_rows(images, after_each)
    pieces = piece_rows(curves)
    claims = check_duality(pieces) + check_bounds() + check_claims(rows) + check_images(sets)
    beside = [*published, *printed_rows()]
    claims.sort(key=lambda claim: claim.section)
    return Rerun(rows, claims, duality_rows(), pieces, sets, beside, names)


def _inputs(folder: Path | None) -> tuple[dict[str, FloatArray], list[dict[str, str]]]:
    """Return curves and published rows of a folder, or the project's own curves."""
    if folder is None:
        return own_curves(), []
    curves: dict[str, FloatArray] = {}
    for path in sorted(folder.glob("*.json")):
        try:
            curves.update(read_chain_codes(path))
        except FileError as problem:
            print(f"skipped {problem}", file=sys.stderr)
    if not curves and not any(path.suffix.lower() in SUFFIXES for path in folder.rglob("*")):
        raise FileError(f"{folder}: expected chain codes (*.json) or images, got neither")
    published = [row for path in sorted(folder.glob("*.csv")) for row in read_published_rows(path)]
    return curves or own_curves(), published


def _images(folder: Path | None) -> Iterator[tuple[str, AnyArray]]:
    """Yield the images of a folder and all below, each with the name of its set."""
    for path in sorted(folder.rglob("*")) if folder is not None else ():
        if path.suffix.lower() in SUFFIXES and path.is_file():
            try:
                image = read_image(path)
            except FileError as problem:
                print(f"skipped {problem}", file=sys.stderr)
                continue
            yield path.parent.name, image


def _of_the_thesis(curves: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Return the curves for scale and noise: the thesis' tin opener and Africa, or the first."""
    known = {n: c for n, c in curves.items() if n.lower().startswith(("tin", "africa"))}
    return known or dict(list(curves.items())[:_SCALED_SHOWN])


def _rows(curves: dict[str, FloatArray], chosen: dict[str, FloatArray]) -> Iterator[Row]:
    yield from curve_rows(curves)
    yield from scaled_rows(chosen)
    yield from noisy_rows(chosen)
    yield from formula_rows()
