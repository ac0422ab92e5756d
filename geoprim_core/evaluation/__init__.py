"""Comparison with the truth: one-to-one matching, precision, recall, F-measure, reports."""

from geoprim_core.evaluation.ground_truth import GroundTruth, load_ground_truth
from geoprim_core.evaluation.matching import UNMATCHED, Matching, match_ellipses
from geoprim_core.evaluation.report import POOLED, ImageScore, Report, ReportRow
from geoprim_core.evaluation.runs import OVERLAPS, evaluate_images, score_sequence
from geoprim_core.evaluation.score import Score, pool

__all__ = [
    "OVERLAPS",
    "POOLED",
    "UNMATCHED",
    "GroundTruth",
    "ImageScore",
    "Matching",
    "Report",
    "ReportRow",
    "Score",
    "evaluate_images",
    "load_ground_truth",
    "match_ellipses",
    "pool",
    "score_sequence",
]
