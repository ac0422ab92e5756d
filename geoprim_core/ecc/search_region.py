"""Thesis 5.4.1: the search region of an arc, and the arcs inside it."""

from __future__ import annotations

from dataclasses import dataclass

from geoprim_core._check import BoolArray, FloatArray
from geoprim_core.ecc import _kernels_grouping as kernels
from geoprim_core.ecc.arcs import Arcs
from geoprim_core.ecc.grouping_params import GroupingParams
from geoprim_core.ecc.tangents import ArcTangents


@dataclass(frozen=True, slots=True, eq=False)
class SearchRegions:
    """The search region of every arc: where three half-planes meet.

    Attributes
    ----------
    half_planes : (K, 3, 3) float64
        Rows (nx, ny, c): the side n . p >= c of l1, l2 (tangents at the ends) and l3 (chord).
    defined : (K,) bool
        False for closed arcs, straight arcs and arcs without tangents: nothing is grouped with
        them.
    """

    half_planes: FloatArray
    defined: BoolArray


def find_search_regions(arcs: Arcs, tangents: ArcTangents) -> SearchRegions:
    """Find the search region of every arc.

    It is the region that l1, l2 and l3 bound and that does not hold the middle pixel of the arc.

    References
    ----------
    Thesis 5.4.1.1, (5-2); errata C5.
    """
    half_planes, defined = kernels.search_regions(
        arcs.points, arcs.offsets, arcs.closed, tangents.ends
    )
    return SearchRegions(half_planes, defined)


def find_arcs_inside(
    arcs: Arcs, regions: SearchRegions, candidates: BoolArray, params: GroupingParams
) -> BoolArray:
    """Return those candidate pairs (K, K) whose arc j lies completely in the region of arc k.

    References
    ----------
    Thesis 5.4.1.2, S1-S3.
    """
    return kernels.arcs_inside(
        arcs.points,
        arcs.offsets,
        regions.half_planes,
        regions.defined,
        candidates,
        params.region_tolerance,
    )
