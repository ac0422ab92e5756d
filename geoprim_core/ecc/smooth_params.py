"""Parameters of the split into smooth arcs, thesis 5.3."""

from __future__ import annotations

import math
from dataclasses import dataclass

from geoprim_core.params import Params, option


@dataclass(frozen=True)
class SmoothParams(Params):
    """Where a contour is split into arcs of smooth curvature (thesis 5.3.1 and 5.3.2)."""

    max_turn: float = option(
        math.pi / 2,
        "theta_0: split where the polygon turns by this much or more",
        unit="rad",
        low=0.0,
        high=math.pi,
    )
    inflexion_rule: str = option(
        "thesis",
        "turns are compared with the first one (thesis) or with the local majority",
        choices=("thesis", "majority"),
    )
    inflexion_window: int = option(
        2, "vertices on each side that make the local majority", low=1, high=100
    )
    inflexion_tolerance: float = option(
        0.0,
        "turns smaller than this have no sign",
        unit="rad",
        low=0.0,
        high=math.pi,
    )
    min_length: int = option(5, "shorter arcs are dropped", unit="px", low=1, high=100_000)
