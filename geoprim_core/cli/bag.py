"""`geoprim bag`: what a bag holds, what it has lost, and a whole one from the rest."""

from __future__ import annotations

import argparse
from pathlib import Path

from geoprim_core.io.bag_check import inspect_bag
from geoprim_core.io.bag_repair import repair_bag

_CODES = "Exit code 0: the bag is whole; 1: parts of it are lost; 2: nothing of it can be used."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.epilog = _CODES
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    for name, text in (
        ("info", "topics, types, counts, times; what is lost as far as seen at once"),
        ("check", "read, prove and decode every message; say what is lost, where and when"),
    ):
        action = actions.add_parser(name, help=text, description=text, epilog=_CODES)
        action.add_argument("bag", type=Path, metavar="BAG", help="an .mcap file or a folder")
    text = "write a whole bag with everything that is still readable"
    repair = actions.add_parser("repair", help=text, description=text, epilog=_CODES)
    repair.add_argument("bag", type=Path, metavar="IN", help="an .mcap file or a folder")
    repair.add_argument(
        "output", type=Path, nargs="?", metavar="OUT", help="default IN_repaired.mcap beside IN"
    )
    repair.add_argument(
        "--keep-doubtful", action="store_true", help="also write messages whose checksum fails"
    )
    repair.add_argument("--replace", action="store_true", help="replace OUT where it exists")


def run(arguments: argparse.Namespace) -> int:
    """Inspect or repair; exit code 1 where parts of the bag are lost, 2 where all of it is."""
    if arguments.action == "repair":
        report = repair_bag(
            arguments.bag, arguments.output,
            keep_doubtful=arguments.keep_doubtful, replace=arguments.replace,
        )  # fmt: skip
        print(report)
        return 1 if report.losses or report.faults else 0
    inspected = inspect_bag(arguments.bag, thorough=arguments.action == "check")
    print(inspected)
    return inspected.exit_code
