"""Node `polygons_node`: edge contours in, polygonal approximations out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from geoprim_msgs.msg import Contours, Polygons

from geoprim_core.ecc import DetectorParams, find_polygons
from geoprim_core.io.wire import from_wire
from geoprim_core.warm import warm_scenes
from geoprim_ros.chain import find_contours
from geoprim_ros.conversions import core_message
from geoprim_ros.frames import Frames
from geoprim_ros.spin import run
from geoprim_ros.stage_node import StageNode, result_qos


class PolygonsNode(StageNode):
    """Approximates every contour by a polygon; the method is the parameter `polygon_method`."""

    def __init__(self, **options: Any) -> None:
        super().__init__("polygons_node", **options)
        self._params = self.live_params(DetectorParams(), wanted=lambda n: n.startswith("polygon"))
        self.warm_up(self._work_once)
        self._polygons = self.advertise(Polygons, "polygons")
        self._frames = Frames(self, ("contours",), self._approximate)
        receive = self._frames.receiver("contours")
        self.listen(Contours, "contours", receive, result_qos(), guarded=False)

    def paused(self) -> None:
        """Forget contours that wait."""
        self._frames.clear()

    def _work_once(self) -> None:
        params, (image, *_) = self._params.value, warm_scenes()
        find_polygons(find_contours(image, params), params)

    def _approximate(self, frame: dict[str, Any]) -> None:
        params, message = self._params.value, frame["contours"]
        contours: Any = from_wire(message)
        polygons = find_polygons(contours, params)
        method = params.polygon_method
        if self.wanted(self._polygons):
            self._polygons.publish(
                core_message(polygons, message, contours=contours, method=method)
            )
        self.statistics.frames_out += 1


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until a signal ends it."""
    return run(lambda: [PolygonsNode()], args)


if __name__ == "__main__":
    raise SystemExit(main())
