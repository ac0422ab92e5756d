"""Node `ellipses_node`: contours and their polygons in, ellipses and labelled objects out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from geoprim_msgs.msg import Contours, Polygons

from geoprim_core.ecc import DetectorParams
from geoprim_core.io.wire import from_wire
from geoprim_ros.chain import work_once
from geoprim_ros.debug_images import EllipseDebug
from geoprim_ros.frames import Frames
from geoprim_ros.results import ResultPublisher
from geoprim_ros.spin import run
from geoprim_ros.stage_node import StageNode, result_qos


class EllipsesNode(StageNode):
    """Detects ellipses in contours and polygons with one stamp, and sorts them into classes."""

    def __init__(self, **options: Any) -> None:
        super().__init__("ellipses_node", **options)
        self._params = self.live_params(DetectorParams(), wanted=lambda n: n.startswith("ecc."))
        self._frames = Frames(self, ("contours", "polygons"), self._detect)
        self._results = ResultPublisher(self)
        self.warm_up(lambda: work_once(self._params.value))
        self._debug = EllipseDebug(self)
        self._results.connect()
        # The polygons first: contours are only sent when their reader is there.
        for kind, topic in ((Polygons, "polygons"), (Contours, "contours")):
            self.listen(
                kind, topic, self._frames.receiver(topic), result_qos(),
                frame=topic == "contours", guarded=False,
            )  # fmt: skip

    def paused(self) -> None:
        """Forget what waits."""
        self._frames.clear()
        self._results.clear()

    def _detect(self, frame: dict[str, Any]) -> None:
        contours: Any = from_wire(frame["contours"])
        polygons: Any = from_wire(frame["polygons"])
        source = frame["contours"]
        found = self._debug.find_ellipses(contours, polygons, self._params.value, source)
        self.statistics.frames_out += 1
        self._results.publish(found, source)


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until a signal ends it."""
    return run(lambda: [EllipsesNode()], args)


if __name__ == "__main__":
    raise SystemExit(main())
