"""Thesis 5.2 and 5.6.3: the ECC ellipse detector in its schemes 1, 2 and 3, step by step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geoprim_core._check import BoolArray, FloatArray
from geoprim_core.ecc.arcs import Arcs, split_arcs
from geoprim_core.ecc.centres import find_centres
from geoprim_core.ecc.convexity import find_associated
from geoprim_core.ecc.hypotheses import Hypotheses, form_hypotheses
from geoprim_core.ecc.params import EccParams
from geoprim_core.ecc.saliency import Saliency, score_saliency
from geoprim_core.ecc.search_region import SearchRegions, find_arcs_inside, find_search_regions
from geoprim_core.ecc.selection import select_salient
from geoprim_core.ecc.similarity import merge_similar
from geoprim_core.ecc.tangents import ArcTangents, arc_tangents
from geoprim_core.ecc.votes import Votes, cast_votes, find_meeting_arcs
from geoprim_core.types import Contours, EllipseDetections, Ellipses, Polygons


@dataclass(frozen=True, slots=True, eq=False)
class SchemeTrace:
    """Every intermediate result of scheme 1, 2 or 3.

    Attributes
    ----------
    arcs : Arcs, K of them
    tangents : ArcTangents
    regions : SearchRegions or None
        None for the schemes 1 and 2, as are the next two.
    inside, eligible : (K, K) bool or None
        The arcs meet in a bin and arc j lies in the search region of arc k; and their convexity
        is associated too.
    centres : (K, S, 2) float64
    votes : Votes
    formed : Hypotheses
        All groups that passed C1 and C2.
    distinct : Hypotheses
        One for every cluster of similar ones.
    saliency : Saliency
        Of the distinct hypotheses.
    selected : (n,) bool
        Of the distinct hypotheses.
    detections : EllipseDetections
    """

    arcs: Arcs
    tangents: ArcTangents
    regions: SearchRegions | None
    inside: BoolArray | None
    eligible: BoolArray | None
    centres: FloatArray
    votes: Votes
    formed: Hypotheses
    distinct: Hypotheses
    saliency: Saliency
    selected: BoolArray
    detections: EllipseDetections


def trace_scheme(contours: Contours, polygons: Polygons, params: EccParams) -> SchemeTrace:
    """Detect ellipses with scheme 1, 2 or 3 and keep every intermediate result.

    Scheme 1 groups by the plain count of votes, scheme 2 by the relationship score, and scheme 3
    looks only at arcs in the search region with associated convexity as well. These two are
    tested after the votes, and only for arcs that meet in a bin: the groups are the same.

    References
    ----------
    Thesis Figure 5.2-1, 5.6.3, Figure 5.6-2.
    """
    every = split_arcs(contours, polygons, params.smooth)
    arcs = longest_arcs(every, params.grouping.max_arcs)
    tangents = arc_tangents(arcs, params.tangent, params.tangent_method)
    centres = find_centres(arcs, tangents, params.grouping)
    votes = cast_votes(arcs, centres, params.scheme, params.grouping)
    regions, inside, eligible = None, None, None
    if params.scheme == "3":
        meeting = find_meeting_arcs(votes, params.grouping)
        regions = find_search_regions(arcs, tangents)
        inside = find_arcs_inside(arcs, regions, meeting, params.grouping)
        eligible = find_associated(arcs, inside, params.grouping)
    formed = form_hypotheses(arcs, votes, eligible, params.grouping)
    distinct = merge_similar(arcs, formed, params.saliency)
    saliency = score_saliency(arcs, tangents, distinct, params.saliency)
    selected = select_salient(saliency, params.saliency)
    return SchemeTrace(
        arcs,
        tangents,
        regions,
        inside,
        eligible,
        centres,
        votes,
        formed,
        distinct,
        saliency,
        selected,
        _detections(
            distinct, saliency, selected, contours.image_size, _left_out(len(every), len(arcs))
        ),
    )


def _left_out(count: int, grouped: int) -> str:
    """Return how many arcs `max_arcs` left out, or an empty text."""
    if grouped == count:
        return ""
    return f"max_arcs = {grouped}: the {count - grouped} shortest of {count} arcs were left out"


def longest_arcs(arcs: Arcs, limit: int) -> Arcs:
    """Return the longest arcs, at most `limit` of them, in their order."""
    if len(arcs) <= limit:
        return arcs
    longest = np.argsort(-np.diff(arcs.offsets), kind="stable")[:limit]
    return arcs.select(np.sort(longest))


def _detections(
    hypotheses: Hypotheses,
    saliency: Saliency,
    selected: BoolArray,
    image_size: tuple[int, int] | None,
    left_out: str,
) -> EllipseDetections:
    order = np.argsort(-saliency.mean, kind="stable")
    order = order[selected[order]]
    return EllipseDetections(
        Ellipses.from_array(hypotheses.ellipses[order]),
        np.minimum(saliency.mean[order], 1.0),
        saliency.circumference[order],
        saliency.alignment[order],
        saliency.continuity[order],
        np.full((len(order), 5, 5), np.nan),
        image_size,
        not left_out,
        left_out,
    )
