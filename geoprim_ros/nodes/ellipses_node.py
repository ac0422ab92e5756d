"""Node `ellipses_node`: contours and their polygons in, ellipses and labelled objects out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from geoprim_msgs.msg import Contours, Polygons
from sensor_msgs.msg import CameraInfo

from geoprim_core.ecc import DetectorParams, find_polygons
from geoprim_core.io.wire import from_wire
from geoprim_ros.chain import find_contours, find_ellipses, warm_up_scene
from geoprim_ros.pairing import StampPairs
from geoprim_ros.results import ResultPublisher
from geoprim_ros.spin import run
from geoprim_ros.stage_node import StageNode, result_qos, sensor_qos


class EllipsesNode(StageNode):
    """Detects ellipses in contours and polygons with one stamp, and sorts them into classes."""

    def __init__(self, **options: Any) -> None:
        super().__init__("ellipses_node", **options)
        self._params = self.live_params(DetectorParams(), wanted=lambda n: n.startswith("ecc."))
        self._pairs = StampPairs(("contours", "polygons"))
        self.warm_up(self._work_once)
        self._results = ResultPublisher(self)
        self.listen(
            CameraInfo, "camera_info", self._results.cameras.add, sensor_qos(10), frame=False
        )
        self.listen(Contours, "contours", lambda m: self._on("contours", m), result_qos())
        self.listen(
            Polygons, "polygons", lambda m: self._on("polygons", m), result_qos(), frame=False
        )

    def _work_once(self) -> None:
        params = self._params.value
        contours = find_contours(warm_up_scene(), params)
        find_ellipses(contours, find_polygons(contours, params), params)

    def _on(self, topic: str, message: Any) -> None:
        pair = self._pairs.add(topic, message)
        self.statistics.unpaired = self._pairs.unpaired
        if pair is None:
            return
        contours: Any = from_wire(pair["contours"])
        polygons: Any = from_wire(pair["polygons"])
        found = find_ellipses(contours, polygons, self._params.value)
        self._results.publish(found, pair["contours"])


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until a signal ends it."""
    return run(lambda: [EllipsesNode()], args)


if __name__ == "__main__":
    raise SystemExit(main())
