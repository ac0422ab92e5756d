"""Node `view_node`: images and results in, a live view for Foxglove out, served by this process."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geoprim_msgs.msg import Contours, Polygons
from rclpy.qos import QoSProfile

from geoprim_core.io.foxglove_view import IMAGE_FORMATS, View, ViewFrame
from geoprim_core.io.image_message import image_from_message
from geoprim_core.io.record import stamp_of
from geoprim_core.io.shown import ViewParams, to_show
from geoprim_core.io.wire import from_wire
from geoprim_core.params import Params, option
from geoprim_ros.found_frames import FoundFrames
from geoprim_ros.pairing import StampPairs
from geoprim_ros.parameters import declare
from geoprim_ros.spin import run
from geoprim_ros.stage_node import StageNode, result_qos

_KEPT = 20


@dataclass(frozen=True)
class ServerParams(Params):
    """Where the view is served, fixed when the node starts."""

    host: str = option("127.0.0.1", "address to serve at; 0.0.0.0 for every viewer of the network")
    port: int = option(8765, "port to serve at; 0: a free one", low=0, high=65535)
    image_format: str = option("jpeg", "how images are sent", choices=IMAGE_FORMATS)
    contours: bool = option(False, "read and show contours and polygons too")


class ViewNode(StageNode):
    """Serves what the graph finds; it subscribes while a viewer is connected and looks.

    Parameters of the server are read-only: they are those of its start.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__("view_node", **options)
        defaults = ServerParams().to_dict()
        given = {
            o.name: declare(self, o.name, o, defaults[o.name], read_only=True)
            for o in ServerParams.options()
        }
        server = ServerParams.from_dict(given)
        self._params = self.live_params(ViewParams())
        self._frames = FoundFrames(self, self._show)
        self._curves = StampPairs(("contours", "polygons"), _KEPT)
        self._view = View(server.image_format)
        if server.contours:
            for kind, topic in ((Polygons, "polygons"), (Contours, "contours")):
                self.listen(kind, topic, self._curve_receiver(topic), result_qos(), frame=False)
        self.listen(
            DiagnosticArray, "/diagnostics", self._on_diagnostics, QoSProfile(depth=10), frame=False
        )
        self._frames.connect()
        self.port = self._view.serve(server.host, server.port)
        self.get_logger().info(f"ws://{server.host}:{self.port} for Foxglove")

    def is_active(self) -> bool:
        """Tell whether the inputs shall be open: while somebody looks, or always where not lazy."""
        view = getattr(self, "_view", None)  # the base asks before it is made
        lazy = self._stage_params.value.lazy
        return self.enabled and view is not None and (not lazy or view.watched())

    def paused(self) -> None:
        """Let go of what waits."""
        self._frames.clear()
        self._curves.clear()

    def close(self) -> None:
        """End the server."""
        self._view.close()

    def _curve_receiver(self, topic: str) -> Any:
        return lambda message: self._on_curves(topic, message)

    def _show(self, image: Any, ellipses: Any, detections: Any) -> None:
        self._view.style = style = self._params.value.overlay
        found: Any = from_wire(ellipses)
        objects: Any = from_wire(detections)
        picture, shown = image_from_message(image), to_show(found, objects, style)
        frame_id = str(image.header.frame_id)
        frame = ViewFrame(picture, shown, stamp_of(image), frame_id, reason=found.reason)
        self._view.show(frame)
        self.statistics.frames_out += 1

    def _on_curves(self, topic: str, message: Any) -> None:
        pair = self._curves.add(topic, message)
        if pair is not None:
            contours: Any = from_wire(pair["contours"])
            polygons: Any = from_wire(pair["polygons"])
            self._view.show_contours(contours, stamp_of(message))
            self._view.show_polygons(polygons, contours, stamp_of(message))

    def _on_diagnostics(self, message: Any) -> None:
        self._view.diagnose([_plain(status) for status in message.status], stamp_of(message))


def _plain(status: Any) -> dict[str, Any]:
    """Return a diagnostic_msgs/msg/DiagnosticStatus as plain data."""
    return {
        "level": int.from_bytes(status.level, "little"),
        "name": status.name,
        "message": status.message,
        "hardware_id": status.hardware_id,
        "values": [{"key": v.key, "value": v.value} for v in status.values],
    }


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until a signal ends it."""
    return run(lambda: [ViewNode()], args)


if __name__ == "__main__":
    raise SystemExit(main())
