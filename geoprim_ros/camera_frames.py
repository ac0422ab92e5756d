"""Frames and the camera_info of each, brought together for a stage that needs both."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from sensor_msgs.msg import CameraInfo

from geoprim_ros.cameras import CameraInfos, CameraParams
from geoprim_ros.stage_node import StageNode, sensor_qos

_CAMERA_DEPTH = 50


class CameraFrames:
    """Hands on what was found in frames together with their camera_info.

    Where the one with the stamp of a frame comes after it, the frame waits for it; where ten
    later frames wait too, or nobody publishes camera_info, it goes on with None and is counted.

    Parameters
    ----------
    node : the stage, which gets the parameter `camera_info_sync`
    work : called with what was found, the frame, and its camera_info or None
    """

    def __init__(self, node: StageNode, work: Callable[[Any, Any, Any], object]) -> None:
        self._node, self._work = node, work
        self._params = node.live_params(CameraParams())
        self._infos = CameraInfos()
        self._topic = node.resolve_topic_name("camera_info")

    def connect(self) -> None:
        """Read camera_info."""
        self._node.listen(
            CameraInfo, "camera_info", self._on_camera, sensor_qos(_CAMERA_DEPTH), frame=False
        )

    def add(self, found: Any, source: Any) -> None:
        """Hand on what was found in a frame, at once or when its camera_info comes."""
        exact = self._params.value.camera_info_sync == "exact"
        info = self._infos.exact(source) if exact else self._infos.latest()
        if info is not None or not exact:
            self._work(found, source, info)
            return
        self._infos.wait(source, found)
        comes = self._node.count_publishers(self._topic) > 0
        for late in self._infos.overdue() if comes else self._infos.overdue(0):
            self._node.statistics.without_camera += 1
            self._work(*late, None)

    def clear(self) -> None:
        """Let go of what waits for a camera_info."""
        self._infos.overdue(0)

    def hint(self) -> str:
        """Return what may help a frame that got no camera_info, for the end of a sentence."""
        if self._infos.latest() is None or self._params.value.camera_info_sync != "exact":
            return ""
        return " with the stamp of the image (camera_info_sync: latest would take any)"

    def _on_camera(self, info: Any) -> None:
        waited = self._infos.add(info)
        if waited is not None:
            self._work(*waited, info)
