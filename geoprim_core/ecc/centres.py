"""Thesis 5.4.3: centres of elliptic hypotheses by Yuen's three-point method (3.2.1)."""

from __future__ import annotations

import math

from geoprim_core._check import FloatArray
from geoprim_core.ecc import _kernels_votes as kernels
from geoprim_core.ecc.arcs import Arcs
from geoprim_core.ecc.grouping_params import GroupingParams
from geoprim_core.ecc.tangents import ArcTangents


def find_centres(arcs: Arcs, tangents: ArcTangents, params: GroupingParams) -> FloatArray:
    """Return the centres (K, S, 2) that S point triples of every arc give, NaN for none.

    The pixels with a tangent are cut into thirds and one is taken from each, S times. The
    choice follows a fixed evenly spread sequence, so that two runs agree.

    References
    ----------
    Thesis 5.4.3; errata C6 (systematic choice), T4.
    """
    return kernels.arc_centres(
        arcs.points,
        tangents.angle,
        arcs.offsets,
        params.sets,
        math.sin(params.min_tangent_angle),
    )
