"""Thesis 5.4.2: associated convexity of two arcs, they bow away from each other."""

from __future__ import annotations

from geoprim_core._check import BoolArray
from geoprim_core.ecc import _kernels_grouping as kernels
from geoprim_core.ecc.arcs import Arcs
from geoprim_core.ecc.grouping_params import GroupingParams


def find_associated(arcs: Arcs, candidates: BoolArray, params: GroupingParams) -> BoolArray:
    """Return those candidate pairs (K, K) whose arcs have associated convexity.

    The line through the middles of the two chords meets the arcs at P1' and P2' (their pixels
    nearest to it); seen along it, the chords must lie between the arcs.

    References
    ----------
    Thesis 5.4.2, (5-3); errata C3 (the tolerance, in pixels).
    """
    return kernels.associated_pairs(
        arcs.points, arcs.offsets, candidates, params.convexity_tolerance
    )
