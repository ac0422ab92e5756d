"""Node `lifecycle_detector`: the whole chain as a managed node, for those who start by steps.

Configured it has its topics and warm kernels, active it works, inactive it reads nothing, and
cleaned up it has no topic. Parameters can be changed in every state.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rclpy._rclpy_pybind11 import RCLError
from rclpy.lifecycle import LifecycleNodeMixin, LifecycleState, TransitionCallbackReturn

from geoprim_core.errors import GeoprimError
from geoprim_ros.nodes.detector_node import ChainNode
from geoprim_ros.spin import run


class LifecycleDetector(LifecycleNodeMixin, ChainNode):  # type: ignore[misc]
    """The detector with the states unconfigured, inactive, active and finalized."""

    def __init__(self, **options: Any) -> None:
        self._working = False
        ChainNode.__init__(self, "lifecycle_detector", **options)
        LifecycleNodeMixin.__init__(self)
        self._change_state = self._service_change_state.callback
        self._service_change_state.callback = self._answer_change

    def is_active(self) -> bool:
        """Tell whether the inputs shall be open: only in the state active."""
        return self._working and super().is_active()

    def state(self) -> str:
        """Return what the node does, or the state where that is not active."""
        label = self._state_machine.current_state[1]
        return super().state() if self._working else str(label)

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Warm the kernels and make the topics, none of which is read yet."""
        try:
            self.connect()
        except GeoprimError as problem:
            self.get_logger().error(str(problem))
            self.disconnect()
            return TransitionCallbackReturn.FAILURE
        return super().on_configure(state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Start to work."""
        self._work(True)
        return super().on_activate(state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Stop reading; the topics stay."""
        self._work(False)
        return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Take the topics away."""
        self.disconnect()
        return super().on_cleanup(state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Take the topics away, from whatever state."""
        self._work(False)
        self.disconnect()
        return super().on_shutdown(state)

    def on_error(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Go back to unconfigured after a transition that failed half-way."""
        self._work(False)
        self.disconnect()
        return super().on_error(state)

    def _answer_change(self, request: Any, response: Any) -> Any:
        """Answer `~/change_state`; of itself rclpy ends at a step that the state does not allow."""
        before = self._state_machine.current_state[1]
        try:
            return self._change_state(request, response)
        except RCLError:
            step = request.transition.label or f"transition {request.transition.id}"
            self.get_logger().warning(f"{step} is refused: there is no such step from {before}")
            response.success = False
            return response

    def _work(self, working: bool) -> None:
        self._working = working
        self.refresh()


def main(args: Sequence[str] | None = None) -> int:
    """Run the node until a signal ends it."""
    return run(lambda: [LifecycleDetector()], args)


if __name__ == "__main__":
    raise SystemExit(main())
