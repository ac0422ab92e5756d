"""Curves in an image: contours, their polygons and tangents."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from geoprim_core import _check
from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core.errors import InputError
from geoprim_core.types.frozen import Frozen


def _flags(value: Any, count: int, argument: str) -> BoolArray:
    array = np.asarray(value)
    if array.ndim == 0:
        array = np.full(count, bool(value))
    if array.size == 0:
        array = array.astype(bool)
    if array.dtype != np.bool_ or array.shape != (count,):
        raise InputError(argument, f"{count} flags, one a curve", _check.describe(value))
    return np.ascontiguousarray(array)


def _part(offsets: IntArray, index: int, noun: str) -> slice:
    count = len(offsets) - 1
    if not -count <= index < count:
        raise IndexError(f"{noun} {index} of {count}")
    return slice(offsets[index % count], offsets[index % count + 1])


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Contours(Frozen):
    """Edge contours (digital curves) of one image.

    Attributes
    ----------
    points : (N, 2) float64
        Pixels of all contours in order along each; neighbours on a contour are 8-connected.
    offsets : (K + 1,) int64
        Contour k is `points[offsets[k]:offsets[k + 1]]`.
    closed : (K,) bool
        True where the last pixel of a contour touches its first. The first is not repeated.
    image_size : (width, height) in pixels or None
    subpixel : (N, 2) float64 or None
        Edge position of every pixel, within half a pixel of it.
    gradient_angle : (N,) float64 or None
        Direction of the grey-level gradient at every pixel, from dark to bright, in radians.
    blur : float
        Standard deviation in pixels of the Gaussian blur before the gradient; NaN: not known.
    softness : float
        Standard deviation in pixels of all the smoothing that most edges show, that of the picture
        and that of the edge stage; NaN: not known.
    gradient_magnitude : (N,) float64 or None
        Length of the grey-level gradient at every pixel, in grey levels per pixel.
    """

    points: FloatArray
    offsets: IntArray
    closed: BoolArray
    image_size: tuple[int, int] | None = None
    subpixel: FloatArray | None = None
    gradient_angle: FloatArray | None = None
    blur: float = float("nan")
    softness: float = float("nan")
    gradient_magnitude: FloatArray | None = None

    def __post_init__(self) -> None:
        points = _check.points(self.points)
        offsets = _check.offsets(self.offsets, len(points))
        self._set(
            points=points,
            offsets=offsets,
            closed=_flags(self.closed, len(offsets) - 1, "closed"),
            image_size=_check.image_size(self.image_size),
        )
        if self.subpixel is not None:
            self._set(subpixel=_check.finite(self.subpixel, "subpixel", (len(points), 2)))
        for name in ("gradient_angle", "gradient_magnitude"):
            if getattr(self, name) is not None:
                self._set(**{name: _check.finite(getattr(self, name), name, (len(points),))})
        for name in ("blur", "softness"):
            value = float(getattr(self, name))
            if value < 0.0:
                raise InputError(name, "0 px or more, or NaN", f"{value}")
            self._set(**{name: value})

    def __len__(self) -> int:
        """Return the number of contours."""
        return len(self.offsets) - 1

    def __getitem__(self, index: int) -> FloatArray:
        """Return the pixels (n, 2) of one contour, a view."""
        return self.points[_part(self.offsets, index, "contour")]

    def __iter__(self) -> Iterator[FloatArray]:
        """Iterate over the pixels (n, 2) of each contour."""
        return (self[k] for k in range(len(self)))

    @classmethod
    def from_curves(
        cls, curves: Sequence[Any], closed: Any = False, image_size: tuple[int, int] | None = None
    ) -> Self:
        """Build from point arrays (n, 2), one a curve, and one flag for all or one for each.

        Raises
        ------
        InputError
            A curve is no array of points, or there is not one flag a curve.

        Examples
        --------
        >>> pair = Contours.from_curves([[(0, 0), (1, 0)], [(5, 5), (6, 6), (7, 6)]])
        >>> len(pair), pair.offsets.tolist(), pair[1].tolist()[0]
        (2, [0, 2, 5], [5.0, 5.0])
        """
        parts = [_check.points(c, f"curves[{k}]") for k, c in enumerate(curves)]
        offsets = np.cumsum([0, *map(len, parts)])
        return cls(np.concatenate([np.empty((0, 2)), *parts]), offsets, closed, image_size)

    @property
    def positions(self) -> FloatArray:
        """The best known edge positions (N, 2): sub-pixel ones where there are any."""
        return self.points if self.subpixel is None else self.subpixel


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Polygons(Frozen):
    """Polygonal approximations: for each contour the indices of its dominant points.

    Attributes
    ----------
    indices : (M,) int64
        Point indices *within the contour*, strictly increasing along each polygon.
    offsets : (K + 1,) int64
        Polygon k is `indices[offsets[k]:offsets[k + 1]]` and belongs to contour k.
    closed : (K,) bool
        True where an edge leads from the last vertex back to the first.
    image_size : (width, height) in pixels or None
    """

    indices: IntArray
    offsets: IntArray
    closed: BoolArray
    image_size: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        indices = _check.integers(self.indices, "indices")
        offsets = _check.offsets(self.offsets, len(indices))
        self._set(
            indices=indices,
            offsets=offsets,
            closed=_flags(self.closed, len(offsets) - 1, "closed"),
            image_size=_check.image_size(self.image_size),
        )
        inner = np.ones(len(indices), bool)
        inner[offsets[:-1][offsets[:-1] < len(indices)]] = False
        falls = (np.diff(indices) <= 0) & inner[1:]
        if falls.any() or (indices < 0).any():
            raise InputError("indices", "indices that increase along each polygon", "others")

    def __len__(self) -> int:
        """Return the number of polygons."""
        return len(self.offsets) - 1

    def __getitem__(self, index: int) -> IntArray:
        """Return the vertex indices (m,) of one polygon within its contour, a view."""
        return self.indices[_part(self.offsets, index, "polygon")]

    def vertices(self, contours: Contours) -> FloatArray:
        """Return the vertices (M, 2) of all polygons, in the order of `indices`."""
        if len(contours) != len(self):
            raise InputError("contours", f"{len(self)} contours", f"{len(contours)}")
        starts = np.repeat(contours.offsets[:-1], np.diff(self.offsets))
        vertices: FloatArray = contours.points[starts + self.indices]
        return vertices


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Tangents(Frozen):
    """Tangent directions of every contour pixel.

    Attributes
    ----------
    angle : (N,) float64
        Direction of travel in radians, in (-pi, pi]; NaN where it is not defined.
    offsets : (K + 1,) int64
        As in the contours.
    """

    angle: FloatArray
    offsets: IntArray

    def __post_init__(self) -> None:
        angle = _check.numbers(self.angle, "angle", (None,))
        self._set(angle=angle, offsets=_check.offsets(self.offsets, len(angle)))

    def __len__(self) -> int:
        """Return the number of contours."""
        return len(self.offsets) - 1

    def __getitem__(self, index: int) -> FloatArray:
        """Return the angles (n,) along one contour, a view."""
        return self.angle[_part(self.offsets, index, "contour")]
