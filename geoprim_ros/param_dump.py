"""Writes the parameters of a running node as a file for --params-file, as `ros2 param dump` does.

python -m geoprim_ros.param_dump /detector_node > detector.yaml
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Mapping, Sequence
from typing import Any

import yaml
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient

from geoprim_core.errors import InputError
from geoprim_ros.spin import in_rclpy, split_ros_args

_LIMIT_S = 10.0


def parameters_of(
    asker: Node, executor: SingleThreadedExecutor, name: str, limit_s: float = _LIMIT_S
) -> dict[str, Any]:
    """Return the parameters of a node by their names, asked for through its services.

    Parameters
    ----------
    asker : a node in the executor
    executor : is spun until the answers are there
    name : fully qualified name of the node that is asked

    Raises
    ------
    InputError
        The node does not answer.
    """
    client = AsyncParameterClient(asker, name)
    end = time.monotonic() + limit_s

    def answer(future: Any) -> Any:
        while not future.done() and time.monotonic() < end:
            executor.spin_once(timeout_sec=0.05)
        if not future.done():
            raise InputError("node", f"a running node that answers in {limit_s:g} s", repr(name))
        return future.result()

    while not client.services_are_ready() and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    names = sorted(answer(client.list_parameters()).result.names)
    values = answer(client.get_parameters(names)).values
    return {n: parameter_value_to_python(v) for n, v in zip(names, values, strict=True)}


def as_yaml(name: str, parameters: Mapping[str, Any]) -> str:
    """Return the text of the parameter file of a node.

    A parameter without a value, and an empty list, cannot be written there and are left out.

    Examples
    --------
    >>> print(as_yaml("/edges_node", {"edges.sigma": 1.0, "lazy": True}), end="")
    /edges_node:
      ros__parameters:
        edges:
          sigma: 1.0
        lazy: true
    """
    nested: dict[str, Any] = {}
    for key, value in parameters.items():
        if value is None or (not isinstance(value, str | int | float) and not len(value)):
            continue
        *groups, last = key.split(".")
        place = nested
        for group in groups:
            place = place.setdefault(group, {})
        place[last] = value if isinstance(value, str | int | float) else list(value)
    text: str = yaml.safe_dump({name: {"ros__parameters": nested}}, allow_unicode=True)
    return text


def main(args: Sequence[str] | None = None) -> int:
    """Print the parameters of a node; 2 where it does not answer."""
    own, ros = split_ros_args(sys.argv[1:] if args is None else args)
    parser = argparse.ArgumentParser(prog="geoprim_ros.param_dump", description=__doc__)
    parser.add_argument("node", help="fully qualified name, /detector_node")
    name = "/" + parser.parse_args(own).node.lstrip("/")

    def work(executor: SingleThreadedExecutor, nodes: list[Node]) -> int:
        asker = Node("param_dump", start_parameter_services=False)
        nodes.append(asker)
        executor.add_node(asker)
        print(as_yaml(name, parameters_of(asker, executor, name)), end="")
        return 0

    return in_rclpy(work, ros)


if __name__ == "__main__":
    raise SystemExit(main())
