"""Node `detector_node`: the whole chain in one callback, images in, all results out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from geoprim_msgs.msg import Contours, Polygons
from sensor_msgs.msg import CameraInfo, Image

from geoprim_core.ecc import DetectorParams, find_polygons
from geoprim_core.io.image_message import image_from_message
from geoprim_ros.chain import find_contours, find_ellipses, warm_up_scene
from geoprim_ros.conversions import core_message
from geoprim_ros.results import ResultPublisher
from geoprim_ros.spin import run
from geoprim_ros.stage_node import StageNode, sensor_qos


class DetectorNode(StageNode):
    """Publishes what the three stage nodes publish, without messages in between.

    Contours and polygons are only made into messages while somebody listens.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__("detector_node", **options)
        self._params = self.live_params(DetectorParams())
        self.warm_up(self._work_once)
        self._results = ResultPublisher(self)
        self._contours = self.advertise(Contours, "contours")
        self._polygons = self.advertise(Polygons, "polygons")
        self.listen(
            CameraInfo, "camera_info", self._results.cameras.add, sensor_qos(10), frame=False
        )
        self.listen(Image, "image", self._on_image, sensor_qos())

    def _work_once(self) -> None:
        params = self._params.value
        contours = find_contours(warm_up_scene(), params)
        find_ellipses(contours, find_polygons(contours, params), params)

    def _on_image(self, message: Any) -> None:
        params = self._params.value
        contours = find_contours(image_from_message(message), params)
        if self._contours.get_subscription_count():
            self._contours.publish(core_message(contours, message))
        polygons = find_polygons(contours, params)
        if self._polygons.get_subscription_count():
            method = params.polygon_method
            self._polygons.publish(
                core_message(polygons, message, contours=contours, method=method)
            )
        self._results.publish(find_ellipses(contours, polygons, params), message)


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until a signal ends it."""
    return run(lambda: [DetectorNode()], args)


if __name__ == "__main__":
    raise SystemExit(main())
