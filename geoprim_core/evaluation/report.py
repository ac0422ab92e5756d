"""Scores of many images, summed up in rows, tables and files."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable
from dataclasses import dataclass

from geoprim_core.evaluation.score import UNDEFINED, Score, mean_measures, measure_text, pool

POOLED = "all"
"""Name of the rows that hold all groups together."""

_COUNTS = ("images", "hits", "misses", "false")
_MEASURES = ("precision", "recall", "f_measure", "mean_precision", "mean_recall", "mean_f_measure")
_COLUMNS = ("group", "overlap", "use", *_COUNTS, *_MEASURES)


@dataclass(frozen=True, slots=True)
class ImageScore:
    """The score of one image at one overlap ratio."""

    name: str
    group: str
    overlap: float
    score: Score

    @property
    def recall_only(self) -> bool:
        """True where false detections are not counted."""
        return self.score.false is None

    def cells(self) -> list[str | int | float]:
        """Return the score as it stands in a file."""
        false = "" if self.score.false is None else self.score.false
        return [self.name, self.group, self.overlap, self.score.hits, self.score.misses, false]


@dataclass(frozen=True, slots=True)
class ReportRow:
    """A group of images at one overlap ratio.

    `score` pools the counts; the `mean_` measures are averages over the images, as in the thesis:
    over those where the measure is defined, NaN where it is on none.
    """

    group: str
    overlap: float
    images: int
    score: Score
    mean_precision: float
    mean_recall: float
    mean_f_measure: float

    @property
    def use(self) -> str:
        """The word "full", or "recall-only" where false detections are not counted."""
        return "recall-only" if self.score.false is None else "full"

    def cells(self) -> list[str | int | float]:
        """Return the row as it stands in a file."""
        pooled, false = self.score, "" if self.score.false is None else self.score.false
        counts = [self.images, pooled.hits, pooled.misses, false]
        cells = ["" if math.isnan(m) else round(m, 4) for m in self.measures]
        return [self.group, self.overlap, self.use, *counts, *cells]

    @property
    def measures(self) -> tuple[float, ...]:
        """Precision, recall and F of the pooled counts, then their means over the images."""
        pooled = self.score
        means = (self.mean_precision, self.mean_recall, self.mean_f_measure)
        return (pooled.precision, pooled.recall, pooled.f_measure, *means)


@dataclass(frozen=True, slots=True)
class Report:
    """The scores of all images at all overlap ratios.

    Examples
    --------
    >>> images = [ImageScore("a", "cans", 0.8, Score(2, 0, 0)),
    ...           ImageScore("b", "cans", 0.8, Score(1, 1, 1))]
    >>> row = Report(tuple(images)).rows[0]
    >>> row.group, row.score, row.mean_f_measure
    ('cans', Score(hits=3, misses=1, false=1), 0.75)
    """

    images: tuple[ImageScore, ...]

    @property
    def overlaps(self) -> tuple[float, ...]:
        """The overlap ratios, rising."""
        return tuple(sorted({image.overlap for image in self.images}))

    @property
    def groups(self) -> tuple[str, ...]:
        """The groups in the order of their first image."""
        return tuple(dict.fromkeys(image.group for image in self.images))

    @property
    def rows(self) -> tuple[ReportRow, ...]:
        """One row a group and overlap ratio, and rows over all where there are several groups.

        Images that are judged by recall only have rows of their own.
        """
        rows = []
        for overlap in self.overlaps:
            for recall_only in (False, True):
                of_kind = [
                    image
                    for image in self.images
                    if image.overlap == overlap and image.recall_only == recall_only
                ]
                rows += _rows_of(of_kind, overlap)
        return tuple(rows)

    def __add__(self, other: Report) -> Report:
        """Return the report of both collections of images."""
        return Report(self.images + other.images)

    def markdown(self) -> str:
        """Return the rows as a Markdown table."""
        lines = [
            "| sequence | overlap | images | hits | missed | false "
            "| precision | recall | F | mean P | mean R | mean F |",
            "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|",
        ]
        for row in self.rows:
            name = row.group + (" (recall only)" if row.use == "recall-only" else "")
            false = UNDEFINED if row.score.false is None else row.score.false
            counts = [row.images, row.score.hits, row.score.misses, false]
            cells = [name or "images", f"{row.overlap:g}", *map(str, counts)]
            cells += map(measure_text, row.measures)
            lines.append("| " + " | ".join(cells) + " |")
        return "\n".join(lines) + "\n"

    def csv(self) -> str:
        """Return the rows as comma-separated values with a heading."""
        return _csv(_COLUMNS, (row.cells() for row in self.rows))

    def csv_images(self) -> str:
        """Return one line an image and overlap ratio as comma-separated values."""
        heading = ["image", "group", "overlap", "hits", "misses", "false"]
        return _csv(heading, (image.cells() for image in self.images))


def _rows_of(images: list[ImageScore], overlap: float) -> list[ReportRow]:
    groups = list(dict.fromkeys(image.group for image in images))
    rows = [
        _row(name, overlap, [image.score for image in images if image.group == name])
        for name in groups
    ]
    if len(groups) > 1:
        rows.append(_row(POOLED, overlap, [image.score for image in images]))
    return rows


def _row(name: str, overlap: float, scores: list[Score]) -> ReportRow:
    return ReportRow(name, overlap, len(scores), pool(scores), *mean_measures(scores))


def _csv(heading: Iterable[str], lines: Iterable[Iterable[object]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(heading)
    writer.writerows(lines)
    return text.getvalue()
