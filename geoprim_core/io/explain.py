"""Why an ellipse was found or lost: the trace of a detection as pictures and a table."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from geoprim_core import _check
from geoprim_core._check import AnyArray, BoolArray, FloatArray, IntArray
from geoprim_core.ecc import DetectorParams, trace_detection
from geoprim_core.ecc.refined import RefinedTrace
from geoprim_core.ecc.schemes import SchemeTrace
from geoprim_core.io.drawing import draw_overlay
from geoprim_core.io.shown import OverlayParams
from geoprim_core.types import EllipseDetections, Ellipses

_DIM = 0.35  # of the image's brightness, under coloured arcs
# Colours that neighbours in an arbitrary order are told apart by: blue, green, red.
_COLOURS = np.array(
    [(80, 80, 255), (80, 255, 80), (255, 160, 60), (60, 220, 255), (255, 90, 255), (220, 255, 120)],
    np.uint8,
)


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """An elliptic hypothesis that was judged: its measures, and why it is not reported.

    `reason` is empty for those that are.
    """

    x: float
    y: float
    semi_major: float
    semi_minor: float
    angle: float
    score: float
    coverage: float
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class Explanation:
    """The steps of a detection.

    Attributes
    ----------
    pictures : dict
        Name of the step -> (H, W, 3) uint8 picture, in the order of the steps.
    hypotheses : tuple of Hypothesis
        All that were judged, best first.
    detections : EllipseDetections
    """

    pictures: dict[str, AnyArray]
    hypotheses: tuple[Hypothesis, ...]
    detections: EllipseDetections


def explain_detection(image: AnyArray, params: DetectorParams | None = None) -> Explanation:
    """Detect ellipses and show every step.

    Parameters
    ----------
    image : (H, W), (H, W, 3) or (H, W, 4) uint8, uint16, float32 or float64
    params : DetectorParams, optional

    Returns
    -------
    Explanation
        Pictures `edges`, `contours`, `arcs`, `hypotheses` and `detections`, as in Figures 5.5-3
        and 5.5-4 of the thesis.

    Raises
    ------
    ImageError
        As `detect_ellipses`.

    Examples
    --------
    >>> y, x = np.mgrid[:60, :80]
    >>> disc = np.clip(20.5 - np.hypot(x - 40, y - 30), 0, 1)
    >>> explained = explain_detection((255 * disc).astype(np.uint8))
    >>> list(explained.pictures), [h.reason for h in explained.hypotheses]
    (['edges', 'contours', 'arcs', 'hypotheses', 'detections'], [''])
    """
    image = _check.image(image)
    trace = trace_detection(image, params)
    hypotheses = judged_hypotheses(trace.ecc)
    pictures = {
        "edges": np.repeat(draw_edges(trace.edges.edges)[:, :, None], 3, axis=2),
        "contours": _coloured(image, trace.contours.points, _labels(trace.contours.offsets)),
        "arcs": draw_arcs(image, trace.ecc),
        "hypotheses": draw_hypotheses(image, hypotheses),
        "detections": draw_overlay(image, ellipses=trace.detections),
    }
    return Explanation(pictures, hypotheses, trace.detections)


def draw_edges(edges: BoolArray) -> AnyArray:
    """Return the (H, W) uint8 picture of an edge map, white on black."""
    return np.where(edges, np.uint8(255), np.uint8(0))


def draw_arcs(image: AnyArray, trace: SchemeTrace | RefinedTrace) -> AnyArray:
    """Return the dimmed (H, W, 3) image with every smooth arc in a colour of its own."""
    return _coloured(image, *_arc_points(trace))


def draw_hypotheses(image: AnyArray, hypotheses: tuple[Hypothesis, ...]) -> AnyArray:
    """Return the (H, W, 3) image with every hypothesis and its saliency."""
    # Saliencies of the refused ones fill the whole scale; they have no numbers in any message.
    params = OverlayParams(score_low=0.0, ids=False)
    return draw_overlay(image, ellipses=_as_detections(hypotheses), params=params)


def judged_hypotheses(trace: SchemeTrace | RefinedTrace) -> tuple[Hypothesis, ...]:
    """Return the hypotheses that were judged: the reported ones first, each part best first."""
    if isinstance(trace, SchemeTrace):
        found = _scheme_hypotheses(trace)
    else:
        found = _refined_hypotheses(trace)
    return tuple(sorted(found, key=lambda h: (bool(h.reason), -h.score)))


def _refined_hypotheses(trace: RefinedTrace) -> Iterator[Hypothesis]:
    score, figures = trace.verified.score.tolist(), trace.verified.figures
    for k, (x, y, major, minor, angle) in enumerate(trace.verified.ellipses.tolist()):
        figure = score[k], float(figures[k, 1])
        yield Hypothesis(x, y, major, minor, angle, *figure, trace.selection.reasons[k])


def _scheme_hypotheses(trace: SchemeTrace) -> Iterator[Hypothesis]:
    net, coverage = trace.saliency.mean.tolist(), trace.saliency.circumference.tolist()
    for k, (x, y, major, minor, angle) in enumerate(trace.distinct.ellipses.tolist()):
        reason = "" if trace.selected[k] else "not selected: less salient than the others (5-16)"
        yield Hypothesis(x, y, major, minor, angle, net[k], coverage[k], reason)


def _arc_points(trace: SchemeTrace | RefinedTrace) -> tuple[FloatArray, IntArray]:
    """Return the points of all smooth arcs and the arc of each."""
    if isinstance(trace, SchemeTrace):
        return trace.arcs.points, _labels(trace.arcs.offsets)
    return trace.edges.points[trace.arcs.indices], _labels(trace.arcs.offsets)


def _labels(offsets: IntArray) -> IntArray:
    return np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))


def _coloured(image: AnyArray, points: FloatArray, labels: IntArray) -> AnyArray:
    """Return the dimmed image with every curve in a colour of its own."""
    picture = (draw_overlay(image) * _DIM).astype(np.uint8)
    height, width = picture.shape[:2]
    x, y = np.rint(points).astype(np.int64).T
    inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
    picture[y[inside], x[inside]] = _COLOURS[labels[inside] % len(_COLOURS)]
    return picture


def _as_detections(hypotheses: tuple[Hypothesis, ...]) -> EllipseDetections:
    rows = [(h.x, h.y, h.semi_major, h.semi_minor, h.angle) for h in hypotheses]
    score = np.array([h.score for h in hypotheses])
    ones = np.ones(len(rows))
    unknown = np.full((len(rows), 5, 5), np.nan)
    return EllipseDetections(Ellipses.from_array(rows), score, ones, ones, ones, unknown)
