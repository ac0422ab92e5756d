"""Node `markers_node`: ellipses in, visualization_msgs for RViz and Foxglove out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from geoprim_msgs.msg import Detections, EllipseDetections
from visualization_msgs.msg import ImageMarker, MarkerArray

from geoprim_core.io.marker_message import MarkersParams, image_marker, marker_array
from geoprim_core.io.shown import Shown, ViewParams, to_show
from geoprim_core.io.wire import from_wire
from geoprim_ros.camera_frames import CameraFrames
from geoprim_ros.conversions import to_message
from geoprim_ros.pairing import StampPairs
from geoprim_ros.spin import run
from geoprim_ros.stage_node import StageNode, result_qos

_KEPT = 20


class MarkersNode(StageNode):
    """Shows ellipses on the working plane and on the image, as long as somebody looks at them.

    On the plane they need `plane_distance` and the camera_info of the frame; without, no marker
    goes out, and /diagnostics has the reason.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__("markers_node", **options)
        self._style = self.live_params(ViewParams())
        self._params = self.live_params(MarkersParams())
        self._cameras = CameraFrames(self, self._publish_markers)
        self._pairs = StampPairs(("ellipses", "detections"), _KEPT)
        self._markers = self.advertise(MarkerArray, "markers")
        self._image_markers = self.advertise(ImageMarker, "image_markers")
        self._cameras.connect()
        self.listen(Detections, "detections", self._on_detections, result_qos(), frame=False)
        self.listen(EllipseDetections, "ellipses", self._on_ellipses, result_qos())

    def paused(self) -> None:
        """Let go of what waits."""
        self._pairs.clear()
        self._cameras.clear()

    def _on_ellipses(self, message: Any) -> None:
        self._show(self._pairs.add("ellipses", message))

    def _on_detections(self, message: Any) -> None:
        self._show(self._pairs.add("detections", message))

    def _show(self, pair: dict[str, Any] | None) -> None:
        self.statistics.unpaired = self._pairs.unpaired
        if pair is None:
            return
        ellipses, objects = (from_wire(pair[name]) for name in ("ellipses", "detections"))
        source = pair["ellipses"]
        shown = to_show(ellipses, objects, self._style.value.overlay)  # type: ignore[arg-type]
        if self.wanted(self._image_markers):
            marker = image_marker(shown, source.header, self._style.value.overlay)
            self._image_markers.publish(to_message(marker))
        if self.wanted(self._markers) and self._params.value.plane_distance > 0:
            self._cameras.add(shown, source)
            return
        self.statistics.frames_out += 1
        if self.wanted(self._markers):
            self.reject("no markers: plane_distance is 0, the distance of the plane is not known")

    def _publish_markers(self, shown: Shown, source: Any, info: Any) -> None:
        if info is None:
            self.reject(f"no markers: no camera_info came{self._cameras.hint()}")
            return
        params, style = self._params.value, self._style.value.overlay
        array, beyond = marker_array(
            shown, source.header, info, params.plane_distance, params=params.markers, style=style
        )
        self._markers.publish(to_message(array))
        self.statistics.frames_out += 1
        if beyond:
            self.note_cut_short(f"{beyond} ellipses reach beyond what the lens model describes")


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until a signal ends it."""
    return run(lambda: [MarkersNode()], args)


if __name__ == "__main__":
    raise SystemExit(main())
