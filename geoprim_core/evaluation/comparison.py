"""Several detectors over the same images in one run: who finds what, and in which time."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from geoprim_core.errors import InputError
from geoprim_core.evaluation.benchmark_sets import BenchmarkImage
from geoprim_core.evaluation.ground_truth import GroundTruth
from geoprim_core.evaluation.matching import Matching, match_ellipses
from geoprim_core.evaluation.peers import DetectorUnderTest, Run
from geoprim_core.evaluation.report import ImageScore, Report
from geoprim_core.evaluation.speed import one_processor


@dataclass(frozen=True, slots=True, eq=False)
class Measurement:
    """One detector on one image.

    Attributes
    ----------
    detector : str
    truth : GroundTruth
    alpha : int or None
    run : Run
        Its seconds are the least of the repeats.
    matchings : tuple of (overlap, Matching)
    """

    detector: str
    truth: GroundTruth
    alpha: int | None
    run: Run
    matchings: tuple[tuple[float, Matching], ...]

    @property
    def scores(self) -> tuple[ImageScore, ...]:
        """One score an overlap ratio."""
        return tuple(self.score(overlap) for overlap, _ in self.matchings)

    def matching(self, overlap: float) -> Matching:
        """Return the partners at one of the overlap ratios; `InputError` at another one."""
        for known, matching in self.matchings:
            if known == overlap:
                return matching
        measured = ", ".join(f"{known:g}" for known, _ in self.matchings)
        raise InputError("overlap", f"one of those measured: {measured}", f"{overlap}")

    def score(self, overlap: float) -> ImageScore:
        """Return the score at one of the overlap ratios; `InputError` at another one."""
        truth = self.truth
        score = self.matching(overlap).score(recall_only=truth.recall_only)
        return ImageScore(truth.name, truth.group, overlap, score)


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """All detectors on all images.

    Attributes
    ----------
    detectors : names, in the order of the tables
    reference : str
        The detector that times are divided by.
    measurements : tuple of Measurement
    """

    detectors: tuple[str, ...]
    reference: str
    measurements: tuple[Measurement, ...]

    def of(self, detector: str) -> tuple[Measurement, ...]:
        """Return the measurements of one detector."""
        return tuple(m for m in self.measurements if m.detector == detector)

    def report(self, detector: str) -> Report:
        """Return one detector's scores."""
        return Report(tuple(score for m in self.of(detector) for score in m.scores))

    @property
    def problems(self) -> tuple[str, ...]:
        """One line a detector and image without an answer."""
        return tuple(
            f"{m.detector} on {m.truth.group or 'images'}/{m.truth.name}: {m.run.problem}"
            for m in self.measurements
            if m.run.problem
        )


def compare_detectors(
    detectors: Sequence[DetectorUnderTest],
    images: Iterable[tuple[BenchmarkImage, Sequence[float]]],
    *,
    repeat: int = 1,
    reference: str | None = None,
    after_image: Callable[[], object] | None = None,
) -> Comparison:
    """Run detectors over images, image by image in turns, on one processor.

    Every detector sees the first image once before the clock counts. An image without an answer
    is scored as one where nothing was found.

    Parameters
    ----------
    detectors : sequence of DetectorUnderTest
    images : iterable of (BenchmarkImage, overlaps)
    repeat : int
        Runs an image, in turns; the least time counts, which a busy machine disturbs least.
    reference : str or None
        Name of the detector that times are divided by; None: the last one.
    after_image : callable or None
        Called when all detectors are done with an image, for a progress bar.

    Returns
    -------
    Comparison

    Raises
    ------
    InputError
        No detector, two of one name, a reference that is none of them, or a repeat below 1.

    Examples
    --------
    >>> from geoprim_core.evaluation.benchmark_sets import BENCHMARK_SETS
    >>> from geoprim_core.evaluation.peers import own_detectors
    >>> images = ((image, (0.8,)) for image in BENCHMARK_SETS["circles_clean"].images(1))
    >>> found = compare_detectors(own_detectors(["refined"]), images)
    >>> len(found.measurements), found.reference
    (1, 'refined')
    """
    names = [detector.name for detector in detectors]
    chosen = _checked(names, repeat, reference)
    measurements: list[Measurement] = []
    with one_processor():
        for image, overlaps in images:
            if not measurements:
                _run_in_turns(detectors, image, 1)
            runs = _run_in_turns(detectors, image, repeat)
            measurements += [
                _measurement(name, image, run, overlaps)
                for name, run in zip(names, runs, strict=True)
            ]
            if after_image is not None:
                after_image()
    return Comparison(tuple(names), chosen, tuple(measurements))


def _checked(names: list[str], repeat: int, reference: str | None) -> str:
    if not names or len(set(names)) < len(names):
        raise InputError("detectors", "at least one, each of another name", ", ".join(names))
    if repeat < 1:
        raise InputError("repeat", "at least 1", f"{repeat}")
    if reference is not None and reference not in names:
        raise InputError("reference", f"one of {', '.join(names)}", repr(reference))
    return reference or names[-1]


def _run_in_turns(
    detectors: Sequence[DetectorUnderTest], image: BenchmarkImage, repeat: int
) -> list[Run]:
    """Return each detector's first answer with the least of its times."""
    first = [detector.run(image.image) for detector in detectors]
    least = [run.seconds for run in first]
    for _ in range(repeat - 1):
        for k, detector in enumerate(detectors):
            if not first[k].problem:
                least[k] = float(np.fmin(least[k], detector.run(image.image).seconds))
    return [
        Run(run.ellipses, run.score, seconds, run.problem)
        for run, seconds in zip(first, least, strict=True)
    ]


def _measurement(
    name: str, image: BenchmarkImage, run: Run, overlaps: Sequence[float]
) -> Measurement:
    truth = image.truth
    matchings = tuple(
        (
            overlap,
            match_ellipses(
                run.ellipses, truth.ellipses, overlap=overlap, uncertain=truth.uncertain
            ),
        )
        for overlap in overlaps
    )
    return Measurement(name, truth, image.alpha, run, matchings)


def median_ratio(of: Sequence[Measurement], reference: Sequence[Measurement]) -> float:
    """Return the median of the time ratios image by image; NaN without two answers to any."""
    ratios = [
        a.run.seconds / b.run.seconds
        for a, b in zip(of, reference, strict=True)
        if not (math.isnan(a.run.seconds) or math.isnan(b.run.seconds))
    ]
    return float(np.median(ratios)) if ratios else math.nan
