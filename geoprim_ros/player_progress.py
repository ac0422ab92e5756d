"""The progress bar of the player."""

from __future__ import annotations

import shutil
import time
from typing import Self

from tqdm import tqdm

from geoprim_core.io.bags import BagMessage
from geoprim_ros.playback import Playback

_PERIOD_S = 0.1
_BAR = "{desc}: {n:.1f} of {total:.1f} s |{bar}|{postfix}"


class Progress:
    """A bar that shows position and rate; none where the output is no terminal."""

    def __init__(self, playback: Playback[BagMessage], *, quiet: bool) -> None:
        self._playback, self._shown = playback, 0.0
        self._start = playback.source.start_ns
        total = (playback.source.end_ns - self._start) * 1e-9
        size = shutil.get_terminal_size()  # also where a terminal says that it has none
        self._bar = tqdm(
            total=total, desc="playing", bar_format=_BAR, ncols=size.columns, nrows=size.lines,
            disable=quiet or None,  # None: quiet unless it is a terminal
        )  # fmt: skip

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *reason: object) -> None:
        """Leave the last state on the screen."""
        self._shown = 0.0
        self.show()
        self._bar.close()

    def show(self) -> None:
        """Draw the bar anew, unless that was a moment ago."""
        now = time.monotonic()
        if self._bar.disable or now - self._shown < _PERIOD_S:
            return
        self._shown = now
        playback = self._playback
        self._bar.n = (playback.position() - self._start) * 1e-9
        state = ", paused" if playback.paused else ""
        text = f"rate {playback.rate:g}, {playback.sent} messages{state}"
        self._bar.set_postfix_str(text)
