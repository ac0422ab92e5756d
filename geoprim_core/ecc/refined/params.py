"""Parameters of the `refined` ellipse detector; each names the step that reads it."""

from __future__ import annotations

from dataclasses import dataclass

from geoprim_core.params import Params, option


@dataclass(frozen=True)
class RefinedParams(Params):
    """Parameters of `detect_refined`, in the order of its steps."""

    stroke_reach: float = option(
        4.0,
        "strokes: widest line of which both edges count as one curve in any image, 0 for none",
        unit="px",
        low=0.0,
        high=20.0,
    )
    drawing_reach: float = option(
        6.0,
        "strokes: widest such line in a line drawing, 0 for none",
        unit="px",
        low=0.0,
        high=20.0,
    )
    soft_reach: float = option(
        12.0,
        "strokes: widest such line that blur has made so wide, 0 for none",
        unit="px",
        low=0.0,
        high=40.0,
    )
    stroke_share: float = option(
        0.72,
        "strokes: share of the points of long contours on lines of one width that makes a line "
        "drawing",
        low=0.0,
        high=1.0,
    )
    stroke_evenness: float = option(
        0.5,
        "strokes: least ratio of the gradients of both edges of a line, 0 for any",
        low=0.0,
        high=1.0,
    )
    stroke_alone: float = option(
        0.93,
        "strokes: share of a contour's points that makes it a line in other images",
        low=0.0,
        high=1.0,
    )
    second_look: bool = option(
        True, "strokes: look for the other edge of a line again where the neighbours' edge is"
    )
    both_inks: bool = option(
        True, "strokes: lines darker and lines brighter than the ground make one line drawing"
    )
    flatness: float = option(
        0.6,
        "arcs: maximum deviation of the polygon that finds turns and inflexions",
        unit="px",
        low=0.1,
        high=5.0,
    )
    max_turn: float = option(
        60.0, "arcs: sharpest turn inside a smooth arc", unit="deg", low=5.0, high=180.0
    )
    max_arc_rms: float = option(
        0.7,
        "arcs: rms distance to its own ellipse above which an arc is split",
        unit="px",
        low=0.05,
        high=100.0,
    )
    min_arc: int = option(10, "arcs: fewest points", unit="px", low=5, high=10000)
    min_sagitta: float = option(
        0.3, "arcs: least height over the chord", unit="px", low=0.0, high=100.0
    )
    same_polarity: bool = option(
        False, "pairs: want the gradient inwards on both arcs or outwards on both"
    )
    region_slack: float = option(
        2.0, "pairs: tolerance of the search region", unit="px", low=0.0, high=100.0
    )
    max_pair_rms: float = option(
        1.0,
        "pairs: largest rms distance of each arc to the common ellipse",
        unit="px",
        low=0.05,
        high=10.0,
    )
    min_pair_share: float = option(
        0.07, "pairs: least share of the outline that the arcs make up", low=0.01, high=1.0
    )
    max_pairs: int = option(
        5_000_000, "pairs: as many are looked at, longest arcs first", low=1, high=1_000_000_000
    )
    vote_radius: float = option(
        14.0,
        "votes: largest radius that edge points of a noisy image vote for, 0 for no votes",
        unit="px",
        low=0.0,
        high=100.0,
    )
    max_candidates: int = option(
        10000, "verification: as many candidates are walked, best first", low=1, high=10_000_000
    )
    max_tries: int = option(
        2, "verification: failures after which two arcs are left alone", low=1, high=1_000_000
    )
    reach: float = option(
        2.0,
        "verification: largest distance of a supporting point",
        unit="px",
        low=0.2,
        high=20.0,
    )
    reach_growth: float = option(
        0.005,
        "verification: growth of that distance per pixel of the semi-minor axis",
        low=0.0,
        high=0.1,
    )
    reach_spread: float = option(
        12.0,
        "verification: that distance in medians of the distances found, 0 for no such limit",
        low=0.0,
        high=100.0,
    )
    max_normal_angle: float = option(
        15.0,
        "verification: largest angle between the gradient and the outline's normal",
        unit="deg",
        low=1.0,
        high=35.0,
    )
    min_coverage: float = option(
        0.25, "verification: least supported share of the outline", low=0.05, high=1.0
    )
    min_in_frame: float = option(
        0.5, "verification: least share of the outline inside the image", low=0.05, high=1.0
    )
    max_size: float = option(
        0.75, "verification: largest semi-major axis in image diagonals", low=0.01, high=10.0
    )
    min_semi_minor: float = option(
        3.0, "verification: least semi-minor axis", unit="px", low=0.5, high=10000.0
    )
    end_weight: float = option(
        1.0,
        "verification: weight of how the supported stretches end, 0 for none",
        low=0.0,
        high=10.0,
    )
    whole_weight: float = option(
        1.3,
        "verification: evidence that an even outline, whole or nearly so, adds to its length's",
        low=0.0,
        high=10.0,
    )
    small_weight: float = option(
        12.0,
        "verification: evidence that an outline of few pixels loses where gradients are not along "
        "its normals, but for noise and line drawings",
        low=0.0,
        high=30.0,
    )
    noise_scatter: float = option(
        0.3,
        "verification: scatter of edges in a noisy image that is no misfit",
        unit="px",
        low=0.0,
        high=2.0,
    )
    noise_gaps: float = option(
        0.2,
        "verification, refit: share of an outline that noise hides, 0 where gaps are no noise",
        low=0.0,
        high=0.7,
    )
    refit_margin: float = option(
        3.0,
        "verification: evidence that a circle, if whole, may lack to be refitted robustly before "
        "it is judged; less for unsupported and for thin ones",
        low=0.0,
        high=30.0,
    )
    round_scatter: float = option(
        0.5,
        "verification: share of the scatter of a whole and round outline that is no misfit",
        low=0.0,
        high=1.0,
    )
    claim_score: float = option(
        0.975,
        "verification: score from which an ellipse takes its arcs from later candidates",
        low=0.5,
        high=0.999999,
    )
    weak_claims: bool = option(
        False, "verification: two arcs of an ellipse below min_score make no other candidate either"
    )
    prediction_weight: float = option(
        8.0,
        "acceptance: weight of how badly parts of the support predict the others, 0 for none",
        low=0.0,
        high=100.0,
    )
    explain_crossings: bool = option(
        True, "acceptance: edges of accepted ellipses that cross an outline are no clutter"
    )
    crossing_height: float = option(
        0.35,
        "acceptance: height, in those of the outline, from which an edge across it is clutter in "
        "full, 0 for any",
        low=0.0,
        high=1.0,
    )
    chance_weight: float = option(
        2.2,
        "acceptance: weight of the smooth arcs that accepted ellipses do not explain, against "
        "ellipses that are made of pieces",
        low=0.0,
        high=10.0,
    )
    explained_weight: float = option(
        4.0,
        "acceptance: evidence that a long outline gains in a noisy or blurred image, where "
        "accepted ellipses explain the smooth arcs",
        low=0.0,
        high=20.0,
    )
    claim_reach: float = option(
        1.5,
        "selection: a chosen ellipse claims edge points so near",
        unit="px",
        low=0.0,
        high=10.0,
    )
    min_unclaimed: float = option(
        0.6, "selection: least share of support not claimed by stronger ones", low=0.0, high=1.0
    )
    max_overlap: float = option(
        0.8, "selection: largest overlap with a stronger ellipse", low=0.0, high=1.0
    )
    max_line_overlap: float = option(
        0.9,
        "selection: that overlap in a line drawing, where both edges of a line are one curve",
        low=0.0,
        high=1.0,
    )
    min_woven: float = option(
        0.2,
        "selection: share of an outline inside and outside a stronger one, that it so weaves "
        "through, from which it is no copy; above 0.5 it always is",
        low=0.0,
        high=1.0,
    )
    rough_scatter: float = option(
        0.025,
        "rough outlines: largest rms distance to an ellipse in semi-minor axes, 0 for none",
        low=0.0,
        high=0.05,
    )
    min_rough: int = option(
        30,
        "rough outlines: shortest stretch of a contour that is looked at",
        unit="px",
        low=15,
        high=10000,
    )
    max_rough_parts: int = option(
        64,
        "rough outlines: as many parts of contours are looked at, longest first",
        low=1,
        high=1000,
    )
    min_score: float = option(
        0.8, "acceptance: least probability of being right", low=0.0, high=1.0
    )
    undo_blur: bool = option(True, "refit: undo what the edge stage's blur has shrunk")
