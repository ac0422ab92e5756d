"""Comparison with the truth: one-to-one matching, precision, recall, F-measure, reports."""

from geoprim_core.evaluation.calibration import (
    Reliability,
    ScoredDetections,
    collect_scores,
    cross_scores,
    fit_score,
    measure_reliability,
    reliability_table,
)
from geoprim_core.evaluation.coverage import Coverage, CoverageRow, measure_coverage
from geoprim_core.evaluation.fitting import (
    DetectionCounts,
    FitErrors,
    confocal_distance,
    detection_counts,
    fit_errors,
    focal_bisector_distance,
)
from geoprim_core.evaluation.ground_truth import GroundTruth, load_ground_truth
from geoprim_core.evaluation.matching import UNMATCHED, Matching, match_ellipses
from geoprim_core.evaluation.polygon import (
    CurveMetrics,
    MeanMetrics,
    MeanRelative,
    RelativeMetrics,
    image_metrics,
    mean_relative,
    measure_image,
    measure_polygon,
    relative_metrics,
    set_metrics,
)
from geoprim_core.evaluation.report import POOLED, ImageScore, Report, ReportRow
from geoprim_core.evaluation.runs import OVERLAPS, evaluate_images, score_sequence
from geoprim_core.evaluation.score import Score, pool

__all__ = [
    "OVERLAPS",
    "POOLED",
    "UNMATCHED",
    "Coverage",
    "CoverageRow",
    "CurveMetrics",
    "DetectionCounts",
    "FitErrors",
    "GroundTruth",
    "ImageScore",
    "Matching",
    "MeanMetrics",
    "MeanRelative",
    "RelativeMetrics",
    "Reliability",
    "Report",
    "ReportRow",
    "Score",
    "ScoredDetections",
    "collect_scores",
    "confocal_distance",
    "cross_scores",
    "detection_counts",
    "evaluate_images",
    "fit_errors",
    "fit_score",
    "focal_bisector_distance",
    "image_metrics",
    "load_ground_truth",
    "match_ellipses",
    "mean_relative",
    "measure_coverage",
    "measure_image",
    "measure_polygon",
    "measure_reliability",
    "pool",
    "relative_metrics",
    "reliability_table",
    "score_sequence",
    "set_metrics",
]
