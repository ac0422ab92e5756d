"""Applications: detections as objects with labels and sizes (thesis 6.1)."""

from geoprim_core.applications.sorting import (
    ClassParams,
    SortingParams,
    classify,
    ellipse_outlines,
    size_on_plane,
)

__all__ = ["ClassParams", "SortingParams", "classify", "ellipse_outlines", "size_on_plane"]
