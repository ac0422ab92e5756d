"""The stages of the chain as the nodes run them: core functions on one `DetectorParams`."""

from __future__ import annotations

from geoprim_core._check import AnyArray
from geoprim_core.ecc import DetectorParams, detect_from_contours
from geoprim_core.edges import extract_contours
from geoprim_core.synthetic import disc_image
from geoprim_core.types import Contours, EllipseDetections, Polygons


def find_contours(image: AnyArray, params: DetectorParams) -> Contours:
    """Run the edge stage."""
    return extract_contours(image, params.edges)


def find_ellipses(
    contours: Contours, polygons: Polygons, params: DetectorParams
) -> EllipseDetections:
    """Run the ellipse stage."""
    return detect_from_contours(contours, polygons, params.ecc)


def warm_up_scene() -> AnyArray:
    """Return a small picture that brings every kernel of the chain to run."""
    return disc_image(96, 80, centre=(48.0, 40.0), radius=25.0)
