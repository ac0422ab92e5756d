"""Node `overlay_node`: images and the results on them in, pictures with the results drawn out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from geoprim_msgs.msg import Detections, EllipseDetections
from sensor_msgs.msg import Image

from geoprim_core.io.drawing import draw_overlay
from geoprim_core.io.image_message import image_from_message
from geoprim_core.io.wire import from_wire
from geoprim_core.params import Params, option
from geoprim_ros.conversions import image_to_message
from geoprim_ros.frames import Frames
from geoprim_ros.image_input import ImageInput
from geoprim_ros.spin import run
from geoprim_ros.stage_node import StageNode, result_qos

# Results come later than their image, so the image waits for them.
_IMAGES_KEPT = 20


@dataclass(frozen=True)
class OverlayParams(Params):
    """What the overlay shows."""

    show_ellipses: bool = option(True, "draw all ellipses")
    show_detections: bool = option(True, "draw the labelled objects")
    show_labels: bool = option(True, "write scores and labels")


class OverlayNode(StageNode):
    """Draws results on the image with the same stamp, as long as somebody looks at it."""

    def __init__(self, **options: Any) -> None:
        super().__init__("overlay_node", **options)
        self._params = self.live_params(OverlayParams())
        topics = ("image", "ellipses", "detections")
        self._frames = Frames(self, topics, lambda frame: self._draw(**frame), _IMAGES_KEPT)
        receiver = self._frames.receiver
        self._overlay = self.advertise(Image, "overlay")
        for kind, topic in ((EllipseDetections, "ellipses"), (Detections, "detections")):
            self.listen(kind, topic, receiver(topic), result_qos(), frame=False, guarded=False)
        ImageInput(self).connect(receiver("image"), _IMAGES_KEPT, guarded=False)

    def paused(self) -> None:
        """Let go of the images that wait for their results."""
        self._frames.clear()

    def _draw(self, image: Any, ellipses: Any, detections: Any) -> None:
        shown = self._params.value
        objects: Any = from_wire(detections) if shown.show_detections else None
        found: Any = from_wire(ellipses) if shown.show_ellipses else None
        picture = draw_overlay(
            image_from_message(image), ellipses=found, detections=objects, labels=shown.show_labels
        )
        self._overlay.publish(image_to_message(picture, image))
        self.statistics.frames_out += 1


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until a signal ends it."""
    return run(lambda: [OverlayNode()], args)


if __name__ == "__main__":
    raise SystemExit(main())
