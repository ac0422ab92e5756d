"""Pause, step, seek and rate of a running player: by services, by parameters, by keys."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from geoprim_core.errors import InputError
from geoprim_core.io.bags import BagMessage
from geoprim_ros.playback import Playback, checked_rate

KEYS = """\
keys, on a terminal:
  space     pause and go on
  right     the next message while paused, else 5 s forward
  left      5 s back
  up, +     10 % faster
  down, -   10 % slower"""
_JUMP_S = 5.0
_FASTER = 1.1
_FINEST = 6  # digits of a rate behind the point
_NANO = 1e-9


class Controls:
    """What the outside can do with a player.

    Services of std_srvs/Trigger below the node's name: `pause`, `resume`, `toggle_paused`,
    `play_next` and `is_paused`; the text of every answer tells the state. Parameters: `rate`, and
    `position` in seconds from the start of the bag, where setting it seeks.

    Parameters
    ----------
    node : the node that gets services and parameters
    playback : the schedule
    origin_ns : int
        Where position 0 is.
    send : publishes a message
    """

    def __init__(
        self,
        node: Any,
        playback: Playback[BagMessage],
        origin_ns: int,
        send: Callable[[BagMessage], None],
    ) -> None:
        self._node, self._playback, self._origin = node, playback, origin_ns
        self._send = send
        node.declare_parameter("rate", playback.rate, _described("times the speed, above 0"))
        start = "seconds from the start of the bag; setting it seeks"
        node.declare_parameter("position", self.seconds(), _described(start))
        self._heed_what_was_declared()
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._follow)
        for name, act in self._services().items():
            node.create_service(Trigger, f"~/{name}", self._answer(act))

    def seconds(self) -> float:
        """Return the position in seconds from the start of the bag."""
        return (self._playback.position() - self._origin) * _NANO

    def state(self) -> str:
        """Return whether it plays, where it is and how fast."""
        end = (self._playback.source.end_ns - self._origin) * _NANO
        state = "paused" if self._playback.paused else "playing"
        return f"{state} at {self.seconds():.3f} of {end:.3f} s, rate {self._playback.rate:g}"

    def press(self, key: str) -> None:
        """Do what a key asks for; one without a meaning does nothing."""
        if key == " ":
            self._toggle()
        elif key == "right" and self._playback.paused:
            self._play_next()
        elif key in ("left", "right"):
            self._jump(_JUMP_S if key == "right" else -_JUMP_S)
        elif key in ("up", "+", "="):
            self._change_rate(self._playback.rate * _FASTER)
        elif key in ("down", "-"):
            self._change_rate(self._playback.rate / _FASTER)

    def _heed_what_was_declared(self) -> None:
        """Follow values that came with the command line or a parameter file of ROS."""
        declared = [self._node.get_parameter(name) for name in ("rate", "position")]
        present = (self._playback.rate, self.seconds())
        changed = [p for p, value in zip(declared, present, strict=True) if p.value != value]
        for parameter in changed:
            self._checked(parameter)
        self._follow(changed)

    def _services(self) -> dict[str, Callable[[], bool]]:
        return {
            "pause": self._pause,
            "resume": self._resume,
            "toggle_paused": self._toggle,
            "play_next": self._play_next,
            "is_paused": lambda: self._playback.paused,
        }

    def _answer(self, act: Callable[[], bool]) -> Callable[[Any, Any], Any]:
        def answer(request: Any, response: Any) -> Any:
            response.success = act()
            response.message = self.state()
            return response

        return answer

    def _pause(self) -> bool:
        self._playback.pause()
        return True

    def _resume(self) -> bool:
        self._playback.resume()
        return True

    def _toggle(self) -> bool:
        return self._resume() if self._playback.paused else self._pause()

    def _play_next(self) -> bool:
        message = self._playback.step()
        if message is not None:
            self._send(message)
        return message is not None

    def _jump(self, seconds: float) -> None:
        self._playback.seek(self._playback.position() + round(seconds / _NANO))

    def _change_rate(self, rate: float) -> None:
        self._node.set_parameters([Parameter("rate", value=round(rate, _FINEST) or rate)])

    def _check(self, parameters: list[Parameter]) -> SetParametersResult:
        try:
            for parameter in parameters:
                self._checked(parameter)
        except InputError as problem:
            return SetParametersResult(successful=False, reason=str(problem))
        return SetParametersResult(successful=True)

    def _checked(self, parameter: Parameter) -> None:
        if parameter.name == "rate":
            checked_rate(parameter.value)
        elif parameter.name == "position":
            source, value = self._playback.source, parameter.value
            first, last = ((t - self._origin) * _NANO for t in (source.start_ns, source.end_ns))
            number = isinstance(value, int | float) and not isinstance(value, bool)
            if not (number and first <= value <= last):
                expected = f"a number from {first:.3f} to {last:.3f} s"
                raise InputError("position", expected, repr(value))

    def _follow(self, parameters: list[Parameter]) -> None:
        for parameter in parameters:
            if parameter.name == "rate":
                self._playback.set_rate(parameter.value)
            elif parameter.name == "position":
                self._playback.seek(self._origin + round(parameter.value / _NANO))


def _described(text: str) -> ParameterDescriptor:
    return ParameterDescriptor(description=text, dynamic_typing=True)
