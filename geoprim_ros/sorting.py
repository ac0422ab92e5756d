"""The classes of a sorting task as ROS parameters: `labels`, and fields under each label."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.exceptions import InvalidParameterTypeException
from rclpy.node import Node

from geoprim_core.applications.sorting import OTHER, PLANE_DISTANCE, ClassParams, SortingParams
from geoprim_core.errors import ParameterError
from geoprim_core.io.camera_message import sort_objects
from geoprim_core.types import Detections, EllipseDetections
from geoprim_ros.parameters import declare, describe

_LABELS = "names of the classes, in the order in which they are tried; fields under LABEL."
_FIELDS = {o.name: o for o in ClassParams.options()}


@dataclass(frozen=True)
class SortingTask:
    """The classes, and the distance of the working plane in metres (0: not known)."""

    classes: SortingParams
    plane_distance: float

    def sort(self, found: EllipseDetections, camera_info: Any) -> Detections:
        """Return the labelled objects; sizes in metres where camera and plane are known.

        Raises
        ------
        InputError
            A class is in millimetres and the camera or the plane is not known.
        """
        return sort_objects(found, self.classes, camera_info, self.plane_distance)


class LiveSorting:
    """A sorting task that follows the ROS parameters of a node, replaced as a whole.

    Labels that are added later get their fields declared with the values that a parameter file
    gave them, or with the defaults; those of a label that goes are kept for when it comes back.

    Parameters
    ----------
    node : the node that gets the parameters

    Raises
    ------
    ParameterError
        A value given on the command line or in a parameter file is refused.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        default = SortingParams()
        try:
            descriptor = ParameterDescriptor(description=_LABELS)
            labels = node.declare_parameter("labels", list(default.classes), descriptor).value
        except InvalidParameterTypeException as error:
            raise ParameterError("labels", "a list of names", str(error)) from None
        self._values: dict[str, Any] = {"labels": list(labels)}
        self._left: dict[str, Any] = {}  # fields of labels that are gone for now
        for option in (OTHER, PLANE_DISTANCE):
            self._values[option.name] = declare(node, option.name, option, option.default)
        self._task(self._values)  # refuses labels that are no names before they are declared
        self._declare_fields()
        self.value = self._task(self._values)

    def changes(self, parameters: Mapping[str, Any]) -> dict[str, Any]:
        """Return those of the ROS parameters that belong here."""
        return {name: value for name, value in parameters.items() if name in self._values}

    def changed(self, parameters: Mapping[str, Any]) -> SortingTask:
        """Return what the task would be with some ROS parameters changed.

        Raises
        ------
        ParameterError
            A value is refused.
        """
        changes = self.changes(parameters)
        return self._task({**self._values, **changes}) if changes else self.value

    def follow(self, parameters: Mapping[str, Any]) -> None:
        """Put changed ROS parameters in effect."""
        changes = self.changes(parameters)
        if changes:
            self._values.update(changes)
            self._undeclare_fields()
            self._declare_fields()
            self.value = self._task(self._values)

    def typed(self, name: str, value: Any) -> Any:
        """Return a whole number as a float where the ROS parameter is a float."""
        whole = isinstance(value, int) and not isinstance(value, bool)
        return float(value) if whole and isinstance(self._values.get(name), float) else value

    def _declare_fields(self) -> None:
        for label in self._values["labels"]:
            for field, option in _FIELDS.items():
                name = f"{label}.{field}"
                if name in self._left:
                    kept, known = self._left.pop(name), describe(option)
                    self._node.declare_parameter(name, kept, known, ignore_override=True)
                    self._values[name] = kept
                elif name not in self._values:
                    self._values[name] = declare(self._node, name, option, option.default)

    def _undeclare_fields(self) -> None:
        """Take the fields of labels that are gone away; they come back with the label."""
        for name in [n for n in self._values if "." in n]:
            if name.rpartition(".")[0] not in self._values["labels"]:
                self._left[name] = self._values.pop(name)
                self._node.undeclare_parameter(name)

    @staticmethod
    def _task(values: Mapping[str, Any]) -> SortingTask:
        labels = tuple(values["labels"])
        distance = PLANE_DISTANCE.checked(values["plane_distance"])
        chosen = {n: v for n, v in values.items() if n.rpartition(".")[0] in labels}
        classes = SortingParams.from_dict(
            {**chosen, "labels": list(labels), "other": values["other"]}
        )
        return SortingTask(classes, float(distance))
