"""A node that answers every image with no ellipses: what the middleware alone takes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from geoprim_msgs.msg import EllipseDetections

from geoprim_ros.image_input import ImageInput
from geoprim_ros.spin import run
from geoprim_ros.stage_node import StageNode


class EmptyReader(StageNode):
    """Reads images as the stages do and looks at nothing but their header."""

    def __init__(self, **options: Any) -> None:
        super().__init__("empty_reader", **options)
        self._ellipses = self.advertise(EllipseDetections, "ellipses")
        ImageInput(self).connect(self._on_image)

    def _on_image(self, message: Any) -> None:
        self._ellipses.publish(EllipseDetections(header=message.header))
        self.statistics.frames_out += 1


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until a signal ends it."""
    return run(lambda: [EmptyReader()], args)


if __name__ == "__main__":
    raise SystemExit(main())
