"""The stages of the chain as the nodes run them: core functions on one `DetectorParams`."""

from __future__ import annotations

from geoprim_core._check import AnyArray
from geoprim_core.ecc import DetectorParams, detect_from_contours, find_polygons
from geoprim_core.ecc.refined import RefinedTrace, trace_refined
from geoprim_core.ecc.schemes import SchemeTrace, trace_scheme
from geoprim_core.edges import EdgeTrace, extract_contours, trace_edges
from geoprim_core.types import Contours, EllipseDetections, Polygons
from geoprim_core.warm import warm_scenes

EccTrace = SchemeTrace | RefinedTrace


def find_contours(image: AnyArray, params: DetectorParams) -> Contours:
    """Run the edge stage."""
    return extract_contours(image, params.edges)


def trace_contours(image: AnyArray, params: DetectorParams) -> EdgeTrace:
    """Run the edge stage and keep its steps."""
    return trace_edges(image, params.edges)


def find_ellipses(
    contours: Contours, polygons: Polygons, params: DetectorParams
) -> EllipseDetections:
    """Run the ellipse stage."""
    return detect_from_contours(contours, polygons, params.ecc)


def trace_ellipses(contours: Contours, polygons: Polygons, params: DetectorParams) -> EccTrace:
    """Run the ellipse stage and keep its steps."""
    if params.ecc.scheme == "refined":
        return trace_refined(contours, polygons, params.ecc.refined)
    return trace_scheme(contours, polygons, params.ecc)


def work_once(params: DetectorParams) -> None:
    """Bring every kernel of the chain to run."""
    for image in warm_scenes():
        contours = find_contours(image, params)
        find_ellipses(contours, find_polygons(contours, params), params)
