"""Runs any of the stages in one process and one executor, without a launch file."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence

from geoprim_ros.nodes.detector_node import DetectorNode
from geoprim_ros.nodes.edges_node import EdgesNode
from geoprim_ros.nodes.ellipses_node import EllipsesNode
from geoprim_ros.nodes.overlay_node import OverlayNode
from geoprim_ros.nodes.polygons_node import PolygonsNode
from geoprim_ros.spin import run, split_ros_args
from geoprim_ros.stage_node import StageNode

STAGES: dict[str, Callable[[], StageNode]] = {
    "edges": EdgesNode,
    "polygons": PolygonsNode,
    "ellipses": EllipsesNode,
    "detector": DetectorNode,
    "overlay": OverlayNode,
}


def main(args: Sequence[str] | None = None) -> int:
    """Run the chosen stages until a signal ends them."""
    own, ros = split_ros_args(sys.argv[1:] if args is None else args)
    parser = argparse.ArgumentParser(
        prog="pipeline", description=__doc__, epilog="ROS arguments follow after --ros-args."
    )
    parser.add_argument(
        "--stages",
        nargs="+",
        choices=tuple(STAGES),
        default=["edges", "polygons", "ellipses"],
        help="the stages to run (default: edges polygons ellipses)",
    )
    chosen = parser.parse_args(own).stages
    # The last stage first: when the image has its reader, all kernels are warm and the results
    # have somewhere to go.
    order = [stage for stage in reversed(STAGES) if stage in chosen]
    return run(lambda: [STAGES[stage]() for stage in order], ros)


if __name__ == "__main__":
    raise SystemExit(main())
