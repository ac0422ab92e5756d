"""Images together with what was found in them, for whoever shows both."""

from __future__ import annotations

from collections.abc import Callable

from geoprim_msgs.msg import Detections, EllipseDetections

from geoprim_ros.frames import Frames
from geoprim_ros.image_input import ImageInput
from geoprim_ros.stage_node import StageNode, result_qos

# Results come later than their image, so the image waits for them.
_IMAGES_KEPT = 20


class FoundFrames:
    """The topics `image`, `ellipses` and `detections`, put together by their stamps.

    Parameters
    ----------
    node : the stage, which gets the parameters `image_transport` and `max_waiting`
    work : called with the arguments image, ellipses and detections, three messages of one stamp
    """

    def __init__(self, node: StageNode, work: Callable[..., object]) -> None:
        self._node = node
        topics = ("image", "ellipses", "detections")
        self._frames = Frames(node, topics, lambda frame: work(**frame), _IMAGES_KEPT)
        self._images = ImageInput(node)

    def connect(self) -> None:
        """Read the results first: they are only sent where their reader is there."""
        receiver = self._frames.receiver
        for kind, topic in ((EllipseDetections, "ellipses"), (Detections, "detections")):
            self._node.listen(
                kind, topic, receiver(topic), result_qos(), frame=False, guarded=False
            )
        self._images.connect(receiver("image"), _IMAGES_KEPT, guarded=False)

    def clear(self) -> None:
        """Let go of the images that wait for their results."""
        self._frames.clear()
