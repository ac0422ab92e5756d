"""The outcomes of a rerun of thesis 4.5, looked up by section, method and setting."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

from geoprim_core.evaluation.reproduce_fitting import Outcome

Measure = Callable[[Outcome], float]


def recall(outcome: Outcome) -> float:
    """Return the share of the truths that were found."""
    return outcome.counts.recall


def precision(outcome: Outcome) -> float:
    """Return the share of the detections that are good."""
    return outcome.counts.precision


def detected(outcome: Outcome) -> float:
    """Return detections a trial: E_total / 1000 of the thesis."""
    return outcome.counts.detected / outcome.trials


class Outcomes:
    """The outcomes of a rerun, to be looked up by section and method."""

    def __init__(self, outcomes: Iterable[Outcome]) -> None:
        self.all = list(outcomes)

    def sections(self) -> list[str]:
        """Return the sections that were run, in order."""
        return list(dict.fromkeys(o.setting.section for o in self.all))

    def methods(self) -> list[str]:
        """Return the methods that were run, in order."""
        return list(dict.fromkeys(o.method for o in self.all))

    def of(
        self, section: str, method: str, where: Callable[[Outcome], bool] = lambda _: True
    ) -> list[Outcome]:
        """Return the outcomes of a method in a section, in order of the settings."""
        chosen = (o for o in self.all if o.method == method and o.setting.section == section)
        return [o for o in chosen if where(o)]

    def has(self, section: str, methods: Sequence[str]) -> bool:
        """Tell whether all these methods were run in a section."""
        return all(self.of(section, method) for method in methods)

    def mean(self, section: str, method: str, measure: Measure) -> float:
        """Return a mean over the settings of a section, NaN settings left out."""
        values = [v for o in self.of(section, method) if not math.isnan(v := measure(o))]
        return sum(values) / len(values) if values else math.nan
