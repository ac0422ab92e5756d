"""The `refined` scheme: ellipses from pairs of smooth arcs, verified against the whole image.

Its steps, by the names that the parameters give them, and where each is written:

    strokes       arcs.gather_edges               points mates second_look stroke
    arcs          arcs.split_arcs                 split arcs
    pairs         candidates.pair_arcs            pairs few batch order
    votes         candidates.vote                 votes
    verification  candidates.verify               verify improve outline places support ends owners
    acceptance    detector.cross_check, accept    thirds clutter
    selection     detector.select                 select
    rough         rough.find_rough_outlines       rough_parts rough rough_choice
    refit         detector.refit_chosen           final covariance
    score         score.SCORE_MAP                 score

In the last column are the kernel files, each `_kernels_NAME`. All steps fit with `fit` and `conic`
(moments, direct) and `refit` (orthogonal distances).
"""

from geoprim_core.ecc.refined.arcs import EdgePoints, SmoothArcs
from geoprim_core.ecc.refined.candidates import Candidates, Verified
from geoprim_core.ecc.refined.detector import (
    OUTCOMES,
    RefinedTrace,
    Selection,
    detect_refined,
    select,
    trace_refined,
)
from geoprim_core.ecc.refined.params import RefinedParams

__all__ = [
    "OUTCOMES",
    "Candidates",
    "EdgePoints",
    "RefinedParams",
    "RefinedTrace",
    "Selection",
    "SmoothArcs",
    "Verified",
    "detect_refined",
    "select",
    "trace_refined",
]
