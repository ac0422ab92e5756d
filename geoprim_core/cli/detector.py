"""What `detect`, `process`, `evaluate` and `bench` share: the detector's parameters."""

from __future__ import annotations

import argparse

from geoprim_core.cli.options import add_params, given_params
from geoprim_core.ecc import TABLE, DetectorParams
from geoprim_core.io.shown import OverlayParams, ViewParams

IMAGE = "a PNG, JPEG, TIFF, ... file; its pixels as stored, an EXIF turn is not carried out"


def add_detector_arguments(parser: argparse.ArgumentParser) -> None:
    """Add `--scheme` and every parameter of the chain."""
    parser.add_argument(
        "--scheme",
        choices=[row.name for row in TABLE],
        help="a scheme of the ECC detector with its own settings of every stage "
        f"(default {DetectorParams().ecc.scheme})",
    )
    add_params(parser, DetectorParams, "parameters")


def detector_params(
    arguments: argparse.Namespace, base: DetectorParams | None = None
) -> DetectorParams:
    """Return the parameters: of the base or of the scheme named, then what was given one by one."""
    params = base or DetectorParams()
    if arguments.scheme is not None:
        params = DetectorParams.for_scheme(arguments.scheme)
    return params.updated(given_params(arguments, DetectorParams))


def add_overlay_arguments(parser: argparse.ArgumentParser) -> None:
    """Add every parameter of what is drawn."""
    add_params(parser, ViewParams, "what is drawn")


def overlay_params(
    arguments: argparse.Namespace, base: OverlayParams | None = None
) -> OverlayParams:
    """Return what shall be drawn: that of the base, then what was given one by one."""
    params = ViewParams(base or OverlayParams())
    return params.updated(given_params(arguments, ViewParams)).overlay
