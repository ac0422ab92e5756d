"""Ellipse detection from edge curvature and convexity (ECC), thesis chapter 5.

Smooth arcs (5.3), groups and hypotheses (5.4), saliency and selection (5.5) in a file a section,
listed in `schemes.trace_scheme`; the default scheme has the room `refined`. `TABLE` lists the
schemes; each runs as `detect_ellipses(image, DetectorParams.for_scheme(name))`.
"""

from geoprim_core.ecc.arcs import Arcs, split_arcs
from geoprim_core.ecc.detector import (
    DetectionTrace,
    detect_ellipses,
    detect_from_contours,
    find_polygons,
    trace_detection,
)
from geoprim_core.ecc.grouping_params import GroupingParams, SaliencyParams
from geoprim_core.ecc.params import DetectorParams, EccParams
from geoprim_core.ecc.refined.params import RefinedParams
from geoprim_core.ecc.smooth_params import SmoothParams
from geoprim_core.methods import Method, Table
from geoprim_core.tangent import three_point_centre

_THESIS = "Prasad, Leung and Cho, Pattern Recognition 45, 2012; thesis 5.6.3, scheme"

TABLE = Table(
    "scheme",
    Method(
        "refined",
        detect_ellipses,
        DetectorParams,
        "pairs of arcs verified against all edge points; after thesis chapter 5",
    ),
    Method("1", detect_ellipses, DetectorParams, f"{_THESIS} 1: plain count of votes"),
    Method("2", detect_ellipses, DetectorParams, f"{_THESIS} 2: relationship score"),
    Method("3", detect_ellipses, DetectorParams, f"{_THESIS} 3: search region and convexity too"),
)

__all__ = [
    "TABLE",
    "Arcs",
    "DetectionTrace",
    "DetectorParams",
    "EccParams",
    "GroupingParams",
    "RefinedParams",
    "SaliencyParams",
    "SmoothParams",
    "detect_ellipses",
    "detect_from_contours",
    "find_polygons",
    "split_arcs",
    "three_point_centre",
    "trace_detection",
]
