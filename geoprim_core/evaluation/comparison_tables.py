"""A comparison of detectors as tables, curves and the list of its worst images."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from geoprim_core._check import BoolArray, FloatArray
from geoprim_core.evaluation.comparison import Comparison, Measurement, median_ratio
from geoprim_core.evaluation.score import Score, mean_measures, measure_text, pool

_COLUMNS = (
    "set", "overlap", "use", "detector", "images", "hits", "misses", "false",
    "mean_precision", "mean_recall", "mean_f_measure", "precision", "recall", "f_measure",
    "median_ms", "p95_ms", "time_ratio", "failed",
)  # fmt: skip
_IMAGE_COLUMNS = (
    "set", "image", "alpha", "overlap", "detector", "hits", "misses", "false", "ms", "problem",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class ComparisonRow:
    """One detector on one set at one overlap ratio.

    Attributes
    ----------
    set_name, detector : str
    overlap : float
    images, failed : int
        Number of images, and of those without an answer.
    score : Score
        Counts of all images together.
    means : (precision, recall, f_measure)
        Averages over the images where the measure is defined; NaN where it is on none.
    median_ms, p95_ms : float
        Time an image.
    time_ratio : float
        Median over the images of the time divided by the reference's.
    """

    set_name: str
    overlap: float
    detector: str
    images: int
    failed: int
    score: Score
    means: tuple[float, float, float]
    median_ms: float
    p95_ms: float
    time_ratio: float

    @property
    def recall_only(self) -> bool:
        """True where false detections are not counted."""
        return self.score.false is None

    def cells(self) -> list[str | int | float]:
        """Return the row as it stands in a file."""
        score = self.score
        false: str | int = "" if score.false is None else score.false
        use = "recall-only" if self.recall_only else "full"
        pooled = (score.precision, score.recall, score.f_measure)
        numbers = (*self.means, *pooled, self.median_ms, self.p95_ms, self.time_ratio)
        cells = ["" if math.isnan(v) else round(v, 4) for v in numbers]
        counts = [score.hits, score.misses, false, *cells, self.failed]
        return [self.set_name, self.overlap, use, self.detector, self.images, *counts]


def comparison_rows(comparison: Comparison) -> tuple[ComparisonRow, ...]:
    """Return one row a set, overlap ratio, kind of truth (full, recall only) and detector."""
    keys = dict.fromkeys(
        (score.group, m.truth.recall_only, score.overlap)
        for m in comparison.measurements
        for score in m.scores
    )
    return tuple(
        _row(comparison, detector, *key) for key in keys for detector in comparison.detectors
    )


def _row(
    comparison: Comparison, detector: str, group: str, recall_only: bool, overlap: float
) -> ComparisonRow:
    own = _chosen(comparison, detector, group, recall_only)
    reference = _chosen(comparison, comparison.reference, group, recall_only)
    scores = [s.score for m in own for s in m.scores if s.overlap == overlap]
    times = np.array([m.run.seconds for m in own if not m.run.problem]) * 1e3
    late = np.percentile(times, [50, 95]) if len(times) else (math.nan, math.nan)
    failed = sum(bool(m.run.problem) for m in own)
    ratio = median_ratio(own, reference)
    return ComparisonRow(
        group or "images", overlap, detector, len(own), failed, pool(scores),
        mean_measures(scores), float(late[0]), float(late[1]), ratio,
    )  # fmt: skip


def _chosen(
    comparison: Comparison, detector: str, group: str, recall_only: bool
) -> list[Measurement]:
    return [
        m
        for m in comparison.of(detector)
        if m.truth.group == group and m.truth.recall_only == recall_only
    ]


def comparison_markdown(comparison: Comparison) -> str:
    """Return the rows as a Markdown table; what gave no answer follows it.

    Examples
    --------
    >>> print(comparison_markdown(Comparison(("a",), "a", ())).splitlines()[0][:20])
    | set | overlap | de
    """
    lines = [
        "| set | overlap | detector | images | mean P | mean R | mean F "
        f"| P | R | F | ms | p95 ms | time / {comparison.reference} | failed |",
        "|---|---:|---|---:|" + "---:|" * 10,
    ]
    for row in comparison_rows(comparison):
        name = row.set_name + (" (recall only)" if row.recall_only else "")
        score = row.score
        measures = (*row.means, score.precision, score.recall, score.f_measure)
        times = [measure_text(t, 2) for t in (row.median_ms, row.p95_ms, row.time_ratio)]
        cells = [name, f"{row.overlap:g}", row.detector, row.images]
        cells += [*map(measure_text, measures), *times, row.failed]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    problems = comparison.problems
    if problems:
        more = f"\n- and {len(problems) - 20} more" if len(problems) > 20 else ""
        lines += ["", "Without an answer:\n", *(f"- {p}" for p in problems[:20])]
        lines[-1] += more
    return "\n".join(lines) + "\n"


def summary_markdown(comparison: Comparison) -> str:
    """Return a Markdown table with one line a set and one column a detector.

    A cell holds the mean F over the images and in brackets that of the pooled counts (recall
    where only that is known; the number of false detections where there is nothing to be found),
    the median milliseconds, and the median ratio of times to the reference.

    Examples
    --------
    >>> print(summary_markdown(Comparison(("a",), "a", ())).splitlines()[0])
    | set | overlap | images | a |
    """
    names = " | ".join(comparison.detectors)
    lines = [f"| set | overlap | images | {names} |"]
    lines.append("|---|---:|---:|" + "---:|" * len(comparison.detectors))
    rows = comparison_rows(comparison)
    for k in range(0, len(rows), len(comparison.detectors)):
        own = rows[k : k + len(comparison.detectors)]
        name = own[0].set_name + (" (recall)" if own[0].recall_only else "")
        cells = [name, f"{own[0].overlap:g}", str(own[0].images), *map(_summary, own)]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _summary(row: ComparisonRow) -> str:
    score = row.score
    text = f"{row.means[2]:.3f} ({score.f_measure:.3f})"
    if score.false is None:
        text = f"{measure_text(row.means[1])} ({measure_text(score.recall)})"
    elif not score.actual:
        text = f"{score.false} false"
    times = "" if math.isnan(row.median_ms) else f", {row.median_ms:.1f} ms"
    return text + times + ("" if math.isnan(row.time_ratio) else f", x {row.time_ratio:.2f}")


def comparison_csv(comparison: Comparison) -> str:
    """Return the rows as comma-separated values with a heading."""
    return _csv(_COLUMNS, (row.cells() for row in comparison_rows(comparison)))


def comparison_images_csv(comparison: Comparison) -> str:
    """Return one line an image, overlap ratio and detector as comma-separated values."""
    lines = []
    for m in comparison.measurements:
        ms = "" if math.isnan(m.run.seconds) else round(m.run.seconds * 1e3, 4)
        alpha = "" if m.alpha is None else m.alpha
        for s in m.scores:
            false = "" if s.score.false is None else s.score.false
            counts = [s.score.hits, s.score.misses, false]
            head = [s.group, s.name, alpha, s.overlap, m.detector]
            lines.append([*head, *counts, ms, m.run.problem])
    return _csv(_IMAGE_COLUMNS, lines)


def alpha_curve(of: Sequence[Measurement], overlap: float) -> tuple[FloatArray, FloatArray]:
    """Return the numbers of ellipses (k,) and the mean precision, recall and F (k, 3) of each.

    References
    ----------
    Thesis Figures 5.6-3 to 5.6-8.
    """
    alphas = sorted({m.alpha for m in of if m.alpha is not None})
    curve = np.zeros((len(alphas), 3))
    for k, alpha in enumerate(alphas):
        scores = [m.score(overlap).score for m in of if m.alpha == alpha]
        curve[k] = mean_measures(scores)
    return np.array(alphas, dtype=np.float64), curve


def precision_recall(of: Sequence[Measurement], overlap: float) -> tuple[FloatArray, FloatArray]:
    """Return recall and precision (k,) of the detections down to each score, of all images.

    The partners are those of the matching of all detections; a threshold only leaves out the
    weaker ones. Detections without scores count as equal: one point.

    Examples
    --------
    >>> precision_recall((), 0.8)[0].tolist()
    []
    """
    score, hit = scored_detections(of, overlap)
    order = np.argsort(-score, kind="stable")
    last = np.flatnonzero(np.diff(score[order], append=-np.inf))  # equal scores: one threshold
    true = np.cumsum(hit[order])[last]
    actual = sum(int((~m.matching(overlap).uncertain).sum()) for m in of)
    return true / max(actual, 1), true / (last + 1.0)


def scored_detections(of: Sequence[Measurement], overlap: float) -> tuple[FloatArray, BoolArray]:
    """Return the scores (n,) of all detections that count, and which are a true ellipse (n,).

    A detector without scores has 1 for each. Images that are judged by recall only tell nothing
    of unmatched detections: leave them out.
    """
    scores, hits = [np.zeros(0)], [np.zeros(0, bool)]
    for m in of:
        matching = m.matching(overlap)
        score = m.run.score if m.run.score is not None else np.ones(len(m.run.ellipses))
        scores.append(score[~matching.dropped])
        hits.append(matching.hit[~matching.dropped])
    return np.concatenate(scores), np.concatenate(hits)


def worst_images(of: Sequence[Measurement], overlap: float, count: int = 5) -> list[Measurement]:
    """Return the images with the lowest F, or recall where only that is known, worst first.

    There are fewer where the others are perfect.
    """
    wrong = [m for m in of if m.score(overlap).score.merit < 1]
    return sorted(wrong, key=lambda m: m.score(overlap).score.merit)[:count]


def worst_markdown(of: Sequence[Measurement], overlap: float, count: int = 5) -> str:
    """Return the worst images as a Markdown table with what was missed and what was false.

    An ellipse is written as centre and semi-axes in pixels.
    """
    if not worst_images(of, overlap, count):
        return "None: every image is perfect.\n"
    lines = [
        "| image | F | missed (x, y; axes) | false (x, y; axes; score) |",
        "|---|---:|---|---|",
    ]
    for m in worst_images(of, overlap, count):
        score, matching = m.score(overlap), m.matching(overlap)
        missed = [_words(row) for row in m.truth.ellipses.select(matching.missed).array()]
        false = [] if m.truth.recall_only else _false_words(m, matching.false)
        kind = " (recall)" if score.recall_only else ""
        cells = [m.truth.name, f"{score.score.merit:.3f}{kind}", _listed(missed), _listed(false)]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _false_words(m: Measurement, false: np.ndarray) -> list[str]:
    scores = m.run.score
    words = []
    for k in np.flatnonzero(false):
        text = _words(m.run.ellipses.array()[k])
        words.append(text if scores is None else f"{text}; {scores[k]:.2f}")
    return words


def _words(row: FloatArray) -> str:
    return f"{row[0]:.0f}, {row[1]:.0f}; {row[2]:.0f} x {row[3]:.0f}"


def _listed(words: Sequence[str], most: int = 8) -> str:
    more = [f"and {len(words) - most} more"] if len(words) > most else []
    return "<br>".join([*words[:most], *more])


def _csv(heading: Iterable[str], lines: Iterable[Iterable[object]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(heading)
    writer.writerows(lines)
    return text.getvalue()
