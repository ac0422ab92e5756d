"""Images together with what was found in them, for whoever shows both."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from geoprim_msgs.msg import Detections, EllipseDetections

from geoprim_ros.image_input import ImageInput
from geoprim_ros.pairing import StampPairs
from geoprim_ros.stage_node import StageNode, result_qos

# Results come later than their image, so the image waits for them.
_IMAGES_KEPT = 20


class FoundFrames:
    """The topics `image`, `ellipses` and `detections`, paired by their stamps.

    Parameters
    ----------
    node : the stage, which gets the parameter `image_transport`
    work : called with the arguments image, ellipses and detections, three messages of one stamp
    """

    def __init__(self, node: StageNode, work: Callable[..., object]) -> None:
        self._node, self._work = node, work
        self._pairs = StampPairs(("image", "ellipses", "detections"), _IMAGES_KEPT)
        self._images = ImageInput(node)

    def connect(self) -> None:
        """Read the results first: they are only sent where their reader is there."""
        for kind, topic in ((EllipseDetections, "ellipses"), (Detections, "detections")):
            self._node.listen(kind, topic, self._receiver(topic), result_qos(), frame=False)
        self._images.connect(self._receiver("image"), _IMAGES_KEPT)

    def clear(self) -> None:
        """Let go of the images that wait for their results."""
        self._pairs.clear()

    def _receiver(self, topic: str) -> Callable[[Any], None]:
        return lambda message: self._on(topic, message)

    def _on(self, topic: str, message: Any) -> None:
        pair = self._pairs.add(topic, message)
        self._node.statistics.unpaired = self._pairs.unpaired
        if pair is not None:
            self._work(**pair)
