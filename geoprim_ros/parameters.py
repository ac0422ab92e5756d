"""ROS parameters made from Params classes: declared, ranged, changed live, refused with reason."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Generic, Protocol, TypeVar

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.node import Node
from rclpy.parameter import Parameter

from geoprim_core.params import Option, Params

P = TypeVar("P", bound=Params)

_LARGEST_INT = 2**63 - 1


class Follower(Protocol):
    """Something made from ROS parameters that checks and follows their changes."""

    def changes(self, parameters: Mapping[str, Any]) -> dict[str, Any]:
        """Return those of the ROS parameters that belong here."""

    def changed(self, parameters: Mapping[str, Any]) -> object:
        """Return what the value would be; raise `ParameterError` where that is refused."""

    def follow(self, parameters: Mapping[str, Any]) -> None:
        """Put changed ROS parameters in effect."""

    def typed(self, name: str, value: Any) -> Any:
        """Return a whole number in the type of the ROS parameter where it can be meant so."""


class LiveParams(Generic[P]):
    """A Params object that follows the ROS parameters of a node.

    `value` is replaced as a whole when parameters change, never altered: whoever reads it once a
    frame sees one consistent set.

    Parameters
    ----------
    node : the node that gets the parameters
    initial : the values where nothing else is given
    prefix : put before the name of every parameter, "cans."
    wanted : says by its name whether an option becomes a parameter; the others keep their value

    Raises
    ------
    ParameterError
        A value given on the command line or in a parameter file is refused.
    """

    def __init__(
        self,
        node: Node,
        initial: P,
        prefix: str = "",
        wanted: Callable[[str], bool] = lambda name: True,
    ) -> None:
        self.prefix = prefix
        self.options = {o.name: o for o in type(initial).options() if wanted(o.name)}
        defaults = initial.to_dict()
        given = {
            name: declare(node, prefix + name, declared, defaults[name])
            for name, declared in self.options.items()
        }
        self.value: P = initial.updated(given)

    def changes(self, parameters: Mapping[str, Any]) -> dict[str, Any]:
        """Return those of the ROS parameters that belong here, under their own names."""
        start = len(self.prefix)
        return {
            name[start:]: value
            for name, value in parameters.items()
            if name.startswith(self.prefix) and name[start:] in self.options
        }

    def changed(self, parameters: Mapping[str, Any]) -> P:
        """Return what the value would be with some ROS parameters changed.

        Raises
        ------
        ParameterError
            A value is refused.
        """
        changes = self.changes(parameters)
        return self.value.updated(changes) if changes else self.value

    def follow(self, parameters: Mapping[str, Any]) -> None:
        """Put changed ROS parameters in effect."""
        self.value = self.changed(parameters)

    def typed(self, name: str, value: Any) -> Any:
        """Return a whole number in the type of the ROS parameter where it can be meant so."""
        declared = self.options.get(name.removeprefix(self.prefix))
        if declared is None or not name.startswith(self.prefix):
            return value
        return declared.meant(value)


def declare(
    node: Node, name: str, declared: Option, default: Any, *, read_only: bool = False
) -> Any:
    """Declare one ROS parameter and return the value it starts with.

    Raises
    ------
    ParameterError
        The value given at the start is of another type or out of range.
    """
    descriptor = describe(declared)
    descriptor.read_only = read_only
    try:
        return node.declare_parameter(name, default, descriptor).value
    except (InvalidParameterTypeException, InvalidParameterValueException):
        value = replace(declared, name=name).checked(_given(node, name, default))
        return node.declare_parameter(name, value, descriptor, ignore_override=True).value


def _given(node: Node, name: str, default: Any) -> Any:
    """Return the value of any type that a command line or parameter file gives."""
    value = node.declare_parameter(name, default, ParameterDescriptor(dynamic_typing=True)).value
    node.undeclare_parameter(name)
    return value


def describe(declared: Option) -> Any:
    """Return the rcl_interfaces/msg/ParameterDescriptor of an option."""
    unit = f" [{declared.unit}]" if declared.unit else ""
    descriptor = ParameterDescriptor(
        description=declared.text + unit,
        additional_constraints=declared.expectation() if declared.choices else "",
    )
    if declared.low is None and declared.high is None:
        return descriptor
    if declared.kind is float:
        low = -sys.float_info.max if declared.low is None else float(declared.low)
        high = sys.float_info.max if declared.high is None else float(declared.high)
        descriptor.floating_point_range = [FloatingPointRange(from_value=low, to_value=high)]
    elif declared.kind is int:
        low = -_LARGEST_INT if declared.low is None else int(declared.low)
        high = _LARGEST_INT if declared.high is None else int(declared.high)
        # With a step of 0 rclpy asks for nothing but the range.
        descriptor.integer_range = [IntegerRange(from_value=low, to_value=high, step=1)]
    return descriptor


def as_values(parameters: list[Parameter]) -> dict[str, Any]:
    """Return name -> value of ROS parameters."""
    return {parameter.name: parameter.value for parameter in parameters}
