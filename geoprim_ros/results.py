"""Publishing ellipses and the objects that they are sorted into."""

from __future__ import annotations

from typing import Any

from geoprim_msgs.msg import Detections as DetectionsMessage
from geoprim_msgs.msg import EllipseDetections as EllipsesMessage

from geoprim_core.applications.sorting import classify
from geoprim_core.errors import InputError
from geoprim_core.types import EllipseDetections
from geoprim_ros.camera_frames import CameraFrames
from geoprim_ros.conversions import core_message
from geoprim_ros.sorting import LiveSorting
from geoprim_ros.stage_node import StageNode


class ResultPublisher:
    """The topics `ellipses`, `detections` and `camera_info` of a node, and its parameters.

    Sizes in metres need the camera_info with the stamp of the frame; detections wait for it.
    """

    def __init__(self, node: StageNode) -> None:
        self._node = node
        self._sorting = node.follow_with(LiveSorting(node))
        self._cameras = CameraFrames(node, self._publish_objects)

    def connect(self) -> None:
        """Advertise the results and read camera_info."""
        self._ellipses = self._node.advertise(EllipsesMessage, "ellipses")
        self._detections = self._node.advertise(DetectionsMessage, "detections")
        self._cameras.connect()

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
        else:
            self._cameras.add(found, source)

    def clear(self) -> None:
        """Let go of what waits for a camera_info."""
        self._cameras.clear()

    def _publish_objects(self, found: EllipseDetections, source: Any, info: Any) -> None:
        try:
            objects = self._sorting.value.sort(found, info)
        except InputError as problem:
            self._node.reject(f"{problem}{self._cameras.hint() if info is None else ''}")
            objects = classify(EllipseDetections.empty(found.image_size))
        self._detections.publish(core_message(objects, source))
