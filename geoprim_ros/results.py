"""Publishing ellipses and the objects that they are sorted into."""

from __future__ import annotations

from typing import Any

from geoprim_msgs.msg import Detections as DetectionsMessage
from geoprim_msgs.msg import EllipseDetections as EllipsesMessage
from sensor_msgs.msg import CameraInfo

from geoprim_core.applications.sorting import classify
from geoprim_core.errors import InputError
from geoprim_core.types import EllipseDetections
from geoprim_ros.cameras import CameraInfos, CameraParams
from geoprim_ros.conversions import core_message
from geoprim_ros.sorting import LiveSorting
from geoprim_ros.stage_node import StageNode, sensor_qos

_CAMERA_DEPTH = 50


class ResultPublisher:
    """The topics `ellipses`, `detections` and `camera_info` of a node, and its parameters.

    Sizes in metres need the camera_info with the stamp of the frame. Where it comes after the
    frame, the detections wait for it; where ten later frames wait too, they go out without.
    """

    def __init__(self, node: StageNode) -> None:
        self._node = node
        self._sorting = node.follow_with(LiveSorting(node))
        self._camera_params = node.live_params(CameraParams())
        self._cameras = CameraInfos()
        self._topic = node.resolve_topic_name("camera_info")

    def connect(self) -> None:
        """Advertise the results and read camera_info."""
        self._ellipses = self._node.advertise(EllipsesMessage, "ellipses")
        self._detections = self._node.advertise(DetectionsMessage, "detections")
        self._node.listen(
            CameraInfo, "camera_info", self._on_camera, sensor_qos(_CAMERA_DEPTH), frame=False
        )

    def wanted(self) -> bool:
        """Tell whether somebody listens to ellipses or detections."""
        return self._node.wanted(self._ellipses) or self._node.wanted(self._detections)

    def publish(self, found: EllipseDetections, source: Any) -> None:
        """Publish what was found with the header of its source.

        A result that a bound on the work cut short goes out too, is counted and told. Where the
        objects cannot be sorted, the ellipses go out all the same, the detections are empty and
        the reason is counted and told.
        """
        if not found.complete:
            self._node.note_cut_short(found.reason)
        if self._node.wanted(self._ellipses):
            self._ellipses.publish(core_message(found, source))
        if not self._node.wanted(self._detections):
            return
        if self._sorting.value.plane_distance <= 0:
            self._publish_objects(found, source, None)
        elif self._camera_params.value.camera_info_sync == "latest":
            self._publish_objects(found, source, self._cameras.latest())
        else:
            self._publish_with_camera(found, source)

    def clear(self) -> None:
        """Let go of what waits for a camera_info."""
        self._cameras.overdue(0)

    def _publish_with_camera(self, found: EllipseDetections, source: Any) -> None:
        info = self._cameras.exact(source)
        if info is not None:
            self._publish_objects(found, source, info)
            return
        self._cameras.wait(source, found)
        comes = self._node.count_publishers(self._topic) > 0
        for late in self._cameras.overdue() if comes else self._cameras.overdue(0):
            self._node.statistics.without_camera += 1
            self._publish_objects(*late, None)

    def _on_camera(self, info: Any) -> None:
        waited = self._cameras.add(info)
        if waited is not None:
            self._publish_objects(*waited, info)

    def _publish_objects(self, found: EllipseDetections, source: Any, info: Any) -> None:
        try:
            objects = self._sorting.value.sort(found, info)
        except InputError as problem:
            self._node.reject(f"{problem}{self._hint(info)}")
            objects = classify(EllipseDetections.empty(found.image_size))
        self._detections.publish(core_message(objects, source))

    def _hint(self, info: Any) -> str:
        latest, exact = self._cameras.latest(), self._camera_params.value.camera_info_sync
        if info is not None or latest is None or exact != "exact":
            return ""
        return " with the stamp of the image (camera_info_sync: latest would take any)"
