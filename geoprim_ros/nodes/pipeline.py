"""Runs any of the stages in one process and one executor, without a launch file."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from geoprim_ros.nodes.detector_node import DetectorNode
from geoprim_ros.nodes.edges_node import EdgesNode
from geoprim_ros.nodes.ellipses_node import EllipsesNode
from geoprim_ros.nodes.lifecycle_detector import LifecycleDetector
from geoprim_ros.nodes.markers_node import MarkersNode
from geoprim_ros.nodes.overlay_node import OverlayNode
from geoprim_ros.nodes.polygons_node import PolygonsNode
from geoprim_ros.spin import run, split_ros_args
from geoprim_ros.stage_node import StageNode

STAGES: dict[str, Callable[..., StageNode]] = {
    "edges": EdgesNode,
    "polygons": PolygonsNode,
    "ellipses": EllipsesNode,
    "detector": DetectorNode,
    "lifecycle_detector": LifecycleDetector,
    "overlay": OverlayNode,
    "markers": MarkersNode,
}


class Chosen(NamedTuple):
    """A stage to run and the namespace that it runs in; "" for that of the process."""

    stage: str
    namespace: str = ""


def chosen(text: str) -> Chosen:
    """Return the stage that STAGE or STAGE:NAMESPACE names.

    Raises
    ------
    ValueError
        There is no such stage, or the namespace cannot be one.

    Examples
    --------
    >>> chosen("edges:left")
    Chosen(stage='edges', namespace='left')
    """
    stage, _, namespace = text.partition(":")
    if stage not in STAGES:
        raise ValueError(f"expected one of {', '.join(STAGES)}, got {stage!r}")
    if not re.fullmatch(r"(/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*)?", namespace, re.ASCII):
        raise ValueError(f"{namespace!r} cannot be a namespace")
    return Chosen(stage, namespace)


def make(stage: Chosen, ros: Sequence[str], **options: Any) -> StageNode:
    """Make the node of a stage; a relative namespace lies in that of the process.

    Parameters
    ----------
    stage : the stage and its namespace
    ros : the ROS arguments of the process
    """
    if not stage.namespace:
        return STAGES[stage.stage](**options)
    outer = [w.partition(":=")[2] for w in ros if w.startswith("__ns:=")] or ["/"]
    space = stage.namespace
    if not space.startswith("/"):
        space = f"{outer[-1].rstrip('/')}/{space}"
    # As an argument of the node's own: one of the process would be put in its place.
    return STAGES[stage.stage](cli_args=["--ros-args", "-r", f"__ns:={space}"], **options)


def in_order(stages: Sequence[Chosen]) -> list[Chosen]:
    """Return the stages, the last of the chain first.

    When the image has its reader, all kernels are warm and the results have somewhere to go.
    """
    names = list(STAGES)
    return sorted(stages, key=lambda s: -names.index(s.stage))


def main(args: Sequence[str] | None = None) -> int:
    """Run the chosen stages until a signal ends them."""
    own, ros = split_ros_args(sys.argv[1:] if args is None else args)
    parser = argparse.ArgumentParser(
        prog="pipeline", description=__doc__, epilog="ROS arguments follow after --ros-args."
    )
    parser.add_argument(
        "--stages",
        nargs="+",
        type=_stage,
        metavar="STAGE[:NAMESPACE]",
        default=[Chosen("edges"), Chosen("polygons"), Chosen("ellipses")],
        help=f"of {', '.join(STAGES)} (default: edges polygons ellipses), each in a namespace "
        "where one is given",
    )
    stages = parser.parse_args(own).stages
    twice = sorted({s.stage for s in stages if stages.count(s) > 1})
    if twice:
        parser.error(f"{', '.join(twice)} twice in one namespace")
    return run(lambda: [make(stage, ros) for stage in in_order(stages)], ros)


def _stage(text: str) -> Chosen:
    try:
        return chosen(text)
    except ValueError as problem:
        raise argparse.ArgumentTypeError(str(problem)) from None


if __name__ == "__main__":
    raise SystemExit(main())
