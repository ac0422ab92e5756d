"""What each departure of the `refined` scheme from the thesis is worth: F without it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from geoprim_core.ecc import DetectorParams
from geoprim_core.evaluation.comparison import Comparison
from geoprim_core.evaluation.comparison_tables import ComparisonRow, comparison_rows
from geoprim_core.evaluation.peers import OwnDetector
from geoprim_core.params import Scalar

EVERYTHING = "everything"
"""Name of the detector that keeps all departures."""


@dataclass(frozen=True, slots=True)
class Departure:
    """One step that `refined` does otherwise than the thesis.

    Attributes
    ----------
    name : str
    changes : dotted name -> value
        The parameters of the chain that leave it out.
    reason : str
        Why the step is there.
    """

    name: str
    changes: dict[str, Scalar] = field(hash=False)
    reason: str


DEPARTURES = (
    Departure(
        "strongest colour channel",
        {"edges.colour": "gray"},
        "edges between colours of one lightness have no gradient in the gray image",
    ),
    Departure(
        "thresholds from typical gradients and noise",
        {"edges.threshold_rule": "fraction"},
        "one strong edge must not hide the others",
    ),
    Departure(
        "noisy images blurred more",
        {"edges.noise_sigma": 0.0},
        "noise falls with the square of the blur, an edge only in proportion",
    ),
    Departure(
        "images that noise drowns blurred yet more",
        {"edges.drowned_sigma": 0.0},
        "where edges hardly rise above the noise, thin lines are seen at a wider blur only",
    ),
    Departure(
        "stairs smoothed",
        {"edges.stair_sigma": 0.0},
        "an outline drawn without grey levels in between is a polygon with corners",
    ),
    Departure(
        "jerks of small outlines linked",
        {"edges.max_jerk": 0.0},
        "stairs and noise turn the gradient around a small circle by jerks, not evenly",
    ),
    Departure(
        "direction-true linking",
        {"edges.linking": "junctions"},
        "curves go on through their crossings",
    ),
    Departure(
        "sub-pixel positions",
        {"edges.subpixel": False},
        "small and thin ellipses need tenths of a pixel",
    ),
    Departure(
        "strokes: both edges on one centre line",
        {"ecc.refined.stroke_reach": 0.0, "ecc.refined.drawing_reach": 0.0},
        "the truth of a drawn line is its middle",
    ),
    Departure(
        "wide lines in line drawings",
        {"ecc.refined.drawing_reach": 4.0},
        "lines of one width all over an image are lines, if they are wide too",
    ),
    Departure(
        "second look for the other edge of a line",
        {"ecc.refined.second_look": False, "ecc.refined.stroke_share": 0.6},
        "normals pass between the pixels of a diagonal edge",
    ),
    Departure(
        "edges of a line are equally high",
        {"ecc.refined.stroke_evenness": 0.0},
        "on both sides of a line is the same ground, not so of the rim of a coin or a lid",
    ),
    Departure(
        "dark and bright lines together",
        {"ecc.refined.both_inks": False},
        "a drawing may have lines of both on one ground",
    ),
    Departure(
        "lines that blur has widened",
        {"ecc.refined.soft_reach": 0.0},
        "the edges of a blurred line lie as far apart as the blur is wide, on circles not evenly",
    ),
    Departure(
        "arcs split where no ellipse fits",
        {"ecc.refined.max_arc_rms": 100.0},
        "a contour may run on from one ellipse to the next without a turn",
    ),
    Departure(
        "short and flat arcs",
        {"ecc.refined.min_arc": 12, "ecc.refined.min_sagitta": 0.5},
        "in crowds thin ellipses show in short pieces",
    ),
    Departure(
        "either polarity",
        {"ecc.refined.same_polarity": True},
        "an occluded outline is brighter here and darker there than what it lies on",
    ),
    Departure(
        "score by evidence (instead: coverage 0.65)",
        {"ecc.refined.min_score": 0.0, "ecc.refined.min_coverage": 0.65},
        "little of an outline is enough where nothing contradicts it",
    ),
    Departure(
        "score by evidence (instead: coverage 0.4)",
        {"ecc.refined.min_score": 0.0, "ecc.refined.min_coverage": 0.4},
        "little of an outline is enough where nothing contradicts it",
    ),
    Departure(
        "how the support ends",
        {"ecc.refined.end_weight": 0.0},
        "a contour that leaves the outline and goes on is that of something else",
    ),
    Departure(
        "a nearly whole outline counts beyond its length",
        {"ecc.refined.whole_weight": 0.0},
        "few curves close evenly by chance: small discs have no long outline to show",
    ),
    Departure(
        "gradients along small outlines",
        {"ecc.refined.small_weight": 0.0},
        "print and bubbles are round in outline, but their gradients do not show one centre",
    ),
    Departure(
        "refitted before it is judged",
        {"ecc.refined.refit_margin": 0.0},
        "an ellipse that is not yet fitted to all of its support scatters more than need be",
    ),
    Departure(
        "parts of the support predict each other",
        {"ecc.refined.prediction_weight": 0.0},
        "an ellipse through stretches of several curves moves when it is fitted without one",
    ),
    Departure(
        "crossings by accepted ellipses explained",
        {"ecc.refined.explain_crossings": False},
        "what crosses an outline is clutter unless it is another ellipse",
    ),
    Departure(
        "faint crossings count for less",
        {"ecc.refined.crossing_height": 0.0},
        "noise leaves edges everywhere, lower than those of outlines that stand out of it",
    ),
    Departure(
        "arcs on no ellipse tell of chance",
        {"ecc.refined.chance_weight": 0.0},
        "pieces make an ellipse by chance the more often, the more arcs are on none",
    ),
    Departure(
        "long outlines suffice where noise or blur hide the rest",
        {"ecc.refined.explained_weight": 0.0},
        "where ellipses explain the arcs, few are left to meet by chance",
    ),
    Departure(
        "reach follows the scatter",
        {"ecc.refined.reach_spread": 0.0},
        "what is far off for this outline is no support of it",
    ),
    Departure(
        "support within 2 pixels (instead: 1)",
        {"ecc.refined.reach": 1.0},
        "real outlines are not exact ellipses",
    ),
    Departure(
        "copies dropped from overlap 0.8 (instead: 0.9)",
        {"ecc.refined.max_overlap": 0.9},
        "the two edges of a rim are one object",
    ),
    Departure(
        "copies dropped from overlap 0.8 (instead: none)",
        {"ecc.refined.max_overlap": 1.0},
        "the two edges of a rim are one object",
    ),
    Departure(
        "copies in line drawings dropped from overlap 0.9 (instead: 0.8)",
        {"ecc.refined.max_line_overlap": 0.8},
        "both edges of a line are one curve: what runs beside it is another line",
    ),
    Departure(
        "selection by unclaimed support",
        {"ecc.refined.min_unclaimed": 0.0},
        "an edge point supports one ellipse",
    ),
    Departure(
        "small circles by votes in noisy images",
        {"ecc.refined.vote_radius": 0.0},
        "noise breaks a small contour, its points still face one centre",
    ),
    Departure(
        "noise explains scatter",
        {"ecc.refined.noise_scatter": 0.0},
        "edges in noise scatter about the right ellipse too",
    ),
    Departure(
        "noise explains gaps",
        {"ecc.refined.noise_gaps": 0.0},
        "in noise an outline has gaps that nothing hides",
    ),
    Departure(
        "scatter of round outlines counts less",
        {"ecc.refined.round_scatter": 0.0},
        "blobs that close by chance are hardly ever round: small dots in noise are",
    ),
    Departure(
        "search region before the fit",
        {"ecc.refined.region_slack": 100.0},
        "pairs that cannot be one ellipse cost no fit",
    ),
    Departure(
        "sure ellipses take their arcs",
        {"ecc.refined.claim_score": 0.999999},
        "what is explained needs no further candidates",
    ),
    Departure(
        "weak ellipses leave their arcs to other pairs",
        {"ecc.refined.weak_claims": True},
        "what will not be reported must not keep two arcs from a better candidate",
    ),
    Departure(
        "what weaves through a stronger ellipse is no copy",
        {"ecc.refined.min_woven": 1.0},
        "two crossing ellipses of nearly one place and size are two things, a rim's edges one",
    ),
    Departure(
        "rough outlines on long contours",
        {"ecc.refined.rough_scatter": 0.0},
        "fruit, stones and dented lids deviate from an ellipse by pixels, evenly and all along",
    ),
    Departure(
        "blur's shrinkage undone",
        {"ecc.refined.undo_blur": False},
        "a blurred edge lies inside the curve by half its variance times the curvature",
    ),
)
"""The departures, in the order of the chain; a new one is a new row."""


def ablation_detectors(
    departures: Sequence[Departure] = DEPARTURES, params: DetectorParams | None = None
) -> list[OwnDetector]:
    """Return the whole detector and, for each departure, the one without it.

    Raises
    ------
    ParameterError
        A departure names no parameter of the chain, or a value is refused.

    Examples
    --------
    >>> [detector.name for detector in ablation_detectors(DEPARTURES[:1])]
    ['everything', 'strongest colour channel']
    """
    base = params or DetectorParams()
    without = [OwnDetector(d.name, base.updated(d.changes)) for d in departures]
    return [OwnDetector(EVERYTHING, base), *without]


def ablation_markdown(comparison: Comparison) -> str:
    """Return the table: mean F with everything, and for each departure what F loses without it.

    The last column is the time without the departure in times of the whole detector. Recall
    stands for F where only that is known.
    """
    rows = comparison_rows(comparison)
    columns = list(dict.fromkeys(_column(row) for row in rows))
    lines = [
        "| without | " + " | ".join(columns) + " | time |",
        "|---|" + "---:|" * (len(columns) + 1),
    ]
    whole = {_column(row): _merit(row) for row in rows if row.detector == EVERYTHING}
    for name in comparison.detectors:
        own = {_column(row): row for row in rows if row.detector == name}
        values = [
            f"{whole[c]:.3f}" if name == EVERYTHING else f"{_merit(own[c]) - whole[c]:+.3f}"
            for c in columns
        ]
        ratios = [row.time_ratio for row in own.values()]
        label = "nothing (F)" if name == EVERYTHING else name
        cells = [label, *values, f"{sum(ratios) / max(len(ratios), 1):.2f}"]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _column(row: ComparisonRow) -> str:
    kind = ", recall" if row.recall_only else ""
    return f"{row.set_name} {row.overlap:g}{kind}"


def _merit(row: ComparisonRow) -> float:
    return row.means[1] if row.recall_only else row.means[2]
