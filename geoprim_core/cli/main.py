"""`geoprim`: the command line of the library. `geoprim COMMAND --help` tells the rest."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager, nullcontext
from importlib import import_module
from types import ModuleType
from typing import Any

from geoprim_core import __version__
from geoprim_core.cli.values import Parser, UsageError
from geoprim_core.errors import GeoprimError

# Command -> one line of help. Each is a module of this room with `add_arguments` and `run`; a
# command of two words is the module with "_" between them.
COMMANDS = {
    "detect": "find ellipses in image files; print a table or JSON, draw overlays",
    "process": "run every frame of a bag through the chain, in lockstep, into a new bag",
    "view": "watch a bag, images or a live graph in Foxglove, with the ellipses on them",
    "bag": "tell what a bag holds, check it for damage, repair it",
    "evaluate": "score an output bag or an image folder against its ground truth",
    "polygons": "approximate the edge contours of an image by polygons, draw them",
    "tangents": "estimate the tangents of the contours of an image; draw their normals",
    "explain": "show every step of a detection as a picture, and why hypotheses were refused",
    "bench": "measure the speed of the chain, stage by stage",
    "bench detectors": "compare detectors, ours and others: precision, recall, F and time",
    "bench ablation": "measure what each departure from the thesis is worth",
    "bench stability": "compare F of turned, mirrored, shifted and brightened images",
    "bench scaling": "measure how the time grows with the image and with the number of arcs",
    "bench ros": "measure the live ROS 2 graph: latency, drops, processor time, highest rate",
    "bench polygon": "time the polygon methods beside shapely and OpenCV",
    "bench tangents": "measure the nanoseconds a pixel of every tangent method",
    "bench fitting": "measure the speed of every ellipse fit, ours and others'",
    "calibrate": "check by simulation that scores are probabilities and that covariances hold",
    "reproduce polygon": "rerun the experiments of thesis chapter 2: tables, figures, claims",
    "reproduce tangent": "rerun the experiments of thesis chapter 3 with every tangent estimator",
    "reproduce fitting": "rerun the experiments of thesis 4.5: tables, figures, claims, chooser",
    "warm": "compile the numeric kernels ahead of time",
}


class ShortUsage(argparse.HelpFormatter):
    """Leaves the parameters of the chain, over a hundred, out of the first lines of a help text."""

    def add_usage(
        self,
        usage: str | None,
        actions: Iterable[argparse.Action],
        groups: Iterable[Any],
        prefix: str | None = None,
    ) -> None:
        """Add the usage without them."""
        short = [a for a in actions if not _is_parameter(a)]
        super().add_usage(usage, short, groups, prefix)


def _is_parameter(action: argparse.Action) -> bool:
    return any("." in word or word == "--polygon_method" for word in action.option_strings)


def build_parser(chosen: str | None = None) -> argparse.ArgumentParser:
    """Return the parser; only the chosen command's arguments are filled in."""
    parser = Parser(prog="geoprim", description=__doc__)
    parser.add_argument("--version", action="version", version=f"geoprim {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, text in COMMANDS.items():
        command = commands.add_parser(name, help=text, description=text, formatter_class=ShortUsage)
        if name == chosen:
            _module(name).add_arguments(command)
    return parser


def _module(command: str) -> ModuleType:
    return import_module("geoprim_core.cli." + command.replace(" ", "_"))


def _joined(words: list[str]) -> list[str]:
    """Return the words with a command of two words as one."""
    start = " ".join(words[:2])
    return [start, *words[2:]] if start in COMMANDS else words


def _telling_of_compiling(command: str) -> AbstractContextManager[None]:
    """Say at the first kernel that has to be compiled why it takes so long."""
    jit = sys.modules.get("geoprim_core._jit")
    if jit is None or command == "warm":  # which shows how far it is
        return nullcontext()
    where = jit.cache_base() or "nowhere: the cache folder cannot be written"
    text = f"geoprim: compiling kernels, a minute or two; they are kept in {where}"
    telling: AbstractContextManager[None] = jit.telling_of_compiling(
        lambda: print(text, file=sys.stderr, flush=True)
    )
    return telling


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; what the person has to mend is one line and exit code 2."""
    words = _joined(list(sys.argv[1:] if argv is None else argv))
    chosen = next((word for word in words if word in COMMANDS), None)
    try:
        arguments = build_parser(chosen).parse_args(words)
    except UsageError as problem:
        print(problem, file=sys.stderr)
        return 2
    command = _module(arguments.command)
    try:
        with _telling_of_compiling(arguments.command):
            return int(command.run(arguments))
    except GeoprimError as problem:
        print(f"geoprim {arguments.command}: {problem}", file=sys.stderr)
        return 2
    except BrokenPipeError:  # the reader of a pipe has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    raise SystemExit(main())
