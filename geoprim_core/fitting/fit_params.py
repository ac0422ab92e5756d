"""The parameters that every ellipse fit has: which ellipses are accepted."""

from __future__ import annotations

from dataclasses import dataclass

from geoprim_core.params import Params, option


@dataclass(frozen=True)
class FitParams(Params):
    """Limits on the axes; an ellipse beyond them becomes a reason (thesis 4.5.1, i and ii)."""

    max_semi_major: float = option(
        0.0, "largest semi-major axis that is accepted; 0: any", unit="px", low=0.0
    )
    min_axis_ratio: float = option(
        0.0, "least accepted ratio of the semi-minor to the semi-major axis", low=0.0, high=1.0
    )
