"""What is found in an image: ellipses with their evidence, labelled objects."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from geoprim_core import _check
from geoprim_core._check import FloatArray, IntArray
from geoprim_core.errors import InputError
from geoprim_core.types.ellipses import Ellipses
from geoprim_core.types.frozen import Frozen


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class EllipseDetections(Frozen):
    """Ellipses found in an image, best first.

    Attributes
    ----------
    ellipses : Ellipses, n of them
    score : (n,) float64
        In [0, 1], larger is better; of the `refined` scheme the probability that the ellipse is
        right (overlap ratio of 0.8 or more with a true one).
    coverage, alignment, continuity : (n,) float64
        The saliency criteria of thesis 5.5.2: angular circumference ratio (5-10), alignment
        ratio (5-12) and angular continuity ratio (5-13), each in [0, 1].
    covariance : (n, 5, 5) float64
        Covariance of x, y, semi_major, semi_minor (pixels) and angle (radians) from the edge
        residuals; NaN where it is not known. Of a near circle, whose axes are told apart by
        chance, it describes x, y, the mean of the axes and half their difference as a vector at
        twice the angle.
    image_size : (width, height) in pixels or None
    complete : bool
        False where a bound on the work left something out, so that ellipses may be missing.
    reason : str
        Which bound, and how much it left out; empty where nothing was.
    """

    ellipses: Ellipses
    score: FloatArray
    coverage: FloatArray
    alignment: FloatArray
    continuity: FloatArray
    covariance: FloatArray
    image_size: tuple[int, int] | None = None
    complete: bool = True
    reason: str = ""

    def __post_init__(self) -> None:
        count = len(self.ellipses)
        for name in ("score", "coverage", "alignment", "continuity"):
            values = _check.finite(getattr(self, name), name, (count,))
            if count and not (values.min() >= 0.0 and values.max() <= 1.0):
                raise InputError(name, "numbers in [0, 1]", f"{values.min()} to {values.max()}")
            self._set(**{name: values})
        self._set(
            covariance=_check.numbers(self.covariance, "covariance", (count, 5, 5)),
            image_size=_check.image_size(self.image_size),
            complete=bool(self.complete),
            reason=str(self.reason),
        )
        if self.complete and self.reason:
            raise InputError("reason", "no text where the result is complete", repr(self.reason))

    def __len__(self) -> int:
        """Return the number of detections."""
        return len(self.ellipses)

    @classmethod
    def empty(cls, image_size: tuple[int, int] | None = None) -> EllipseDetections:
        """Return detections of nothing."""
        none = np.zeros(0)
        ellipses = Ellipses(none, none, none, none, none)
        return cls(ellipses, none, none, none, none, np.zeros((0, 5, 5)), image_size)

    def select(self, chosen: Any) -> EllipseDetections:
        """Return the detections at the given indices or where the mask is true."""
        return EllipseDetections(
            self.ellipses.select(chosen),
            self.score[chosen],
            self.coverage[chosen],
            self.alignment[chosen],
            self.continuity[chosen],
            self.covariance[chosen],
            self.image_size,
            self.complete,
            self.reason,
        )


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Detections(Frozen):
    """Labelled objects found in an image.

    Attributes
    ----------
    labels : n texts
    score : (n,) float64, in [0, 1]
    boxes : (n, 4) float64
        x_min, y_min, x_max, y_max in pixels.
    ellipses : Ellipses, n of them
    polygons : (P, 2) float64
        Outline polygons of all objects, flat.
    polygon_offsets : (n + 1,) int64
        The polygon of object i is `polygons[polygon_offsets[i]:polygon_offsets[i + 1]]`.
    size : (n, 2) float64
        Length and width in metres on the working plane; NaN where the camera is not known.
    image_size : (width, height) in pixels or None
    """

    labels: tuple[str, ...]
    score: FloatArray
    boxes: FloatArray
    ellipses: Ellipses
    polygons: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    polygon_offsets: IntArray | None = None
    size: FloatArray | None = None
    image_size: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        count = len(self.ellipses)
        polygons = _check.points(self.polygons, "polygons")
        offsets = np.zeros(count + 1) if self.polygon_offsets is None else self.polygon_offsets
        size = np.full((count, 2), np.nan) if self.size is None else self.size
        self._set(
            labels=tuple(str(label) for label in self.labels),
            score=_check.finite(self.score, "score", (count,)),
            boxes=_check.finite(self.boxes, "boxes", (count, 4)),
            polygons=polygons,
            polygon_offsets=_check.offsets(offsets, len(polygons), "polygon_offsets"),
            size=_check.numbers(size, "size", (count, 2)),
            image_size=_check.image_size(self.image_size),
        )
        if len(self.labels) != count or len(self.polygon_offsets) != count + 1:  # type: ignore[arg-type]
            raise InputError("labels, polygon_offsets", f"{count} objects", "another number")

    def __len__(self) -> int:
        """Return the number of objects."""
        return len(self.ellipses)


@dataclass(frozen=True, slots=True, eq=False)
class Camera:
    """A pinhole camera above a working plane, both axes square to it.

    Attributes
    ----------
    fx, fy, cx, cy : float
        Focal lengths and principal point in pixels.
    distance : float
        Distance of the working plane from the camera along its axis, in metres.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    distance: float

    def __post_init__(self) -> None:
        if not (self.fx > 0 and self.fy > 0 and self.distance > 0):
            got = f"{self.fx}, {self.fy}, {self.distance}"
            raise InputError("fx, fy, distance", "positive numbers", got)
