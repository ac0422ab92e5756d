"""The `refined` scheme: ellipses from pairs of smooth arcs, verified against the whole image.

Its steps are the calls in `trace_refined`. What each departure from the thesis' ECC is worth stands
in docs/ablation.md, its reason in `geoprim_core.evaluation.ablation`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from geoprim_core._check import BoolArray, IntArray, describe
from geoprim_core.ecc.refined import _kernels_final as _final
from geoprim_core.ecc.refined import _kernels_select as _select
from geoprim_core.ecc.refined import _kernels_thirds as _thirds
from geoprim_core.ecc.refined.arcs import EdgePoints, SmoothArcs, gather_edges, split_arcs
from geoprim_core.ecc.refined.candidates import (
    Candidates,
    Verified,
    allow_for_chance,
    explain_crossings,
    pair_arcs,
    verify,
    vote,
    what_was_left_out,
)
from geoprim_core.ecc.refined.params import RefinedParams
from geoprim_core.ecc.refined.rough import find_rough_outlines, with_rough
from geoprim_core.ecc.refined.score import SCORE_MAP
from geoprim_core.errors import InputError
from geoprim_core.params import as_params
from geoprim_core.types import Contours, EllipseDetections, Ellipses, Polygons

EXPLAINING = 0.8
"""Score from which an ellipse explains arcs, and what crosses others."""
OUTCOMES = ("weak evidence", "claimed by a stronger ellipse", "copy of a stronger ellipse", "")


@dataclass(frozen=True, slots=True, eq=False)
class Selection:
    """What became of the verified ellipses.

    Attributes
    ----------
    chosen : (n,) int64
        Indices of the verified ellipses that are reported, in the order of their choice.
    outcome : (V,) int64
        What became of each verified ellipse, an index of `OUTCOMES`.
    claimed : (N,) bool
        Which edge points are on the outline of one that is reported.
    """

    chosen: IntArray
    outcome: IntArray
    claimed: BoolArray

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why each verified ellipse is not reported; empty for those that are."""
        return tuple(OUTCOMES[k] for k in self.outcome.tolist())


@dataclass(frozen=True, slots=True, eq=False)
class RefinedTrace:
    """Every intermediate result of `detect_refined`, in the order of its steps.

    Attributes
    ----------
    edges : EdgePoints
    arcs : SmoothArcs
    candidates : Candidates
    verified : Verified
        The last ones may be those of rough outlines, of no candidate (source -1).
    selection : Selection
    detections : EllipseDetections
    """

    edges: EdgePoints
    arcs: SmoothArcs
    candidates: Candidates
    verified: Verified
    selection: Selection
    detections: EllipseDetections


def detect_refined(
    contours: Contours, polygons: Polygons | None = None, params: RefinedParams | None = None
) -> EllipseDetections:
    """Detect ellipses by the `refined` scheme, best first.

    Parameters
    ----------
    contours : Contours
        Best with sub-pixel positions and gradient angles.
    polygons : Polygons, optional
        Not read: this scheme finds turns and inflexions on the sub-pixel positions. It is taken
        so that all schemes are called alike.
    params : RefinedParams, optional

    Raises
    ------
    InputError
        `contours` are not Contours.
    ParameterError
        `params` is not a `RefinedParams`.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 2 * np.pi, 300, endpoint=False)
    >>> circle = np.stack([60 + 40 * np.cos(t), 50 + 40 * np.sin(t)], axis=1)
    >>> contours = Contours(circle.round(), [0, 300], [True], (120, 100), circle)
    >>> found = detect_refined(contours)
    >>> found.ellipses.semi_major.round(3).tolist()
    [40.0]
    """
    return trace_refined(contours, polygons, params).detections


def trace_refined(
    contours: Contours, polygons: Polygons | None = None, params: RefinedParams | None = None
) -> RefinedTrace:
    """Detect ellipses by the `refined` scheme and keep every intermediate result.

    Parameters
    ----------
    contours, polygons, params
        As `detect_refined` takes them.

    Raises
    ------
    InputError
        `contours` are not Contours.
    ParameterError
        `params` is not a `RefinedParams`.

    Examples
    --------
    >>> import numpy as np
    >>> trace = trace_refined(Contours(np.zeros((0, 2)), [0], [], (40, 30)))
    >>> len(trace.arcs), len(trace.detections)
    (0, 0)
    """
    if not isinstance(contours, Contours):
        raise InputError("contours", "a Contours", describe(contours))
    settings: RefinedParams = as_params(params, RefinedParams)
    edges = gather_edges(contours, settings)
    arcs = split_arcs(edges, contours, settings)
    candidates = vote(edges, pair_arcs(edges, arcs, settings), settings)
    verified = cross_check(edges, verify(edges, arcs, candidates, settings), settings)
    verified, selection = accept(edges, arcs, verified, settings)
    verified, selection = add_rough_outlines(edges, contours, verified, selection, settings)
    detections = refit_chosen(edges, arcs, verified, selection, contours.image_size, settings)
    left_out = what_was_left_out(candidates, verified, settings)
    if left_out:
        detections = replace(detections, complete=False, reason=left_out)
    return RefinedTrace(edges, arcs, candidates, verified, selection, detections)


