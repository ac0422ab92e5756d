"""Step of the `refined` scheme: outlines that are ellipses but for a few per cent."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core.ecc.refined import _kernels_rough as _rough
from geoprim_core.ecc.refined import _kernels_rough_choice as _choice
from geoprim_core.ecc.refined import _kernels_rough_parts as _parts
from geoprim_core.ecc.refined._kernels_select import CHOSEN
from geoprim_core.ecc.refined._kernels_support import (
    ACROSS_EACH,
    COVERAGE,
    EVIDENCE,
    LENGTH,
    RMS,
    TURN_COVERAGE,
    UNEXPLAINED,
    Supported,
)
from geoprim_core.ecc.refined.arcs import EdgePoints
from geoprim_core.ecc.refined.candidates import Verified
from geoprim_core.ecc.refined.params import RefinedParams
from geoprim_core.ecc.refined.score import SCORE_MAP, ScoreMap
from geoprim_core.types import Contours

REACH = 0.05
"""Semi-minor axes from a rough ellipse within which its outline runs."""
LARGEST = 0.5
"""Largest semi-major axis of a rough ellipse in image diagonals."""

# Fitted to what was right of 67 ellipses in photographs and of 186 on rendered blobs, each kind
# counted as a half; the first knot, below what is reported, lies between that fit and the one to
# the photographs alone.
ROUGH_MAP = ScoreMap(np.array([0.15, 0.45, 0.8]), np.array([-1.2, 1.4, 2.0]))
"""Log odds that a rough ellipse is right by the share of its outline that it explains."""


@dataclass(frozen=True, slots=True, eq=False)
class RoughOutlines:
    """Ellipses that rough outlines make, those that are reported first.

    Attributes
    ----------
    ellipses : (n, 5) float64
    figures : (n, 8) float64
        As those of `Verified`; in place of points across the outline stand those that the
        contours have elsewhere, in place of unexplained ends of gaps the widest gap in turns.
    outcome : (n,) int64
        What became of each, an index of `OUTCOMES`.
    offsets : (n + 1,) int64
        The support of ellipse k is `support[offsets[k]:offsets[k + 1]]`; empty if not reported.
    support : (S,) int64
        Indices of edge points.
    """

    ellipses: FloatArray
    figures: FloatArray
    outcome: IntArray
    offsets: IntArray
    support: IntArray

    def __len__(self) -> int:
        """Return the number of ellipses."""
        return len(self.ellipses)

    @property
    def reported(self) -> int:
        """How many are reported."""
        return int(np.count_nonzero(self.outcome == CHOSEN))


NONE = RoughOutlines(
    np.empty((0, 5)),
    np.empty((0, 8)),
    np.empty(0, np.int64),
    np.zeros(1, np.int64),
    np.empty(0, np.int64),
)
"""No rough outlines."""


def find_rough_outlines(
    edges: EdgePoints,
    contours: Contours,
    claimed: BoolArray,
    reported: FloatArray,
    params: RefinedParams,
) -> RoughOutlines:
    """Find the ellipses of outlines too rough for the other steps: slices, fruit, dented lids.

    Such an outline deviates by 1 to 3 % of its semi-minor axis, which is pixels: it scatters too
    much, or falls into arcs that agree on no ellipse. But it is one long contour or a few, of one
    polarity. Only long stretches of contours that no reported ellipse has claimed (`claimed`, for
    each edge point) are looked at, at every third point: parts of them without turns and
    inflexions, and pairs of such parts, give ellipses that grow to what lies along them within
    5 % of the semi-minor axis. One is reported, unless it overlaps another (`reported`, rows),
    where little of the outline is missing, most of all in one gap, and little of its contours
    lies elsewhere: that of a bottle, a letter or a leaf runs on. Nothing is looked for in line
    drawings, where the polarity means nothing.
    """
    if not (params.rough_scatter > 0.0 and edges.signed):
        return NONE
    runs, rings = _parts.long_runs(contours.offsets, contours.closed, claimed, params.min_rough)
    if len(runs) == 0:
        return NONE
    ellipses, figures = _rough.rough_ellipses(
        edges.points,
        edges.normals,
        runs,
        rings,
        params.min_rough,
        params.max_rough_parts,
        REACH,
        LARGEST * edges.diagonal,
        reported,
    )
    if len(ellipses) == 0:
        return NONE
    evidence = _choice.rough_evidence(figures)
    chosen, outcome, offsets, support, rms = _choice.choose_rough(
        edges.points,
        edges.normals,
        runs,
        ellipses,
        figures,
        evidence,
        reported,
        claimed.copy(),
        REACH,
        ROUGH_MAP.evidence_of(params.min_score),
        params.rough_scatter,
        params.min_unclaimed,
        params.max_overlap,
    )
    first = np.concatenate((chosen, np.flatnonzero(outcome != CHOSEN)))
    ends = np.concatenate((offsets, np.full(len(first) - len(chosen), offsets[-1])))
    rows = _as_verified(ellipses, figures, evidence, rms)
    return RoughOutlines(ellipses[first], rows[first], outcome[first], ends, support)


def _as_verified(
    ellipses: FloatArray, figures: FloatArray, evidence: FloatArray, rms: FloatArray
) -> FloatArray:
    """Return the figures of rough ellipses in the columns and on the scale of `Verified`."""
    rows = np.zeros((len(ellipses), UNEXPLAINED + 1))
    rows[:, EVIDENCE] = SCORE_MAP.evidence_at(ROUGH_MAP.log_odds_of(evidence))
    rows[:, COVERAGE], rows[:, TURN_COVERAGE] = figures[:, _rough.LENGTH], figures[:, _rough.TURN]
    rows[:, RMS], rows[:, ACROSS_EACH] = rms, figures[:, _rough.ELSEWHERE]
    rows[:, LENGTH] = math.pi * (ellipses[:, 2] + ellipses[:, 3]) * figures[:, _rough.LENGTH]
    rows[:, UNEXPLAINED] = figures[:, _rough.WIDEST]
    return rows


def with_rough(verified: Verified, rough: RoughOutlines) -> Verified:
    """Return the verified ellipses and, after them, those of rough outlines, of no candidate."""
    supported = Supported(
        np.concatenate((verified.ellipses, rough.ellipses)),
        np.concatenate((verified.figures, rough.figures)),
        np.concatenate((verified.offsets, verified.offsets[-1] + rough.offsets[1:])),
        np.concatenate((verified.support, rough.support)),
    )
    source = np.concatenate((verified.source, np.full(len(rough), -1)))
    return Verified(supported, source, verified.walked, verified.complete)
