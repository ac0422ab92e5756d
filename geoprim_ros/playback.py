"""Which message of a recording is due when, under pause, rate, seek and loop; without ROS.

The time of the recording, the *position*, follows a clock at some rate. It stands while paused
and never runs ahead of a message that is not sent yet, so that every message goes out at its own
time or later, in order, and once.
"""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from typing import Generic, Protocol, TypeVar

from geoprim_core.errors import InputError

# A loop over a single message shall not send it as fast as the machine can.
_SHORTEST_ROUND_NS = 10_000_000


class Timed(Protocol):
    """Something with a time in the recording."""

    @property
    def log_time_ns(self) -> int:
        """Time in nanoseconds."""


M = TypeVar("M", bound=Timed)
MessageOf = TypeVar("MessageOf", bound=Timed, covariant=True)


class Source(Protocol[MessageOf]):
    """A recording between two times."""

    @property
    def start_ns(self) -> int:
        """Where playing starts."""

    @property
    def end_ns(self) -> int:
        """Where it ends; a message of this time still belongs to it."""

    def messages(self, since_ns: int) -> Iterator[MessageOf]:
        """Yield the messages from some time to the end."""

    def state_before(self, since_ns: int) -> Iterable[MessageOf]:
        """Return the earlier messages that still hold at some time."""


class Playback(Generic[M]):
    """The schedule of a recording.

    Parameters
    ----------
    source : the recording
    rate : times the speed, above 0
    paused : start so
    loop : go on with the start at the end
    clock : nanoseconds that never run backwards

    Attributes
    ----------
    sent, rounds : int
        Messages of the range handed out, and how often the end was passed.

    Raises
    ------
    InputError
        The rate is not a finite number above 0.
    """

    def __init__(
        self,
        source: Source[M],
        *,
        rate: float = 1.0,
        paused: bool = False,
        loop: bool = False,
        clock: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        self.source = source
        self.paused, self.loop = paused, loop
        self.sent = self.rounds = 0
        self._clock = clock
        self._rate = checked_rate(rate)
        self._round_end = max(source.end_ns, source.start_ns + _SHORTEST_ROUND_NS)
        self._state: deque[M]
        self._next: M | None
        self._reached: int
        self._anchor_bag: int
        self._loaded = False
        self._jump(source.start_ns)

    @property
    def rate(self) -> float:
        """Seconds of the recording a second."""
        return self._rate

    @property
    def finished(self) -> bool:
        """True when there is nothing more to come; never while paused, as a seek may follow."""
        return not (self.paused or self.loop or self._state or self._head() is not None)

    def position(self) -> int:
        """Return the time of the recording in nanoseconds; it runs back in a jump only."""
        return max(self._reached, min(self._time(), self._due()))

    def wait_s(self) -> float:
        """Return the seconds until something is due, infinite while paused."""
        if self._state or self.finished:
            return 0.0
        if self.paused:
            return math.inf
        return max(0.0, (self._due() - self._time()) / self._rate * 1e-9)

    def take(self) -> M | None:
        """Return the message that is due, or None; what still holds comes even while paused."""
        if self._state:
            return self._state.popleft()
        if self.paused:
            return None
        if self._time() < self._due():
            return None
        if self._head() is None and self.loop:
            self._start_again()
            return self.take()
        return self._advance()

    def step(self) -> M | None:
        """Return the next message while paused, and stand there; None where there is none."""
        if not self.paused:
            return None
        if self._head() is None and self.loop:
            self._start_again()
        message = self._state.popleft() if self._state else self._advance()
        self.anchor()
        return message

    def pause(self) -> None:
        """Stand where it is."""
        self.anchor()
        self.paused = True

    def resume(self) -> None:
        """Go on from where it stands."""
        self.anchor()
        self.paused = False

    def set_rate(self, rate: float) -> None:
        """Go on faster or slower; raise `InputError` where the rate is not above 0."""
        checked = checked_rate(rate)
        self.anchor()
        self._rate = checked

    def seek(self, position_ns: int) -> None:
        """Go on from a time, or the nearest one of the range, paused or not as before."""
        self._jump(min(max(position_ns, self.source.start_ns), self.source.end_ns))

    def anchor(self) -> None:
        """Let the time run on from the position, so that a delay until now is not made up for."""
        self._anchor_bag = self.position()
        self._anchor_clock = self._clock()

    def _time(self) -> int:
        if self.paused:
            return self._anchor_bag
        return self._anchor_bag + int((self._clock() - self._anchor_clock) * self._rate)

    def _head(self) -> M | None:
        """Return the next message; reading it takes time, so not before it is asked for."""
        if not self._loaded:
            self._next, self._loaded = next(self._messages, None), True
        return self._next

    def _due(self) -> int:
        """Return the time of the next message, or of the end where there is none."""
        head = self._head()
        return self._round_end if head is None else head.log_time_ns

    def _advance(self) -> M | None:
        message = self._head()
        if message is not None:
            self._reached = max(self._reached, message.log_time_ns)
            self.sent += 1
            self._loaded = False
        return message

    def _start_again(self) -> None:
        self.rounds += 1
        self._jump(self.source.start_ns)

    def _jump(self, position_ns: int) -> None:
        self._state = deque(self.source.state_before(position_ns))
        self._messages = self.source.messages(position_ns)
        self._loaded = False
        self._reached = self._anchor_bag = position_ns
        self._head()
        self._anchor_clock = self._clock()  # reading took its time


def checked_rate(rate: float) -> float:
    """Return a rate, or raise `InputError` where it is not a finite number above 0."""
    number = isinstance(rate, int | float) and not isinstance(rate, bool)
    if not (number and 0 < rate < math.inf):
        raise InputError("rate", "a number above 0", repr(rate))
    return float(rate)
