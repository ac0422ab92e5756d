"""Thesis 5.3: contours are split into arcs of smooth curvature.

Sharp turns (5.3.1) and inflexion points (5.3.2) are sought among the vertices of the contour's
polygonal approximation.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from geoprim_core import _check
from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core.ecc import _kernels_arcs as kernels
from geoprim_core.ecc.smooth_params import SmoothParams
from geoprim_core.errors import InputError
from geoprim_core.params import as_params
from geoprim_core.types import Contours, Polygons


@dataclass(frozen=True, slots=True, eq=False)
class Arcs:
    """Arcs of smooth curvature, cut out of contours; their points are copies.

    Attributes
    ----------
    points : (N, 2) float64
        Pixels of all arcs in order along each; an arc may run across the seam of its contour.
    offsets : (K + 1,) int64
        Arc k is `points[offsets[k]:offsets[k + 1]]`.
    contour : (K,) int64
        The contour that each arc comes from.
    closed : (K,) bool
        True for a whole closed contour without any split.
    rows : (N,) int64
        Row of every point in the flat arrays of the contours.
    subpixel : (N, 2) float64 or None
    gradient_angle : (N,) float64 or None
        Both as in the contours.
    image_size : (width, height) in pixels or None
    """

    points: FloatArray
    offsets: IntArray
    contour: IntArray
    closed: BoolArray
    rows: IntArray
    subpixel: FloatArray | None = None
    gradient_angle: FloatArray | None = None
    image_size: tuple[int, int] | None = None

    def __len__(self) -> int:
        """Return the number of arcs."""
        return len(self.offsets) - 1

    def __getitem__(self, index: int) -> FloatArray:
        """Return the pixels (n, 2) of one arc, a view."""
        count = len(self)
        if not -count <= index < count:
            raise IndexError(f"arc {index} of {count}")
        index %= count
        return self.points[self.offsets[index] : self.offsets[index + 1]]

    def __iter__(self) -> Iterator[FloatArray]:
        """Iterate over the pixels (n, 2) of each arc."""
        return (self[k] for k in range(len(self)))

    @property
    def positions(self) -> FloatArray:
        """The best known edge positions (N, 2): sub-pixel ones where there are any."""
        return self.points if self.subpixel is None else self.subpixel

    def select(self, chosen: IntArray | BoolArray) -> Arcs:
        """Return the arcs at the given indices or where the mask is true."""
        chosen = np.arange(len(self))[chosen]
        lengths = np.diff(self.offsets)[chosen]
        offsets = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64)
        inside = np.arange(offsets[-1]) + np.repeat(self.offsets[chosen] - offsets[:-1], lengths)
        return Arcs(
            self.points[inside],
            offsets,
            self.contour[chosen],
            self.closed[chosen],
            self.rows[inside],
            None if self.subpixel is None else self.subpixel[inside],
            None if self.gradient_angle is None else self.gradient_angle[inside],
            self.image_size,
        )


def split_arcs(contours: Contours, polygons: Polygons, params: SmoothParams | None = None) -> Arcs:
    """Split contours into smooth arcs at the sharp turns and inflexion points of their polygons.

    Every pixel belongs to at most one arc: a split point starts the arc that follows it. A
    closed contour without any split stays one closed arc.

    Parameters
    ----------
    contours : Contours
    polygons : Polygons
        Polygonal approximation of the same contours.
    params : SmoothParams, optional

    Raises
    ------
    InputError
        There are not as many polygons as contours, or a vertex lies outside its contour.

    References
    ----------
    Thesis 5.3.1, 5.3.2, (5-1), Table 5.3-1; errata C1 (`inflexion_rule`), C2.

    Examples
    --------
    >>> corner = [(x, 0) for x in range(9)] + [(8, y) for y in range(1, 9)]
    >>> contours = Contours(corner, [0, 17], [False])
    >>> arcs = split_arcs(contours, Polygons([0, 8, 16], [0, 3], [False]))
    >>> arcs.offsets.tolist(), arcs[1][0].tolist()
    ([0, 8, 17], [8.0, 0.0])
    """
    chosen: SmoothParams = as_params(params, SmoothParams)
    _check_pair(contours, polygons)
    table = kernels.split_contours(
        contours.points,
        contours.offsets,
        polygons.indices,
        polygons.offsets,
        contours.closed & polygons.closed,
        chosen.max_turn,
        chosen.inflexion_rule == "majority",
        chosen.inflexion_window,
        chosen.inflexion_tolerance,
        chosen.min_length,
    )
    return _gathered(contours, table)


def _check_pair(contours: Contours, polygons: Polygons) -> None:
    if len(contours) != len(polygons):
        raise InputError("polygons", f"{len(contours)} polygons", f"{len(polygons)}")
    length = np.repeat(np.diff(contours.offsets), np.diff(polygons.offsets))
    outside = np.flatnonzero(polygons.indices >= length)
    if len(outside):
        got = f"index {polygons.indices[outside[0]]} of {length[outside[0]]} points"
        raise InputError("polygons", "indices within their contours", got)


def _gathered(contours: Contours, table: IntArray) -> Arcs:
    rows = kernels.gather_rows(contours.offsets, table)
    offsets = np.concatenate([[0], np.cumsum(table[:, 2])]).astype(np.int64)
    return Arcs(
        contours.points[rows],
        _check.offsets(offsets, len(rows)),
        table[:, 0].copy(),
        table[:, 3] == 1,
        rows,
        None if contours.subpixel is None else contours.subpixel[rows],
        None if contours.gradient_angle is None else contours.gradient_angle[rows],
        contours.image_size,
    )
