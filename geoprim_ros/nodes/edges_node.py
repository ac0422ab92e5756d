"""Node `edges_node`: images in, edge contours out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from geoprim_msgs.msg import Contours

from geoprim_core.ecc import DetectorParams
from geoprim_core.io.image_message import image_from_message
from geoprim_core.warm import warm_scenes
from geoprim_ros.chain import find_contours
from geoprim_ros.conversions import core_message
from geoprim_ros.debug_images import EdgeDebug
from geoprim_ros.image_input import ImageInput
from geoprim_ros.spin import run
from geoprim_ros.stage_node import StageNode


class EdgesNode(StageNode):
    """Turns every image into its edge contours; the parameters are those of `edges`."""

    def __init__(self, **options: Any) -> None:
        super().__init__("edges_node", **options)
        self._params = self.live_params(DetectorParams(), wanted=lambda n: n.startswith("edges."))
        self.warm_up(self._work_once)
        self._contours = self.advertise(Contours, "contours")
        self._debug = EdgeDebug(self)
        ImageInput(self).connect(self._on_image)

    def _work_once(self) -> None:
        for image in warm_scenes():
            find_contours(image, self._params.value)

    def _on_image(self, message: Any) -> None:
        image = image_from_message(message)
        contours = self._debug.find_contours(image, self._params.value, message)
        if self.wanted(self._contours):
            self._contours.publish(core_message(contours, message))
        self.statistics.frames_out += 1


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until a signal ends it."""
    return run(lambda: [EdgesNode()], args)


if __name__ == "__main__":
    raise SystemExit(main())
