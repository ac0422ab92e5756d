"""Debug topics: the steps of a stage as images, drawn only while somebody looks at them."""

from __future__ import annotations

from typing import Any

import numpy as np
from sensor_msgs.msg import Image

from geoprim_core._check import AnyArray
from geoprim_core.ecc import DetectorParams
from geoprim_core.io.explain import draw_arcs, draw_edges, draw_hypotheses, judged_hypotheses
from geoprim_core.types import Contours, EllipseDetections, Polygons
from geoprim_ros.chain import (
    find_contours,
    find_ellipses,
    trace_contours,
    trace_ellipses,
)
from geoprim_ros.conversions import image_to_message
from geoprim_ros.stage_node import StageNode, result_qos

_DEPTH = 2


class EdgeDebug:
    """The topic `debug/edges`: the edge map, before it is linked into contours."""

    def __init__(self, node: StageNode) -> None:
        self._edges = node.advertise(Image, "debug/edges", result_qos(_DEPTH))

    def find_contours(self, image: AnyArray, params: DetectorParams, source: Any) -> Contours:
        """Run the edge stage; publish its edge map where somebody looks at it."""
        if not self._edges.get_subscription_count():
            return find_contours(image, params)
        trace = trace_contours(image, params)
        self._edges.publish(image_to_message(draw_edges(trace.edges), source))
        return trace.contours


class EllipseDebug:
    """The topics `debug/arcs` and `debug/hypotheses`: smooth arcs, hypotheses with saliency."""

    def __init__(self, node: StageNode) -> None:
        self._arcs = node.advertise(Image, "debug/arcs", result_qos(_DEPTH))
        self._hypotheses = node.advertise(Image, "debug/hypotheses", result_qos(_DEPTH))

    def wanted(self) -> bool:
        """Tell whether somebody looks at a step."""
        return any(t.get_subscription_count() for t in (self._arcs, self._hypotheses))

    def find_ellipses(
        self,
        contours: Contours,
        polygons: Polygons,
        params: DetectorParams,
        source: Any,
        image: AnyArray | None = None,
    ) -> EllipseDetections:
        """Run the ellipse stage; publish its steps, on an image or on black, where looked at."""
        if not self.wanted():
            return find_ellipses(contours, polygons, params)
        trace = trace_ellipses(contours, polygons, params)
        ground = _black(contours) if image is None else image
        if self._arcs.get_subscription_count():
            self._arcs.publish(image_to_message(draw_arcs(ground, trace), source))
        if self._hypotheses.get_subscription_count():
            picture = draw_hypotheses(ground, judged_hypotheses(trace))
            self._hypotheses.publish(image_to_message(picture, source))
        return trace.detections


def _black(contours: Contours) -> AnyArray:
    width, height = contours.image_size or (1, 1)
    return np.zeros((max(height, 1), max(width, 1)), np.uint8)
