"""The topics of the nodes; all names are relative and can be remapped."""

from __future__ import annotations

from typing import NamedTuple


class Topic(NamedTuple):
    """A topic: its name, type, which nodes publish it and what it holds."""

    name: str
    type: str
    published_by: str
    text: str


TOPICS = (
    Topic("image", "sensor_msgs/Image", "camera or `bag_player`", "the input"),
    Topic(
        "image/compressed",
        "sensor_msgs/CompressedImage",
        "camera",
        "the input with `image_transport: compressed`",
    ),
    Topic(
        "camera_info",
        "sensor_msgs/CameraInfo",
        "camera or `bag_player`",
        "for sizes and markers in metres",
    ),
    Topic("contours", "geoprim_msgs/Contours", "`edges_node`, `detector_node`", "edge contours"),
    Topic(
        "polygons", "geoprim_msgs/Polygons", "`polygons_node`, `detector_node`", "dominant points"
    ),
    Topic(
        "ellipses",
        "geoprim_msgs/EllipseDetections",
        "`ellipses_node`, `detector_node`",
        "ellipses with score and covariance, best first",
    ),
    Topic(
        "detections",
        "geoprim_msgs/Detections",
        "`ellipses_node`, `detector_node`",
        "labelled objects",
    ),
    Topic("overlay", "sensor_msgs/Image", "`overlay_node`", "the image with the results drawn"),
    Topic(
        "markers",
        "visualization_msgs/MarkerArray",
        "`markers_node`",
        "ellipses on the working plane, in the camera's frame; needs `plane_distance`",
    ),
    Topic(
        "image_markers",
        "visualization_msgs/ImageMarker",
        "`markers_node`",
        "outlines for an image panel; (0, 0) is the corner of the image",
    ),
    Topic("debug/edges", "sensor_msgs/Image", "`edges_node`, `detector_node`", "edge map"),
    Topic("debug/arcs", "sensor_msgs/Image", "`ellipses_node`, `detector_node`", "smooth arcs"),
    Topic(
        "debug/hypotheses",
        "sensor_msgs/Image",
        "`ellipses_node`, `detector_node`",
        "hypotheses with their saliency",
    ),
    Topic("/diagnostics", "diagnostic_msgs/DiagnosticArray", "every stage", "counts and times"),
)
