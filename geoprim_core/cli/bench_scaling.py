"""`geoprim bench scaling`: the time of every stage against image size and number of arcs."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

from tqdm import tqdm

from geoprim_core.cli.benchmark_images import save, write_files
from geoprim_core.cli.detector import add_detector_arguments, detector_params
from geoprim_core.cli.values import whole
from geoprim_core.evaluation.scaling import (
    ARC_COUNTS,
    SIZES,
    Growth,
    growth_markdown,
    measure_arcs,
    measure_images,
    noise_image,
    strewn_arcs,
    tiled_image,
)
from geoprim_core.io.images import read_image
from geoprim_core.io.photographs import packaged_photographs
from geoprim_core.plotting import plot_growth

_CROWDED_SIDE = 2000.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "image",
        nargs="?",
        type=Path,
        metavar="IMAGE",
        help="the photograph that is mirrored on to every size (default: scikit-image's coins)",
    )
    parser.add_argument(
        "--max-width", type=whole(), default=SIZES[-1][0], help="widest image [px] (4096)"
    )
    parser.add_argument(
        "--max-arcs", type=whole(), default=ARC_COUNTS[-1], help="most arcs (20000)"
    )
    parser.add_argument(
        "--repeat", type=whole(), default=3, help="runs a size; the least counts (3)"
    )
    parser.add_argument("--output", type=Path, metavar="DIR", help="write Markdown and plots")
    parser.add_argument("--quiet", action="store_true", help="show no progress bar")
    add_detector_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the table with the fitted exponents; with --output write it and the plots."""
    photograph = packaged_photographs()["coins"]
    if arguments.image is not None:
        photograph = read_image(arguments.image)
    params = detector_params(arguments)
    sizes = [size for size in SIZES if size[0] <= arguments.max_width] or [SIZES[0]]
    counts = [count for count in ARC_COUNTS if count <= arguments.max_arcs] or [ARC_COUNTS[0]]
    hidden = True if arguments.quiet else None
    total = 2 * len(sizes) + 2 * len(counts)
    with tqdm(total=total, unit="size", file=sys.stderr, disable=hidden) as bar:
        by_size = partial(
            measure_images, params=params, sizes=sizes, repeat=arguments.repeat,
            after_size=bar.update,
        )  # fmt: skip
        by_arcs = partial(
            measure_arcs, params=params, counts=counts, repeat=arguments.repeat,
            after_size=bar.update,
        )  # fmt: skip
        growths = {
            "photograph": by_size("photograph", tiled_image(photograph)),
            "noise": by_size("noise", noise_image),
            "arcs": by_arcs("arcs, frame grows with them", strewn_arcs),
            "crowded_arcs": by_arcs(
                "arcs in 2000 x 2000 pixels", partial(strewn_arcs, side=_CROWDED_SIDE)
            ),
        }
    markdown = growth_markdown(growths.values())
    print(markdown, end="")
    if arguments.output is not None:
        write_files(arguments.output, _files(growths, markdown))
    return 0


def _files(growths: dict[str, Growth], markdown: str) -> dict[str, Callable[[Path], object]]:
    files: dict[str, Callable[[Path], object]] = {
        "scaling.md": lambda path: path.write_text(markdown)
    }
    for name, growth in growths.items():
        files[f"scaling_{name}.png"] = _writer(growth, by_edge_pixels=False)
        if growth.size_name == "pixels":
            files[f"scaling_{name}_edge_pixels.png"] = _writer(growth, by_edge_pixels=True)
    return files


def _writer(growth: Growth, *, by_edge_pixels: bool) -> Callable[[Path], object]:
    return lambda path: save(plot_growth(growth, by_edge_pixels=by_edge_pixels).figure, path)
