"""Node `detector_node`: the whole chain in one callback, images in, all results out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from geoprim_msgs.msg import Contours as ContoursMessage
from geoprim_msgs.msg import Polygons as PolygonsMessage

from geoprim_core._check import AnyArray
from geoprim_core.ecc import DetectorParams, find_polygons
from geoprim_core.io.image_message import image_from_message
from geoprim_core.types import Contours
from geoprim_ros.chain import work_once
from geoprim_ros.conversions import core_message
from geoprim_ros.debug_images import EdgeDebug, EllipseDebug
from geoprim_ros.image_input import ImageInput
from geoprim_ros.results import ResultPublisher
from geoprim_ros.spin import run
from geoprim_ros.stage_node import StageNode


class ChainNode(StageNode):
    """The whole chain: it works from `connect` to `disconnect`."""

    def __init__(self, name: str, **options: Any) -> None:
        super().__init__(name, **options)
        self._params = self.live_params(DetectorParams())
        self._results = ResultPublisher(self)
        self._images = ImageInput(self)

    def connect(self) -> None:
        """Warm the kernels, advertise the results, read the images."""
        self.warm_up(lambda: work_once(self._params.value))
        self._contours = self.advertise(ContoursMessage, "contours")
        self._polygons = self.advertise(PolygonsMessage, "polygons")
        self._edge_debug, self._ellipse_debug = EdgeDebug(self), EllipseDebug(self)
        self._results.connect()
        self._images.connect(self._on_image)

    def paused(self) -> None:
        """Forget what waits for a camera_info."""
        self._results.clear()

    def _on_image(self, message: Any) -> None:
        params, image = self._params.value, image_from_message(message)
        contours = self._edge_debug.find_contours(image, params, message)
        if self.wanted(self._contours):
            self._contours.publish(core_message(contours, message))
        if self.wanted(self._polygons) or self._results.wanted() or self._ellipse_debug.wanted():
            self._go_on(image, contours, params, message)
        self.statistics.frames_out += 1

    def _go_on(
        self, image: AnyArray, contours: Contours, params: DetectorParams, message: Any
    ) -> None:
        polygons = find_polygons(contours, params)
        if self.wanted(self._polygons):
            method = params.polygon_method
            self._polygons.publish(
                core_message(polygons, message, contours=contours, method=method)
            )
        found = self._ellipse_debug.find_ellipses(contours, polygons, params, message, image)
        self._results.publish(found, message)


class DetectorNode(ChainNode):
    """Publishes what the three stage nodes publish, without messages in between.

    Contours and polygons are only made into messages while somebody listens.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__("detector_node", **options)
        self.connect()


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until a signal ends it."""
    return run(lambda: [DetectorNode()], args)


if __name__ == "__main__":
    raise SystemExit(main())
