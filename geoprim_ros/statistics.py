"""What a stage counts and times, and how it is told on /diagnostics."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue

_WINDOW = 512


@dataclass
class StageStatistics:
    """Counts of frames and the times of the last ones.

    Attributes
    ----------
    frames_in, frames_out : int
        Frames that came, but for the dropped ones, and results that went.
    dropped : int
        Frames that were sent but replaced by newer ones before the stage got to them.
    passed : int
        Frames that went by while the stage was idle or disabled.
    bad : int
        Frames that could not be used.
    unpaired : int
        Messages whose counterpart with the same stamp never came.
    cut_short : int
        Frames of which a bound on the work left something out: ellipses may be missing.
    without_camera : int
        Frames that needed a camera_info with their stamp, which never came.
    last_reason : str
        Why the last bad frame was bad.
    warm_up_s : float
        How long the kernels took before the first subscription, in seconds.
    """

    frames_in: int = 0
    frames_out: int = 0
    dropped: int = 0
    passed: int = 0
    bad: int = 0
    unpaired: int = 0
    cut_short: int = 0
    without_camera: int = 0
    last_reason: str = ""
    warm_up_s: float = 0.0
    seconds: deque[float] = field(default_factory=lambda: deque(maxlen=_WINDOW))
    latencies: deque[float] = field(default_factory=lambda: deque(maxlen=_WINDOW))
    _sequence: dict[str, int] = field(default_factory=dict)
    _topics: dict[str, str] = field(default_factory=dict)
    _resumed: set[str] = field(default_factory=set)

    def received(self, name: str, sequence: int | None) -> None:
        """Count a message and those its publisher numbered between it and the one before."""
        self.frames_in += 1
        if sequence is None:
            return
        before = self._sequence.get(name)
        # A number that does not rise is that of another publisher.
        if before is not None and sequence > before:
            missed = sequence - before - 1
            if name in self._resumed:
                self.passed += missed
            else:
                self.dropped += missed
        self._resumed.discard(name)
        self._sequence[name] = sequence

    def superseded(self, count: int) -> None:
        """Note that frames which came were dropped for a newer one."""
        self.frames_in -= count
        self.dropped += count

    def resumed(self, name: str, topic: str) -> None:
        """Note that an input is open again: what its publisher sent meanwhile was not dropped."""
        if self._topics.get(name, topic) != topic:
            self._sequence.pop(name, None)  # another publisher with numbers of its own
        self._topics[name] = topic
        self._resumed.add(name)

    def percentiles_ms(self, seconds: deque[float]) -> tuple[float, float]:
        """Return the median and the 95th percentile in milliseconds; NaN without any."""
        if not seconds:
            return float("nan"), float("nan")
        p50, p95 = np.percentile(np.fromiter(seconds, float), [50, 95]) * 1e3
        return float(p50), float(p95)

    def status(self, name: str, state: str, revision: int, bad_before: int) -> Any:
        """Return the diagnostic_msgs/msg/DiagnosticStatus; a warning when frames turned bad."""
        warn = self.bad > bad_before
        status = DiagnosticStatus(name=name, hardware_id="none")
        status.level = DiagnosticStatus.WARN if warn else DiagnosticStatus.OK
        status.message = self.last_reason if warn else state
        values = {"state": state, **self._values(), "parameter revision": str(revision)}
        status.values = [KeyValue(key=k, value=v) for k, v in values.items()]
        return status

    def _values(self) -> dict[str, str]:
        stage, latency = self.percentiles_ms(self.seconds), self.percentiles_ms(self.latencies)
        return {
            "frames in": str(self.frames_in),
            "frames out": str(self.frames_out),
            "dropped": str(self.dropped),
            "passed while idle": str(self.passed),
            "bad": str(self.bad),
            "unpaired": str(self.unpaired),
            "cut short": str(self.cut_short),
            "without camera_info": str(self.without_camera),
            "last reason": self.last_reason,
            "stage time p50 [ms]": f"{stage[0]:.2f}",
            "stage time p95 [ms]": f"{stage[1]:.2f}",
            "hop latency p50 [ms]": f"{latency[0]:.2f}",
            "hop latency p95 [ms]": f"{latency[1]:.2f}",
            "kernel warm-up [s]": f"{self.warm_up_s:.2f}",
        }
