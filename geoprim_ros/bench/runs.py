"""One run at one frame rate, and the search for the highest rate without a drop."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

OTHERS = "others"
"""The key under which `Run.cpu` has what is no process of the run."""

# A camera that falls behind by more sends fewer frames than the row says.
_LEAST_PACE = 0.98


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """What came back of the images that were sent at one rate.

    Attributes
    ----------
    rate : float
        Images a second, as asked for.
    sent_rate : float
        Images a second that the camera managed.
    sent, received : int
        Images, and ellipses with their stamp.
    latencies_ms : tuple of float
        From the stamp of each image, taken right before it is published, to its ellipses.
    cpu : dict
        Process -> share of one core, in percent, from the first image to the last answer; all
        that ran beside on the machine as `OTHERS`.
    """

    rate: float
    sent_rate: float
    sent: int
    received: int
    latencies_ms: tuple[float, ...]
    cpu: dict[str, float]

    @property
    def dropped(self) -> int:
        """How many images had no answer."""
        return self.sent - self.received

    @property
    def is_clean(self) -> bool:
        """Whether every image was answered and the camera kept its pace."""
        return self.dropped == 0 and self.sent_rate >= _LEAST_PACE * self.rate

    def percentile_ms(self, percent: float) -> float:
        """Return a percentile of the latencies; NaN where nothing was answered."""
        known = len(self.latencies_ms) > 0
        return float(np.percentile(self.latencies_ms, percent)) if known else float("nan")


def find_highest(
    measure: Callable[[float], Run], rates: Sequence[float], first: float
) -> list[Run]:
    """Measure at rates until the highest without a drop is known; return the runs in order.

    Parameters
    ----------
    measure : runs once at a rate
    rates : rising rates to choose from
    first : the rate of the first run, one of them

    The search halves the rates in question, as a graph that drops at one rate drops at higher
    ones.

    Examples
    --------
    >>> def measure(rate):
    ...     return Run(rate, rate, 10, 10 if rate <= 45 else 8, (), {})
    >>> runs = find_highest(measure, (15, 30, 45, 60, 90), 30)
    >>> [run.rate for run in runs], highest_clean(runs)
    ([30, 60, 45], 45)
    """
    runs: list[Run] = []
    low, high, at = -1, len(rates), list(rates).index(first)
    while high - low > 1:
        runs.append(measure(rates[at]))
        low, high = (at, high) if runs[-1].is_clean else (low, at)
        at = (low + high) // 2
    return runs


def highest_clean(runs: Sequence[Run]) -> float:
    """Return the highest rate without a drop; 0 where every run dropped."""
    return max((run.rate for run in runs if run.is_clean), default=0.0)
