"""What overlays, markers and annotations show of a frame: ellipses with number, score and class."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from geoprim_core._check import FloatArray, describe
from geoprim_core.errors import InputError, ParameterError
from geoprim_core.io.score_colours import score_colours
from geoprim_core.params import Params, group, option
from geoprim_core.types import Detections, EllipseDetections, Ellipses

K = TypeVar("K")


@dataclass(frozen=True)
class OverlayParams(Params):
    """What is drawn of the results, and how."""

    ellipses: bool = option(True, "draw the ellipses that have no class")
    classes: bool = option(True, "write the class of objects that have one")
    ids: bool = option(True, "write the number of each ellipse in its message, as #0")
    scores: bool = option(True, "write the scores")
    legend: bool = option(True, "draw the scale of scores and the count")
    title: str = option("", "a line of the legend, such as what found the ellipses")
    score_low: float = option(
        0.5, "score of the darkest colour, and of all below it", low=0.0, high=1.0
    )
    score_high: float = option(1.0, "score of the brightest colour", low=0.0, high=1.0)
    size: float = option(
        0.0, "size of lines and letters, 1 for VGA; 0: by the image", low=0.0, high=20.0
    )

    def __post_init__(self) -> None:
        """Check every field, and that the scale of scores has two ends."""
        super().__post_init__()
        if not self.score_low < self.score_high:
            expected = f"less than score_high = {self.score_high}"
            raise ParameterError("score_low", expected, f"{self.score_low}")


@dataclass(frozen=True)
class ViewParams(Params):
    """The parameters of what is drawn, under the names that files and nodes have for them."""

    overlay: OverlayParams = group(OverlayParams)


@dataclass(frozen=True, eq=False)
class Shown:
    """Ellipses to show, best first.

    Attributes
    ----------
    ellipses : Ellipses, n of them
    score : (n,) float64
    ids : n whole numbers
        Place of each in the message of all ellipses.
    labels : n texts
        Classes; empty where there is none.
    """

    ellipses: Ellipses
    score: FloatArray
    ids: tuple[int, ...]
    labels: tuple[str, ...]

    def __len__(self) -> int:
        """Return the number of ellipses."""
        return len(self.ids)

    def colours(self, params: OverlayParams) -> FloatArray:
        """Return red, green, blue (n, 3) in [0, 1] by score."""
        return score_colours(self.score, params.score_low, params.score_high)

    def texts(self, params: OverlayParams) -> list[str]:
        """Return what is written at each, "#3 coin 0.97", as far as wanted.

        Examples
        --------
        >>> one = Shown(Ellipses.from_array([[9, 9, 4, 3, 0]]), np.array([0.97]), (3,), ("coin",))
        >>> one.texts(OverlayParams()), one.texts(OverlayParams(ids=False, scores=False))
        (['#3 coin 0.97'], ['coin'])
        """
        return [
            " ".join(filter(None, (f"#{i}" * params.ids, label, f"{s:.2f}" * params.scores)))
            for i, label, s in zip(self.ids, self.labels, self.score, strict=True)
        ]


def to_show(
    ellipses: EllipseDetections | None = None,
    detections: Detections | EllipseDetections | None = None,
    params: OverlayParams | None = None,
) -> Shown:
    """Return what is to be shown of a frame; an ellipse that is an object too comes once.

    Parameters
    ----------
    ellipses : EllipseDetections, optional
        Their places are the numbers.
    detections : Detections, optional
        Objects; one that is none of the ellipses gets a number after theirs. EllipseDetections
        stand for ellipses.
    params : OverlayParams, optional

    Raises
    ------
    InputError
        The results are of other types.

    Examples
    --------
    >>> disc = Ellipses.from_array([[20, 20, 12, 12, 0]])
    >>> coin = Detections(("coin",), score=[1.0], boxes=[[8, 8, 32, 32]], ellipses=disc)
    >>> to_show(detections=coin).labels
    ('coin',)
    """
    params = params or OverlayParams()
    if isinstance(detections, EllipseDetections):
        ellipses, detections = ellipses or detections, None
    found = _checked(ellipses, EllipseDetections) or EllipseDetections.empty()
    objects = _checked(detections, Detections) or _NO_OBJECTS
    rows = np.concatenate([found.ellipses.array(), objects.ellipses.array()])
    score = np.concatenate([found.score, objects.score])
    chosen = _numbers(rows, objects, len(found))
    if not params.ellipses:
        chosen = {i: label for i, label in chosen.items() if label}
    kept = list(chosen)
    labels = tuple(chosen.values()) if params.classes else ("",) * len(kept)
    return Shown(Ellipses.from_array(rows[kept]), score[kept], tuple(kept), labels)


def _numbers(rows: FloatArray, objects: Detections, count: int) -> dict[int, str]:
    """Return number -> class; the first `count` rows are ellipses, the others the objects."""
    known: dict[tuple[float, ...], int] = {}
    for i, row in enumerate(map(tuple, rows[:count].tolist())):
        known.setdefault(row, i)
    labels = dict.fromkeys(range(count), "")
    for k, row in enumerate(map(tuple, rows[count:].tolist())):
        labels[known.get(row, count + k)] = objects.labels[k]
    return labels


_NO_OBJECTS = Detections((), np.zeros(0), np.zeros((0, 4)), Ellipses.from_array(np.zeros((0, 5))))


def _checked(value: Any, kind: type[K]) -> K | None:
    if value is not None and not isinstance(value, kind):
        raise InputError(kind.__name__, f"{kind.__name__} or None", describe(value))
    return value
