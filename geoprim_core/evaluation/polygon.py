"""Metrics of polygons: of a curve, an image, a data set, and against the optimal polygon."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import IntArray
from geoprim_core.errors import InputError
from geoprim_core.evaluation._kernels_polygon import segment_distances
from geoprim_core.polygon import OptimalParams, optimal
from geoprim_core.types import Contours, Polygons

SPANS = ("any_pair", "first_pixel")
"""Meanings of s_max: the text's, and the one with which the printed tables were made (P2)."""


@dataclass(frozen=True, slots=True)
class CurveMetrics:
    """How well a polygon represents one digital curve of M pixels with N vertices.

    Attributes
    ----------
    pixels, vertices : int
        M and N.
    max_deviation : float
        MD = max d in pixels, d being the distance of a pixel to the line through the two vertices
        between which it lies (2-9).
    ise : float
        Integral square error: sum of d^2 over all pixels (2-10), in px^2.
    precision : float
        Mean over the segments of sqrt(sum d^2 / m), m the pixels of the segment (2-1), (2-14).
    deviation_sum, span_sum : float
        Sums over the segments of sum d and of s_max, in pixels (2-17).
    """

    pixels: int
    vertices: int
    max_deviation: float
    ise: float
    precision: float
    deviation_sum: float
    span_sum: float

    @property
    def reliability(self) -> float:
        """Sum d over the sum of s_max (2-17); 0 where there is no extent at all."""
        return self.deviation_sum / self.span_sum if self.span_sum > 0 else 0.0

    @property
    def compression_ratio(self) -> float:
        """CR = pixels / vertices (2-11), its letters swapped as errata P3 says."""
        return self.pixels / self.vertices

    @property
    def reduction_ratio(self) -> float:
        """DR = 1 / CR (2-12)."""
        return self.vertices / self.pixels

    @property
    def figure_of_merit(self) -> float:
        """FOM = CR / ISE (2-13); infinite for a polygon through all pixels."""
        return self.compression_ratio / self.ise if self.ise > 0 else float("inf")

    @property
    def weighted_error(self) -> float:
        """WE = 1 / FOM = ISE / CR."""
        return self.ise / self.compression_ratio


@dataclass(frozen=True, slots=True)
class MeanMetrics:
    """Metrics of an image with several curves, or of a data set with several images.

    Attributes
    ----------
    count : int
        Curves of the image, or images of the set.
    compression_ratio, max_deviation, ise : float
        Means (2.2.4.3).
    figure_of_merit : float
        Mean over those where it is finite; NaN where it never is.
    precision : float
        Image: the largest of its curves (2-15). Set: the mean of its images (2-16).
    reliability : float
        Image: (2-17) over the segments of all its curves, for the thesis stops at the curve.
        Set: the mean of its images.
    """

    count: int
    compression_ratio: float
    max_deviation: float
    ise: float
    figure_of_merit: float
    precision: float
    reliability: float


@dataclass(frozen=True, slots=True)
class RelativeMetrics:
    """How close a polygon comes to the optimal ones, 1 being the optimum.

    Attributes
    ----------
    fidelity : float
        ISE of the optimal polygon of as many vertices / ISE.
    efficiency : float
        Fewest vertices with which an ISE as small can be had / vertices.
    """

    fidelity: float
    efficiency: float

    @property
    def merit(self) -> float:
        """The geometric mean of fidelity and efficiency."""
        return float(np.sqrt(self.fidelity * self.efficiency))


@dataclass(frozen=True, slots=True)
class MeanRelative:
    """Means of the comparison with the optimum: of an image's curves, or of a set's images.

    Attributes
    ----------
    count : int
        Curves of the image, or images of the set.
    fidelity, efficiency, merit : float
    """

    count: int
    fidelity: float
    efficiency: float
    merit: float


def measure_polygon(
    points: npt.ArrayLike,
    indices: npt.ArrayLike,
    *,
    closed: bool = False,
    span: str = "any_pair",
) -> CurveMetrics:
    """Measure the polygon of one curve.

    Parameters
    ----------
    points : (n, 2) array
        Pixels of the curve, at least one.
    indices : (m,) array
        Indices of the vertices, strictly increasing.
    closed : bool
    span : {"any_pair", "first_pixel"}
        s_max as the largest distance between two pixels of a segment, or from its first.

    Raises
    ------
    InputError
        No points, indices that do not increase within the curve, an open curve whose ends are
        missing, or an unknown span.

    References
    ----------
    Thesis (2-1), (2-2), (2-9) - (2-14), (2-17); errata P1 - P3: true distances, root mean square.

    Examples
    --------
    >>> tent = [(0, 0), (1, 1), (2, 0)]
    >>> metrics = measure_polygon(tent, [0, 2])
    >>> metrics.max_deviation, metrics.ise, metrics.compression_ratio, metrics.reliability
    (1.0, 1.0, 1.5, 0.5)
    """
    curve = _check.points(points)
    vertices = _vertices(indices, len(curve), bool(closed))
    if span not in SPANS:
        raise InputError("span", "one of " + ", ".join(SPANS), _check.describe(span))
    rows = segment_distances(curve, vertices, bool(closed), span == "any_pair")
    if len(rows) == 0:
        return CurveMetrics(len(curve), len(vertices), 0.0, 0.0, 0.0, 0.0, 0.0)
    count, largest, squares, total, extent = rows.T
    return CurveMetrics(
        len(curve),
        len(vertices),
        float(largest.max()),
        float(squares.sum()),
        float(np.sqrt(squares / count).mean()),
        float(total.sum()),
        float(extent.sum()),
    )


