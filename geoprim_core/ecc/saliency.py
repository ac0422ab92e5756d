"""Thesis 5.5.2 and 5.5.3: saliency criteria of hypotheses and their combinations."""

from __future__ import annotations

from dataclasses import dataclass

from geoprim_core._check import FloatArray
from geoprim_core.ecc import _kernels_saliency as kernels
from geoprim_core.ecc.arcs import Arcs
from geoprim_core.ecc.grouping_params import SaliencyParams
from geoprim_core.ecc.hypotheses import Hypotheses
from geoprim_core.ecc.tangents import ArcTangents


@dataclass(frozen=True, slots=True, eq=False)
class Saliency:
    """The three saliency criteria of n hypotheses, each (n,) in [0, 1].

    Attributes
    ----------
    circumference : (n,) float64
        Angular circumference ratio c, (5-10).
    alignment : (n,) float64
        Alignment ratio a, (5-12).
    continuity : (n,) float64
        Angular continuity ratio phi, (5-13).
    """

    circumference: FloatArray
    alignment: FloatArray
    continuity: FloatArray

    @property
    def product(self) -> FloatArray:
        """The multiplicative net saliency sigma_mul, (5-14)."""
        return self.circumference * self.alignment * self.continuity

    @property
    def mean(self) -> FloatArray:
        """The additive net saliency sigma_add, (5-15)."""
        return (self.circumference + self.alignment + self.continuity) / 3


def score_saliency(
    arcs: Arcs, tangents: ArcTangents, hypotheses: Hypotheses, params: SaliencyParams
) -> Saliency:
    """Score hypotheses by circumference, alignment and continuity.

    References
    ----------
    Thesis 5.5.2, (5-10) to (5-13).
    """
    return Saliency(
        circumference_ratio(arcs, hypotheses),
        alignment_ratio(arcs, hypotheses, params),
        continuity_ratio(arcs, tangents, hypotheses),
    )


def circumference_ratio(arcs: Arcs, hypotheses: Hypotheses) -> FloatArray:
    """Return c (n,): the angle that the arcs of each group subtend at the centre, over 2 pi.

    The angle is followed along the arc, so that an arc of more than half a turn counts in full;
    arcs that lie beside each other count at most a whole turn.

    References
    ----------
    Thesis 5.5.2.1, (5-10).
    """
    return kernels.circumference_ratios(
        arcs.positions,
        arcs.offsets,
        arcs.closed,
        hypotheses.ellipses,
        hypotheses.arc,
        hypotheses.offsets,
    )


def alignment_ratio(arcs: Arcs, hypotheses: Hypotheses, params: SaliencyParams) -> FloatArray:
    """Return a (n,): the share of each group's pixels nearer than d_0 to the ellipse.

    References
    ----------
    Thesis 5.5.2.2, (5-11), (5-12).
    """
    return kernels.alignment_ratios(
        arcs.positions,
        arcs.offsets,
        hypotheses.ellipses,
        hypotheses.arc,
        hypotheses.offsets,
        params.alignment_distance,
    )


def continuity_ratio(arcs: Arcs, tangents: ArcTangents, hypotheses: Hypotheses) -> FloatArray:
    """Return phi (n,): how straight the way from arc to arc is, 1 for a group of one arc.

    theta_diff is pi less the turn from one arc into the next at their nearest end points. The
    arcs are taken in their order around the centre, and the widest gap is the one of the N that
    is left out.

    References
    ----------
    Thesis 5.5.2.3, (5-13).
    """
    return kernels.continuity_ratios(
        arcs.positions,
        arcs.offsets,
        tangents.ends,
        hypotheses.ellipses,
        hypotheses.arc,
        hypotheses.offsets,
    )
