"""Middle steps of the `refined` scheme: pairs of arcs, and their verification."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core.ecc.refined import _kernels_clutter as _clutter
from geoprim_core.ecc.refined import _kernels_pairs as _pairs
from geoprim_core.ecc.refined import _kernels_verify as _verify
from geoprim_core.ecc.refined import _kernels_votes as _votes
from geoprim_core.ecc.refined._kernels_arcs import POLARITY
from geoprim_core.ecc.refined._kernels_few import PairRules
from geoprim_core.ecc.refined._kernels_improve import Rules
from geoprim_core.ecc.refined._kernels_order import best_first
from geoprim_core.ecc.refined._kernels_support import (
    COVERAGE,
    EVIDENCE,
    LENGTH,
    TURN_COVERAGE,
    Supported,
    Weights,
)
from geoprim_core.ecc.refined.arcs import EdgePoints, SmoothArcs
from geoprim_core.ecc.refined.params import RefinedParams
from geoprim_core.ecc.refined.score import SCORE_MAP

USUAL_SHARE = 0.3
"""Share of the smooth arcs on no accepted ellipse up to which evidence stays as it is."""
EXPLAINED_SHARE = 0.5
"""That share, up to which a long outline in noise or blur gains evidence."""
LONG = (60.0, 140.0)
"""Pixels of supported length from which an outline gains some of it, and all."""
SOUND = (0.6, 0.8)
"""Supported share, and ratio of the axes, from which an outline is hardly made of pieces."""


@dataclass(frozen=True, slots=True, eq=False)
class Candidates:
    """Ellipses through one arc or two, best first, then circles by votes, best first.

    Attributes
    ----------
    arcs : (C, 2) int64
        Indices of the arcs; the second is -1 where one arc made the candidate alone, both where
        votes made it.
    rank : (C,) float64
        Number of points over scatter, or of points that voted.
    ellipses : (C, 5) float64
    pairs : int
        Number of pairs whose search regions were looked at.
    possible : int
        Number of pairs near enough for their lengths, or a little more.
    share : float
        The share of an outline that two arcs so far apart had to be able to make up:
        `min_pair_share`, or more to keep within `max_pairs`.
    complete : bool
        False where `max_pairs` left pairs out.
    """

    arcs: IntArray
    rank: FloatArray
    ellipses: FloatArray
    pairs: int
    possible: int
    share: float
    complete: bool


@dataclass(frozen=True, slots=True, eq=False)
class Verified:
    """Ellipses with the support that the whole image gives them.

    Attributes
    ----------
    supported : Supported
        The ellipses, their figures and their support.
    source : (V,) int64
        The candidate that each came from.
    walked : int
        Number of candidates looked at closely.
    complete : bool
        False where `max_candidates` left candidates out.
    """

    supported: Supported
    source: IntArray
    walked: int
    complete: bool

    def __len__(self) -> int:
        """Return the number of verified ellipses."""
        return len(self.ellipses)

    @property
    def ellipses(self) -> FloatArray:
        """The ellipses (V, 5)."""
        return self.supported.ellipses

    @property
    def figures(self) -> FloatArray:
        """What the support tells of each ellipse (V, 8), see `Supported`."""
        return self.supported.figures

    @property
    def offsets(self) -> IntArray:
        """Where the support (V + 1,) of each ellipse starts."""
        return self.supported.offsets

    @property
    def support(self) -> IntArray:
        """Indices of the supporting edge points (S,) of all ellipses."""
        return self.supported.support

    @property
    def score(self) -> FloatArray:
        """The probability that each ellipse is right, by its evidence."""
        return SCORE_MAP.probability(self.figures[:, EVIDENCE])

    def weighed(self, figures: FloatArray) -> Verified:
        """Return the same ellipses with other figures."""
        ellipses, _, offsets, support = self.supported
        supported = Supported(ellipses, figures, offsets, support)
        return Verified(supported, self.source, self.walked, self.complete)


def pair_arcs(edges: EdgePoints, arcs: SmoothArcs, params: RefinedParams) -> Candidates:
    """Fit an ellipse to every arc and to every two arcs that may belong together.

    Two arcs may when each lies in the other's search region (inside its tangents, beyond its
    chord: the thesis' search region and associated convexity as one test) and one ellipse fits
    both within `max_pair_rms`. Their moments are added, so a fit costs the same for long arcs.
    The thesis votes for centres instead; pairs need no bins, and two arcs suffice to start.

    Arcs too far apart to make up a share `min_pair_share` of an ellipse are no pair. Where
    `max_pairs` do not suffice, that share is raised until they do: the pairs that can make up
    least of an ellipse go first, wherever they lie in the image.

    References
    ----------
    Thesis 5.4.1 (search region), 5.4.2 (associated convexity); Halir and Flusser, Numerically
    stable direct least squares fitting of ellipses (1998).
    """
    rules = PairRules(
        slack=params.region_slack,
        max_rms=params.max_pair_rms,
        min_share=params.min_pair_share,
        max_semi_major=params.max_size * edges.diagonal,
        signed=edges.signed and params.same_polarity,
        max_pairs=params.max_pairs,
    )
    members, values, looked, possible, share = _pairs.pair_arcs(
        edges.points, arcs.indices, arcs.offsets, arcs.table, arcs.moments, rules
    )
    complete = share <= params.min_pair_share
    return Candidates(*best_first(members, values), int(looked), int(possible), share, complete)


def vote(edges: EdgePoints, candidates: Candidates, params: RefinedParams) -> Candidates:
    """Add to the candidates of a noisy image the small circles that edge points vote for.

    Noise breaks the contour of a small circle into pieces too short for an arc, or that bend as
    they should not. Its single points still face one centre, and there are enough of them. They
    come after all candidates from arcs, most points first, so that they only add what is missed.

    References
    ----------
    Thesis 5.4.3 (votes for centres), from single points instead of edges.
    """
    if not (params.vote_radius > 0.0 and edges.noisiness > 0.0):
        return candidates
    circles, counts = _votes.circles_by_votes(edges.index, params.vote_radius)
    order = np.argsort(-counts, kind="stable")
    return replace(
        candidates,
        arcs=np.concatenate((candidates.arcs, np.full((len(order), 2), -1, np.int64))),
        rank=np.concatenate((candidates.rank, counts[order])),
        ellipses=np.concatenate((candidates.ellipses, circles[order])),
    )


def verify(
    edges: EdgePoints, arcs: SmoothArcs, candidates: Candidates, params: RefinedParams
) -> Verified:
    """Collect the support of each candidate from all edge points, and refit to it.

    The outline is walked over the image of edge points; what lies near it with its gradient along
    the normal supports the ellipse, whichever contour it is on. Arcs of an ellipse that is sure
    (`claim_score`) are taken from later candidates.

    The thesis judges a hypothesis by the arcs that made it (5.5.2).
    """
    supported, source, walked = _verify.verify(
        edges.index,
        edges.offsets,
        arcs.indices,
        arcs.offsets,
        arcs.table[:, POLARITY].copy(),
        candidates.arcs,
        candidates.ellipses,
        _rules(edges, params),
    )
    complete = walked <= params.max_candidates
    walked = min(int(walked), params.max_candidates)
    return Verified(supported, source, walked, complete)


def _rules(edges: EdgePoints, params: RefinedParams) -> Rules:
    """Return what an ellipse has to meet in an image: noise and line drawings relax some of it."""
    noise = edges.noisiness
    weights = Weights(
        whole=params.whole_weight,
        small=params.small_weight * max(0.0, 1.0 - 2.0 * noise) * edges.signed,
        noise_scatter=params.noise_scatter * noise,
        noise_gaps=params.noise_gaps * noise,
        round_scatter=params.round_scatter,
    )
    return Rules(
        reach=params.reach,
        reach_growth=params.reach_growth,
        reach_spread=params.reach_spread,
        min_cosine=math.cos(math.radians(params.max_normal_angle)),
        min_coverage=params.min_coverage,
        min_in_frame=params.min_in_frame,
        max_semi_major=params.max_size * edges.diagonal,
        min_semi_minor=params.min_semi_minor,
        end_weight=params.end_weight,
        weights=weights,
        hope=SCORE_MAP.evidence_of(params.min_score),
        refit_margin=params.refit_margin,
        sure=SCORE_MAP.evidence_of(params.claim_score),
        weak_claims=params.weak_claims,
        signed=edges.signed and params.same_polarity,
        max_tries=params.max_tries,
        max_candidates=params.max_candidates,
    )


def explain_crossings(
    edges: EdgePoints, verified: Verified, explained: BoolArray, params: RefinedParams
) -> Verified:
    """Weigh the evidence of ellipses as if `explained` edge points did not cross their outlines.

    Nor do faint ones much (`crossing_height`): noise leaves edges everywhere, far lower than those
    of an outline that stands out of it.
    """
    if not params.explain_crossings:
        return verified
    figures = _clutter.explain_crossings(
        edges.index,
        verified.supported,
        explained,
        edges.heights,
        params.crossing_height,
        SCORE_MAP.evidence_of(params.min_score),
    )
    return verified.weighed(figures)


def allow_for_chance(
    edges: EdgePoints,
    arcs: SmoothArcs,
    verified: Verified,
    explained: BoolArray,
    params: RefinedParams,
) -> Verified:
    """Take evidence from ellipses in an image whose smooth arcs are mostly on no ellipse.

    Pieces of outlines make an ellipse by chance the more often, the more arcs there are that
    accepted ellipses (`explained`, for each edge point) do not explain: in a photograph an ellipse
    has to show more than in a picture of ellipses. What is whole and round is hardly made of
    pieces, but for noise, and loses nothing.

    Where accepted ellipses explain nearly all arcs, few are left to meet by chance: a long stretch
    of an ellipse (`explained_weight`) is enough there, in an image whose noise or blur hides the
    rest.
    """
    if not (max(params.chance_weight, params.explained_weight) > 0.0 and len(arcs.indices)):
        return verified
    share = 1.0 - np.count_nonzero(explained[arcs.indices]) / len(arcs.indices)
    figures = verified.figures.copy()
    gain = params.explained_weight * edges.vagueness * max(0.0, 1.0 - share / EXPLAINED_SHARE)
    figures[:, EVIDENCE] += gain * _rising(figures[:, LENGTH], LONG)
    whole = _rising(np.minimum(figures[:, COVERAGE], figures[:, TURN_COVERAGE]), SOUND)
    whole *= max(0.0, 1.0 - edges.noisiness)
    round_ = _rising(verified.ellipses[:, 3] / verified.ellipses[:, 2], SOUND)
    doubt = params.chance_weight * max(0.0, share - USUAL_SHARE)
    figures[:, EVIDENCE] -= doubt * (1.0 - whole * round_)
    return verified.weighed(figures)


def _rising(value: FloatArray, limits: tuple[float, float]) -> FloatArray:
    """Return 0 up to the first limit, 1 from the second, and on a line in between."""
    # On a few numbers np.clip takes three times as long.
    share: FloatArray = (value - limits[0]) / (limits[1] - limits[0])
    return np.minimum(np.maximum(share, 0.0), 1.0)


def what_was_left_out(candidates: Candidates, verified: Verified, params: RefinedParams) -> str:
    """Return which bounds on the work left something out and how much, or an empty text."""
    bounds = []
    if not candidates.complete:
        bounds.append(
            f"max_pairs = {params.max_pairs}: {candidates.pairs} of up to {candidates.possible} "
            f"pairs of arcs were looked at, those that may make up {candidates.share:.2g} of an "
            f"ellipse or more"
        )
    if not verified.complete:
        bounds.append(
            f"max_candidates = {params.max_candidates}: the best of {len(candidates.rank)} "
            f"candidates were verified until so many had been walked"
        )
    return "; ".join(bounds)