def _vertices(indices: npt.ArrayLike, count: int, closed: bool) -> IntArray:
    vertices = _check.integers(indices, "indices")
    if len(vertices) == 0 or (np.diff(vertices) <= 0).any() or not vertices[0] >= 0:
        raise InputError("indices", "at least one index, strictly increasing", "others")
    if vertices[-1] >= count or (not closed and (vertices[0], vertices[-1]) != (0, count - 1)):
        expected = f"indices below {count}, on an open curve both ends among them"
        raise InputError("indices", expected, f"{vertices[0]} ... {vertices[-1]}")
    return vertices


def measure_image(contours: Contours, polygons: Polygons, *, span: str = "any_pair") -> MeanMetrics:
    """Measure the polygons of all curves of an image; curves without pixels are left out.

    Raises
    ------
    InputError
        No curve has pixels, or the polygons are not those of the contours.

    References
    ----------
    Thesis (2-15), 2.2.4.3.

    Examples
    --------
    >>> contours = Contours([(0, 0), (1, 1), (2, 0)], [0, 3], [False])
    >>> measure_image(contours, Polygons([0, 2], [0, 2], [False])).compression_ratio
    1.5
    """
    if len(contours) != len(polygons):
        raise InputError("polygons", f"{len(contours)} polygons", f"{len(polygons)}")
    return image_metrics(
        [
            measure_polygon(curve, polygons[k], closed=bool(contours.closed[k]), span=span)
            for k, curve in enumerate(contours)
            if len(curve)
        ]
    )


def image_metrics(curves: Sequence[CurveMetrics]) -> MeanMetrics:
    """Return the metrics of an image from those of its curves; as `measure_image`.

    Examples
    --------
    >>> tent = measure_polygon([(0, 0), (1, 1), (2, 0)], [0, 2])
    >>> line = measure_polygon([(0, 0), (1, 0)], [0, 1])
    >>> image_metrics([tent, line]).max_deviation
    0.5
    """
    if not curves:
        raise InputError("curves", "at least one curve", "none")
    spans = sum(c.span_sum for c in curves)
    return MeanMetrics(
        len(curves),
        *_means(curves),
        max(c.precision for c in curves),
        sum(c.deviation_sum for c in curves) / spans if spans > 0 else 0.0,
    )


def set_metrics(images: Sequence[MeanMetrics]) -> MeanMetrics:
    """Return the metrics of a data set from those of its images (2-16), 2.2.4.3.

    Raises
    ------
    InputError
        There is no image.

    Examples
    --------
    >>> tent = image_metrics([measure_polygon([(0, 0), (1, 1), (2, 0)], [0, 2])])
    >>> set_metrics([tent, tent]).count
    2
    """
    if not images:
        raise InputError("images", "at least one image", "none")
    return MeanMetrics(
        len(images),
        *_means(images),
        float(np.mean([m.precision for m in images])),
        float(np.mean([m.reliability for m in images])),
    )


def _means(
    parts: Sequence[CurveMetrics] | Sequence[MeanMetrics],
) -> tuple[float, float, float, float]:
    merits = [part.figure_of_merit for part in parts if np.isfinite(part.figure_of_merit)]
    names = ("compression_ratio", "max_deviation", "ise")
    ratio, deviation, ise = (float(np.mean([getattr(p, name) for p in parts])) for name in names)
    return ratio, deviation, ise, float(np.mean(merits)) if merits else float("nan")


def relative_metrics(
    points: npt.ArrayLike, indices: npt.ArrayLike, *, closed: bool = False
) -> RelativeMetrics:
    """Compare a polygon with the optimal ones of as many vertices and of as small an ISE.

    Raises
    ------
    InputError
        As `measure_polygon` and `optimal`.

    References
    ----------
    P. L. Rosin, "Techniques for assessing polygonal approximations of curves", IEEE Transactions
    on Pattern Analysis and Machine Intelligence 19, 1997 (there in percent); thesis 2.1.1. The
    fewest vertices are a whole number here, not interpolated.

    Examples
    --------
    >>> corner = [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (4, 1), (4, 2), (4, 3), (4, 4)]
    >>> relative_metrics(corner, [0, 4, 8]).merit
    1.0
    """
    curve = _check.points(points)
    own = measure_polygon(curve, indices, closed=closed)
    best = optimal(curve, closed=closed, params=OptimalParams(max(own.vertices, 2), measure="ise"))
    least = measure_polygon(curve, best, closed=closed).ise
    enough = OptimalParams(tolerance=own.ise, measure="ise")
    fewest = len(optimal(curve, closed=closed, params=enough))
    fidelity = least / own.ise if own.ise > 0 else 1.0
    return RelativeMetrics(fidelity, fewest / own.vertices)


def mean_relative(parts: Sequence[RelativeMetrics] | Sequence[MeanRelative]) -> MeanRelative:
    """Return the means of an image over its curves, or of a data set over its images.

    Raises
    ------
    InputError
        There is nothing to take the mean of.

    References
    ----------
    Thesis 2.2.4.3, as for the other metrics that are given there.

    Examples
    --------
    >>> mean_relative([RelativeMetrics(1.0, 1.0), RelativeMetrics(0.25, 1.0)]).merit
    0.75
    """
    if not parts:
        raise InputError("parts", "at least one curve or image", "none")
    names = ("fidelity", "efficiency", "merit")
    return MeanRelative(
        len(parts), *(float(np.mean([getattr(part, name) for part in parts])) for name in names)
    )
