"""Pictures of images, contours, ellipses and scores; matplotlib is imported when one is drawn."""

from geoprim_core.plotting.calibration import plot_coverage, plot_reliability
from geoprim_core.plotting.overlays import plot_contours, plot_detections
from geoprim_core.plotting.scores import plot_scores

__all__ = [
    "plot_contours",
    "plot_coverage",
    "plot_detections",
    "plot_reliability",
    "plot_scores",
]
