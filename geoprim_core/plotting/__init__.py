"""Pictures of images, contours, ellipses and scores; matplotlib is imported when one is drawn."""

from geoprim_core.plotting.bounds import plot_bounds_by_length, plot_bounds_by_slope
from geoprim_core.plotting.calibration import plot_coverage, plot_reliability
from geoprim_core.plotting.comparison import plot_alpha, plot_precision_recall, plot_time_accuracy
from geoprim_core.plotting.latencies import plot_latencies
from geoprim_core.plotting.matches import plot_matching
from geoprim_core.plotting.overlays import plot_contours, plot_detections
from geoprim_core.plotting.scaling import plot_growth
from geoprim_core.plotting.scores import plot_scores

__all__ = [
    "plot_alpha",
    "plot_bounds_by_length",
    "plot_bounds_by_slope",
    "plot_contours",
    "plot_coverage",
    "plot_detections",
    "plot_growth",
    "plot_latencies",
    "plot_matching",
    "plot_precision_recall",
    "plot_reliability",
    "plot_scores",
    "plot_time_accuracy",
]
