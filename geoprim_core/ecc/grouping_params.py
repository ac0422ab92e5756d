"""Parameters of grouping, saliency and selection, thesis 5.4 and 5.5."""

from __future__ import annotations

from dataclasses import dataclass

from geoprim_core.params import Params, option


@dataclass(frozen=True)
class GroupingParams(Params):
    """How arcs are grouped and fitted (thesis 5.4)."""

    region_tolerance: float = option(
        1.0,
        "how far a pixel may lie outside the search region",
        unit="px",
        low=0.0,
        high=1000.0,
    )
    convexity_tolerance: float = option(
        1.0, "allowed difference of the two sides of (5-3)", unit="px", low=0.0, high=1000.0
    )
    sets: int = option(200, "S: point triples drawn from every arc", low=1, high=10_000)
    min_tangent_angle: float = option(
        0.2,
        "tangents that differ by less count as parallel",
        unit="rad",
        low=0.0,
        high=1.5,
    )
    bin_size: float = option(25.0, "side of a centre bin", unit="px", low=1.0, high=10_000.0)
    min_bin_score: float = option(
        0.01, "bins below this share of the best bin's score are ignored", low=0.0, high=1.0
    )
    max_residual: float = option(
        0.08,
        "epsilon_ls: largest root mean square of the conic that is -1 at its centre",
        low=0.0,
        high=10.0,
    )
    max_group: int = option(
        40, "largest number of arcs in a group, strongest first", low=1, high=64
    )
    max_arcs: int = option(3000, "only so many arcs are grouped, longest first", low=1, high=8000)


@dataclass(frozen=True)
class SaliencyParams(Params):
    """How hypotheses are merged, scored and selected (thesis 5.5)."""

    min_similarity: float = option(
        0.9, "D_0: ellipses that overlap by more are the same", low=0.0, high=1.0
    )
    alignment_distance: float = option(
        2.0, "d_0: a pixel nearer to the ellipse is aligned", unit="px", low=0.0, high=1000.0
    )
    selection: str = option(
        "average",
        "all criteria at least average (5-16), or one net saliency against a threshold",
        choices=("average", "multiplicative", "additive"),
    )
    selection_threshold: float = option(
        0.8,
        "share of the best net saliency that suffices (multiplicative and additive)",
        low=0.0,
        high=1.0,
    )
