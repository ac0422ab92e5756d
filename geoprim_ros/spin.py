"""Starting, spinning and ending nodes, so that SIGINT and SIGTERM end them with code 0."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node

from geoprim_core.errors import GeoprimError
from geoprim_ros.deadline import exit_after
from geoprim_ros.shared_memory import clean

# A participant is gone after some tens of milliseconds, unless Fast DDS waits for itself.
TAKE_DOWN_S = 8.0


def run(make_nodes: Callable[[], Sequence[Node]], args: Sequence[str] | None = None) -> int:
    """Make nodes, spin them in one executor until a signal or a shutdown, and take them down.

    Parameters
    ----------
    make_nodes : called after rclpy is initialised
    args : ROS arguments, default those of the command line

    Returns
    -------
    int
        Exit code: 0 after SIGINT, SIGTERM or a shutdown, 2 where a node refuses to start or an
        argument is not one of ROS, which is then said in one sentence.
    """
    own, ros = split_ros_args(sys.argv[1:] if args is None else args)
    if own:
        print(f"not understood: {' '.join(own)}; ROS arguments follow --ros-args", file=sys.stderr)
        return 2

    def work(executor: SingleThreadedExecutor, nodes: list[Node]) -> int:
        nodes.extend(make_nodes())
        for node in nodes:
            executor.add_node(node)
        executor.spin()
        return 0

    return in_rclpy(work, ros)


def in_rclpy(work: Callable[[SingleThreadedExecutor, list[Node]], int], args: Sequence[str]) -> int:
    """Call `work` between the start and the end of rclpy and return an exit code.

    `work` gets an executor and a list for its nodes, which are taken down whatever happens. Its
    code is returned, 0 where a signal or a shutdown cut it short, and 2 after a `GeoprimError`,
    which is printed.
    """
    with _first_interrupt_is_quiet():
        clean()  # what was killed before leaves 17 MB a process
        rclpy.init(args=list(args))
        executor = SingleThreadedExecutor()
        nodes: list[Node] = []
        code = 1
        try:
            code = _code_of(work, executor, nodes)
        finally:
            take_down(executor, nodes, code)
        return code


def _code_of(
    work: Callable[[SingleThreadedExecutor, list[Node]], int],
    executor: SingleThreadedExecutor,
    nodes: list[Node],
) -> int:
    try:
        return work(executor, nodes)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except GeoprimError as problem:
        print(problem, file=sys.stderr)
        return 2
    except Exception:
        # A signal invalidates the context under rclpy's feet, which then raises one of
        # several errors; with the context still up the error is a real one.
        if rclpy.ok():
            raise
    return 0


@contextmanager
def _first_interrupt_is_quiet() -> Iterator[None]:
    """Let the first SIGINT do what SIGTERM does, which is to shut rclpy down.

    A KeyboardInterrupt can be raised anywhere, also where it is lost or leaves things half done;
    the second one is, for those who cannot wait.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.getsignal(signal.SIGINT)

    def wait_for_the_second(number: int, frame: object) -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)

    signal.signal(signal.SIGINT, wait_for_the_second)  # rclpy.init puts its own in front
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def split_ros_args(args: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return a program's own arguments and those of ROS, which stand from --ros-args to --.

    Examples
    --------
    >>> split_ros_args(["bag.mcap", "--ros-args", "-r", "image:=camera", "--", "--loop"])
    (['bag.mcap', '--loop'], ['--ros-args', '-r', 'image:=camera', '--'])
    """
    own: list[str] = []
    ros: list[str] = []
    inside = False
    for word in args:
        inside = inside or word == "--ros-args"
        (ros if inside else own).append(word)
        inside = inside and word != "--"
    return own, ros


def take_down(executor: SingleThreadedExecutor, nodes: Sequence[Node], code: int = 0) -> None:
    """Stop the executor, then the nodes, then rclpy; a second Ctrl-C does not cut it short.

    Where the middleware hangs in it, the process ends with `code`.
    """
    own = [node.close for node in nodes if hasattr(node, "close")]  # what must not be cut short
    _do_all([partial(executor.shutdown, timeout_sec=1.0), *own])
    with exit_after(TAKE_DOWN_S, code):
        _do_all([*(node.destroy_node for node in nodes), rclpy.try_shutdown])


def _do_all(steps: Sequence[Callable[[], object]]) -> None:
    for step in steps:
        with suppress(KeyboardInterrupt):
            step()
