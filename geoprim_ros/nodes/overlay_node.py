"""Node `overlay_node`: images and the results on them in, pictures with the results drawn out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sensor_msgs.msg import Image

from geoprim_core.io.drawing import draw_overlay
from geoprim_core.io.image_message import image_from_message
from geoprim_core.io.shown import ViewParams
from geoprim_core.io.wire import from_wire
from geoprim_ros.conversions import image_to_message
from geoprim_ros.found_frames import FoundFrames
from geoprim_ros.spin import run
from geoprim_ros.stage_node import StageNode


class OverlayNode(StageNode):
    """Draws results on the image with the same stamp, as long as somebody looks at it."""

    def __init__(self, **options: Any) -> None:
        super().__init__("overlay_node", **options)
        self._params = self.live_params(ViewParams())
        self._frames = FoundFrames(self, self._draw)
        self._overlay = self.advertise(Image, "overlay")
        self._frames.connect()

    def paused(self) -> None:
        """Let go of the images that wait for their results."""
        self._frames.clear()

    def _draw(self, image: Any, ellipses: Any, detections: Any) -> None:
        found: Any = from_wire(ellipses)
        objects: Any = from_wire(detections)
        picture = draw_overlay(
            image_from_message(image), ellipses=found, detections=objects,
            params=self._params.value.overlay,
        )  # fmt: skip
        self._overlay.publish(image_to_message(picture, image))
        self.statistics.frames_out += 1


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until a signal ends it."""
    return run(lambda: [OverlayNode()], args)


if __name__ == "__main__":
    raise SystemExit(main())