def cross_check(edges: EdgePoints, verified: Verified, params: RefinedParams) -> Verified:
    """Weigh the evidence of each ellipse less where its support does not predict itself.

    Stretches of several curves give an ellipse that lies near all of them and moves away from any
    one of them when it is fitted to the others; those of one ellipse agree on where it is.
    """
    if not params.prediction_weight > 0.0:
        return verified
    figures = _thirds.doubt_predictions(
        edges.points,
        verified.supported,
        params.reach_growth,
        params.prediction_weight,
        SCORE_MAP.evidence_of(params.min_score),
    )
    return verified.weighed(figures)


def accept(
    edges: EdgePoints, arcs: SmoothArcs, verified: Verified, params: RefinedParams
) -> tuple[Verified, Selection]:
    """Select ellipses after all are weighed again, now that it is known what others explain.

    Edges across an outline are a sign of texture, in which ellipses are found by chance, unless
    they are the outlines of other ellipses; so are smooth arcs that are on no ellipse. A first
    selection tells which these are.
    """
    if params.explain_crossings or max(params.chance_weight, params.explained_weight) > 0.0:
        explained = _choose(edges, verified, EXPLAINING, params).claimed
        verified = explain_crossings(edges, verified, explained, params)
        verified = allow_for_chance(edges, arcs, verified, explained, params)
    return verified, select(edges, verified, params)


def select(edges: EdgePoints, verified: Verified, params: RefinedParams) -> Selection:
    """Choose the ellipses to report: enough evidence, and support of their own.

    The strongest is taken first and claims the edge points on its outline; an ellipse that has
    less than a share `min_unclaimed` of its support left, or that overlaps a chosen one by more
    than `max_overlap`, is dropped. In a line drawing that is `max_line_overlap`: both edges of a
    line are one curve there, and what runs beside it is another line. Unlike the thesis' average
    (5-16), which drops about half of the hypotheses whatever the image, this keeps all of them
    when all are right.

    References
    ----------
    Thesis 5.5.1 (similar ellipses), 5.5.4 (selection).
    """
    return _choose(edges, verified, params.min_score, params)


def _choose(
    edges: EdgePoints, verified: Verified, min_score: float, params: RefinedParams
) -> Selection:
    """Return what is selected of the ellipses with at least some score."""
    chosen, outcome, claimed = _select.select(
        edges.index,
        verified.supported,
        SCORE_MAP.evidence_of(min_score),
        params.claim_reach,
        params.min_unclaimed,
        params.max_overlap if edges.signed else max(params.max_overlap, params.max_line_overlap),
        params.min_woven,
    )
    return Selection(chosen, outcome, claimed)


def add_rough_outlines(
    edges: EdgePoints,
    contours: Contours,
    verified: Verified,
    selection: Selection,
    params: RefinedParams,
) -> tuple[Verified, Selection]:
    """Add the ellipses of rough outlines on contours that nothing selected has claimed.

    `find_rough_outlines` tells which these are.
    """
    known = verified.ellipses[selection.chosen]
    rough = find_rough_outlines(edges, contours, selection.claimed, known, params)
    if not len(rough):
        return verified, selection
    claimed = selection.claimed.copy()
    claimed[rough.support] = True
    last = np.arange(len(verified), len(verified) + rough.reported)
    chosen = np.concatenate((selection.chosen, last))
    outcome = np.concatenate((selection.outcome, rough.outcome))
    return with_rough(verified, rough), Selection(chosen, outcome, claimed)


def refit_chosen(
    edges: EdgePoints,
    arcs: SmoothArcs,
    verified: Verified,
    selection: Selection,
    image_size: tuple[int, int] | None,
    params: RefinedParams,
) -> EllipseDetections:
    """Refit the chosen ellipses to their support and describe them, best first.

    Robust least squares of the orthogonal (Sampson) distances, after what the edge stage's blur
    has shrunk is undone (`undo_blur`), without the points beside gaps of the support, where what
    hides the outline also bends its edge; noise may leave longer gaps (`noise_gaps`). The
    covariance follows from the scatter of the distances at low frequencies along the outline and
    the doubt about a blur of the picture itself. It holds to first order for x, y, the mean of the
    semi-axes and half their difference times the cosine and the sine of twice the angle; of a
    circle the axes are told apart by chance, and its angle is unknown. Of a rough outline it is
    the shape that scatters, in few waves along it.
    `geoprim_core.evaluation.coverage` measures how often it holds.

    References
    ----------
    Thesis (5-10), (5-12), (5-13) for coverage, alignment and continuity.
    """
    noise = edges.noisiness if params.noise_gaps > 0.0 else 0.0
    rows, saliency, covariance, score, sound = _final.finish(
        edges.points,
        arcs.indices,
        arcs.offsets,
        verified.supported,
        selection.chosen,
        verified.score[selection.chosen],
        params.max_size * edges.diagonal,
        params.min_semi_minor,
        max(edges.spread, edges.line_spread) if params.undo_blur else 0.0,
        _final.GAP + (_final.NOISE_GAP - _final.GAP) * noise,
        int(np.count_nonzero(verified.source >= 0)),
    )
    x, y, semi_major, semi_minor, angle = rows
    coverage, alignment, continuity = saliency
    return EllipseDetections.made(
        sound,  # if not, the checks say what is wrong
        ellipses=Ellipses.made(
            sound, x=x, y=y, semi_major=semi_major, semi_minor=semi_minor, angle=angle
        ),
        score=score,
        coverage=coverage,
        alignment=alignment,
        continuity=continuity,
        covariance=covariance,
        image_size=image_size,
        complete=True,
        reason="",
    )
