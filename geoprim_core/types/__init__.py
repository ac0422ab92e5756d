"""The data that flows through geoprim: frozen, checked when built, never a bare tuple or dict.

One convention everywhere: points are (x, y), x right, y down, pixel centres at integers; angles
are radians from +x towards +y; an ellipse has semi_major >= semi_minor and its angle in [0, pi).
Many curves are one flat array and offsets: curve k is `points[offsets[k]:offsets[k + 1]]`.
"""

from geoprim_core.types.curves import Contours, Polygons, Tangents
from geoprim_core.types.detections import Camera, Detections, EllipseDetections
from geoprim_core.types.ellipses import Ellipse, EllipseFit, Ellipses

__all__ = [
    "Camera",
    "Contours",
    "Detections",
    "Ellipse",
    "EllipseDetections",
    "EllipseFit",
    "Ellipses",
    "Polygons",
    "Tangents",
]
