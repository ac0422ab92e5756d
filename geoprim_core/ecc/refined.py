"""The `refined` scheme: ellipses from pairs of smooth arcs, verified against the whole image.

Its steps are the calls in `trace_refined`. What each departure from the thesis' ECC is worth, as
the F it costs to leave it out: mean of 48 images of the four thesis sets at overlap 0.95 (F 0.95
with all of them), and 14 photographs at 0.8 (F 0.86); ranges are over the four sets.

======================================  ==========================  =======================
departure                               thesis sets                 photographs
======================================  ==========================  =======================
strongest colour channel (edge stage)   grey images                 0.08 (pooled)
direction-true linking (edge stage)     0.01 to 0.10                0.04
sub-pixel positions                     0.08 to 0.19                0.11
strokes: both edges on one centre line  0.44, 0.54 on drawn lines   0
arcs split where no ellipse fits        0.09 occluded discs         0.01
either polarity                         0.03 occluded discs         0.02 (pooled)
score by evidence, not by a coverage    0.30 occluded (0.65)        0.17 (0.65), 0.40 (0.4)
support within 2 pixels, not 1          0.01 occluded discs         0.04
copies dropped from overlap 0.8 on      0                           0.08 (0.9), 0.12 (none)
selection by unclaimed support          0                           0.01
search region before the fit            0, a quarter of the time    0
sure ellipses take their arcs           0, half of the time         0, half of the time
======================================  ==========================  =======================
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geoprim_core._check import IntArray, describe
from geoprim_core.ecc import _kernels_refined_final as _final
from geoprim_core.ecc import _kernels_refined_select as _select
from geoprim_core.ecc.refined_arcs import EdgePoints, SmoothArcs, gather_edges, split_arcs
from geoprim_core.ecc.refined_candidates import Candidates, Verified, pair_arcs, verify
from geoprim_core.ecc.refined_params import RefinedParams
from geoprim_core.ecc.refined_score import SCORE_MAP
from geoprim_core.errors import InputError
from geoprim_core.params import as_params
from geoprim_core.types import Contours, EllipseDetections, Ellipses, Polygons

OUTCOMES = ("weak evidence", "claimed by a stronger ellipse", "copy of a stronger ellipse", "")


@dataclass(frozen=True, slots=True, eq=False)
class Selection:
    """What became of the verified ellipses.

    Attributes
    ----------
    chosen : (n,) int64
        Indices of the verified ellipses that are reported, in the order of their choice.
    reasons : texts, one a verified ellipse
        Why it is not reported; empty for those that are.
    """

    chosen: IntArray
    reasons: tuple[str, ...]


@dataclass(frozen=True, slots=True, eq=False)
class RefinedTrace:
    """Every intermediate result of `detect_refined`, in the order of its steps.

    Attributes
    ----------
    edges : EdgePoints
    arcs : SmoothArcs
    candidates : Candidates
    verified : Verified
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
    candidates = pair_arcs(edges, arcs, settings)
    verified = verify(edges, arcs, candidates, settings)
    selection = select(edges, verified, settings)
    detections = refit_chosen(edges, arcs, verified, selection, contours.image_size, settings)
    return RefinedTrace(edges, arcs, candidates, verified, selection, detections)


def select(edges: EdgePoints, verified: Verified, params: RefinedParams) -> Selection:
    """Choose the ellipses to report: enough evidence, and support of their own.

    The strongest is taken first and claims the edge points on its outline; an ellipse that has
    less than a share `min_unclaimed` of its support left, or that overlaps a chosen one by more
    than `max_overlap`, is dropped. Unlike the thesis' average (5-16), which drops about half of
    the hypotheses whatever the image, this keeps all of them when all are right.

    References
    ----------
    Thesis 5.5.1 (similar ellipses), 5.5.4 (selection).
    """
    chosen, outcome = _select.select(
        edges.head,
        edges.following,
        edges.points,
        edges.normals,
        verified.ellipses,
        verified.figures,
        verified.offsets,
        verified.support,
        SCORE_MAP.evidence_of(params.min_score),
        params.claim_reach,
        params.min_unclaimed,
        params.max_overlap,
    )
    return Selection(chosen, tuple(OUTCOMES[k] for k in outcome))


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
    has shrunk is undone (`edge_spread`), without the points beside gaps of the support, where what
    hides the outline also bends its edge. The covariance follows from the scatter of the distances
    at low frequencies along the outline and the doubt about a blur of the picture itself. It holds
    to first order for x, y, the mean of the semi-axes and half their difference times the cosine
    and the sine of twice the angle; of a circle the axes are told apart by chance, and its angle
    is unknown. `geoprim_core.evaluation.coverage` measures how often it holds.

    References
    ----------
    Thesis (5-10), (5-12), (5-13) for coverage, alignment and continuity.
    """
    score = verified.score[selection.chosen]
    best = selection.chosen[np.argsort(-score, kind="stable")]
    rows, covariance, saliency = _final.finish(
        edges.points,
        arcs.indices,
        arcs.offsets,
        verified.ellipses,
        verified.offsets,
        verified.support,
        best,
        params.max_size * edges.diagonal,
        params.edge_spread if edges.located else 0.0,
    )
    return EllipseDetections(
        Ellipses.from_array(rows),
        verified.score[best],
        saliency[:, 0],
        saliency[:, 1],
        saliency[:, 2],
        covariance,
        image_size,
    )
