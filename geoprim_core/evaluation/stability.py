"""Whether a result stays the same when the image is turned, mirrored, shifted or brightened."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from geoprim_core._check import AnyArray, FloatArray
from geoprim_core.evaluation.benchmark_sets import BenchmarkImage
from geoprim_core.evaluation.comparison import Comparison, Measurement
from geoprim_core.types import Ellipses

PLAIN = "as it is"
_JOINT = " | "
_Change = Callable[[AnyArray, FloatArray], tuple[AnyArray, FloatArray]]


def _as_is(image: AnyArray, rows: FloatArray) -> tuple[AnyArray, FloatArray]:
    return image, rows


def _quarter_turn(image: AnyArray, rows: FloatArray) -> tuple[AnyArray, FloatArray]:
    x = image.shape[0] - 1 - rows[:, 1]
    angle = (rows[:, 4] + np.pi / 2) % np.pi
    return np.rot90(image, -1), np.column_stack([x, rows[:, 0], rows[:, 2], rows[:, 3], angle])


def _mirror(image: AnyArray, rows: FloatArray) -> tuple[AnyArray, FloatArray]:
    x = image.shape[1] - 1 - rows[:, 0]
    angle = (np.pi - rows[:, 4]) % np.pi
    return image[:, ::-1], np.column_stack([x, rows[:, 1:4], angle])


def _shift(image: AnyArray, rows: FloatArray) -> tuple[AnyArray, FloatArray]:
    """Move by a pixel to the right and down; the first column and row are repeated."""
    widths = [(1, 0), (1, 0)] + [(0, 0)] * (image.ndim - 2)
    moved = np.pad(image, widths, mode="edge")[:-1, :-1]
    return moved, rows + np.array([1, 1, 0, 0, 0])


def _gain(image: AnyArray, rows: FloatArray) -> tuple[AnyArray, FloatArray]:
    if image.dtype.kind == "f":
        return image * image.dtype.type(1.01), rows
    brighter = np.minimum(image * 1.01 + 0.5, np.iinfo(image.dtype).max)
    return brighter.astype(image.dtype), rows


CHANGES: Mapping[str, _Change] = {
    PLAIN: _as_is,
    "quarter turn": _quarter_turn,
    "mirror": _mirror,
    "shift by a pixel": _shift,
    "gain of 1 %": _gain,
}
"""Name -> function(image, rows) -> the changed image and its true ellipses."""


def changed_images(
    images: Iterable[tuple[BenchmarkImage, Sequence[float]]],
) -> Iterator[tuple[BenchmarkImage, Sequence[float]]]:
    """Yield every image as it is and with each of `CHANGES`, with its truth changed alike.

    Examples
    --------
    >>> from geoprim_core.evaluation.benchmark_sets import BENCHMARK_SETS
    >>> plain = ((image, (0.8,)) for image in BENCHMARK_SETS["circles_clean"].images(1))
    >>> [image.image.shape for image, _ in changed_images(plain)][:2]
    [(480, 640), (640, 480)]
    """
    for image, overlaps in images:
        for name, change in CHANGES.items():
            yield _changed(image, name, change), overlaps


def _changed(image: BenchmarkImage, name: str, change: _Change) -> BenchmarkImage:
    pixels, rows = change(image.image, image.truth.ellipses.array())
    group = f"{image.truth.group}{_JOINT}{name}"
    truth = replace(image.truth, ellipses=Ellipses.from_array(rows), group=group)
    return BenchmarkImage(np.ascontiguousarray(pixels), truth, image.alpha)


def stability_markdown(comparison: Comparison) -> str:
    """Return a Markdown table of a comparison over `changed_images`, for each set and detector.

    The mean F (recall where only that is known) as it is, how it differs after each change, and
    the largest difference of one image.
    """
    changes = [name for name in CHANGES if name != PLAIN]
    lines = [
        f"| set | overlap | detector | F | {' | '.join(changes)} | largest of one image |",
        "|---|---:|---|---:|" + "---:|" * (len(changes) + 1),
    ]
    keys = dict.fromkeys(
        (m.truth.group.split(_JOINT)[0], m.truth.recall_only, overlap)
        for m in comparison.measurements
        for overlap, _ in m.matchings
    )
    for group, recall_only, overlap in keys:
        for detector in comparison.detectors:
            own = [m for m in comparison.of(detector) if m.truth.recall_only == recall_only]
            plain = _merits(own, group, PLAIN, overlap)
            apart = np.array([_merits(own, group, name, overlap) - plain for name in changes])
            name = group + (" (recall only)" if recall_only else "")
            cells = [name, f"{overlap:g}", detector, f"{plain.mean():.3f}"]
            cells += [f"{value:+.3f}" for value in apart.mean(axis=1)]
            lines.append("| " + " | ".join([*cells, f"{np.abs(apart).max():.3f}"]) + " |")
    return "\n".join(lines) + "\n"


def _merits(of: Sequence[Measurement], group: str, change: str, overlap: float) -> FloatArray:
    chosen = [m for m in of if m.truth.group == f"{group}{_JOINT}{change}"]
    scores = [m.score(overlap).score for m in chosen if overlap in dict(m.matchings)]
    return np.array([s.merit for s in scores if s.actual or s.false is not None])
