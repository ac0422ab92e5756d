"""`geoprim bench ros`: the live graph in its variants, image published to ellipses received."""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path

from geoprim_core.cli.values import positive
from geoprim_core.errors import FileError, GeoprimError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "--graphs", nargs="+", metavar="NAME",
        default=["separate", "composed", "one callback", "empty"],
        help="separate (a process a node), composed (one process), 'one callback' (detector_node), "
        "empty (a node that only reads: the middleware alone); default: all",
    )  # fmt: skip
    parser.add_argument(
        "--sizes", nargs="+", metavar="SIZE", default=["640x480", "1920x1080"],
        help="640x480, 1920x1080 (default: both)",
    )  # fmt: skip
    parser.add_argument("--seconds", type=positive, default=6.0, help="length of a run [s] (6)")
    parser.add_argument("--config", type=Path, metavar="FILE", help="parameters of the graph")
    parser.add_argument(
        "--own-profile-only", action="store_true", help="do not measure the stock Fast DDS profile"
    )
    parser.add_argument("--raw-only", action="store_true", help="do not measure JPEG images")
    parser.add_argument(
        "--no-search", action="store_true", help="do not look for the highest rate without a drop"
    )
    parser.add_argument(
        "--output", type=Path, metavar="DIR", help="write Markdown, CSV and a picture"
    )
    parser.add_argument("--quiet", action="store_true", help="show no progress bar")


def run(arguments: argparse.Namespace) -> int:
    """Measure, where ROS 2 is installed."""
    config = arguments.config
    if config is not None and not config.is_file():
        raise FileError(f"--config: expected a file with parameters of nodes, got {config}")
    try:
        for needed in ("rclpy", "geoprim_msgs.msg"):
            import_module(needed)
    except ImportError as problem:
        raise GeoprimError(
            f"it needs ROS 2 and geoprim's messages, and here {problem}; ./run setup installs both"
        ) from None
    command = import_module("geoprim_ros.bench.command")
    return int(command.run(arguments))
