"""Images in: raw or compressed, as the parameter `image_transport` says at the moment."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rclpy.node import Node
from sensor_msgs.msg import CompressedImage, Image

from geoprim_core.params import Params, option
from geoprim_ros.inputs import Source
from geoprim_ros.stage_node import StageNode, sensor_qos

COMPRESSED = "image/compressed"


@dataclass(frozen=True)
class ImageParams(Params):
    """Where the images come from."""

    image_transport: str = option(
        "raw", "read image, or image/compressed (JPEG, PNG)", choices=("raw", "compressed")
    )


class ImageInput:
    """The images of a stage, the frames that its statistics count.

    Parameters
    ----------
    node : the stage, which gets the parameter `image_transport`
    """

    def __init__(self, node: StageNode) -> None:
        self._node = node
        self._live = node.live_params(ImageParams())

    def connect(
        self, step: Callable[[Any], object], depth: int = 1, *, guarded: bool = True
    ) -> None:
        """Call `step` with every sensor_msgs/msg/Image or CompressedImage.

        So many as `depth` wait; with 1 a slow stage gets the newest and the others are dropped.
        """
        sources = {
            "raw": Source(Image, "image"),
            "compressed": Source(CompressedImage, compressed_topic(self._node)),
        }
        self._node.add_input(
            sources, self._chosen, step, sensor_qos(depth), name="image", guarded=guarded
        )

    def _chosen(self) -> str:
        return self._live.value.image_transport


def compressed_topic(node: Node) -> str:
    """Return the topic of compressed images: it follows a remapping of `image`.

    Cameras publish `NAME/compressed` beside `NAME`, so that `-r image:=NAME` is enough; a rule for
    `image/compressed` itself comes first.
    """
    own = str(node.resolve_topic_name(COMPRESSED))
    if own != node.resolve_topic_name(COMPRESSED, only_expand=True):
        return COMPRESSED
    return f"{node.resolve_topic_name('image')}/compressed"
