"""Publishing ellipses and the objects that they are sorted into."""

from __future__ import annotations

from typing import Any

from geoprim_msgs.msg import Detections as DetectionsMessage
from geoprim_msgs.msg import EllipseDetections as EllipsesMessage

from geoprim_core.applications.sorting import classify
from geoprim_core.errors import InputError
from geoprim_core.types import EllipseDetections
from geoprim_ros.cameras import CameraInfos
from geoprim_ros.conversions import core_message
from geoprim_ros.sorting import LiveSorting
from geoprim_ros.stage_node import StageNode


class ResultPublisher:
    """The topics `ellipses` and `detections` of a node, and its sorting parameters."""

    def __init__(self, node: StageNode) -> None:
        self._node = node
        self._sorting = node.follow_with(LiveSorting(node))
        self.cameras = CameraInfos()
        self._ellipses = node.advertise(EllipsesMessage, "ellipses")
        self._detections = node.advertise(DetectionsMessage, "detections")

    def publish(self, found: EllipseDetections, source: Any) -> None:
        """Publish what was found with the header of its source.

        A result that a bound on the work cut short goes out too, is counted and told. Where the
        objects cannot be sorted, the ellipses go out all the same, the detections are empty and
        the reason is counted and told.
        """
        self._ellipses.publish(core_message(found, source))
        if not found.complete:
            self._node.note_cut_short(found.reason)
        try:
            objects = self._sorting.value.sort(found, self.cameras.of(source))
        except InputError as problem:
            self._node.reject(str(problem))
            objects = classify(EllipseDetections.empty(found.image_size))
        self._detections.publish(core_message(objects, source))
        self._node.statistics.frames_out += 1
