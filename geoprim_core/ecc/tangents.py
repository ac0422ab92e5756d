"""Tangents of arcs: estimated where both neighbours exist, carried over to the ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geoprim_core._check import BoolArray, FloatArray
from geoprim_core.ecc import _kernels_grouping as kernels
from geoprim_core.ecc.arcs import Arcs
from geoprim_core.tangent import DebParams, estimate_tangents
from geoprim_core.types import Contours


@dataclass(frozen=True, slots=True, eq=False)
class ArcTangents:
    """Tangent directions of arcs, in radians, along the direction of travel.

    Attributes
    ----------
    angle : (N,) float64
        At every pixel of the arcs; NaN near the ends, where none is defined.
    ends : (K, 2) float64
        At the first and the last pixel of each arc: the nearest defined direction; NaN for an
        arc with none.
    """

    angle: FloatArray
    ends: FloatArray

    @property
    def defined(self) -> BoolArray:
        """True for the arcs that have a direction at both ends."""
        return np.asarray(np.isfinite(self.ends).all(axis=1))


def arc_tangents(arcs: Arcs, params: DebParams | None = None, method: str = "deb") -> ArcTangents:
    """Estimate the tangents of every arc and carry them over to its ends.

    The parameters are those of `deb`; other methods run with their own defaults.

    References
    ----------
    Thesis 5.4.1.1 (DEB with R = 4); errata C5 (there is no pixel beyond the end pixel).
    """
    curves = Contours(arcs.points, arcs.offsets, arcs.closed)
    angle = estimate_tangents(curves, method, params if method == "deb" else None).angle
    return ArcTangents(angle, kernels.end_directions(angle, arcs.offsets))
