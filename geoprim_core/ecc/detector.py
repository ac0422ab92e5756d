"""The ellipse detector: image, contours, polygons, ellipses."""

from __future__ import annotations

from dataclasses import dataclass

from geoprim_core._check import AnyArray
from geoprim_core.ecc.params import DetectorParams, EccParams
from geoprim_core.ecc.refined import RefinedTrace, detect_refined, trace_refined
from geoprim_core.ecc.schemes import SchemeTrace, trace_scheme
from geoprim_core.edges import EdgeTrace, extract_contours, trace_edges
from geoprim_core.params import as_params
from geoprim_core.polygon import approximate
from geoprim_core.types import Contours, EllipseDetections, Polygons


@dataclass(frozen=True, slots=True, eq=False)
class DetectionTrace:
    """Every intermediate result of `detect_ellipses`.

    Attributes
    ----------
    edges : EdgeTrace
    contours : Contours
    polygons : Polygons
    ecc : SchemeTrace or RefinedTrace
        By the scheme.
    detections : EllipseDetections
    """

    edges: EdgeTrace
    contours: Contours
    polygons: Polygons
    ecc: SchemeTrace | RefinedTrace
    detections: EllipseDetections


def detect_ellipses(image: AnyArray, params: DetectorParams | None = None) -> EllipseDetections:
    """Detect the ellipses in an image, best first.

    Parameters
    ----------
    image : (H, W), (H, W, 3) or (H, W, 4) uint8, uint16, float32 or float64
        Colours in the order blue, green, red (alpha).
    params : DetectorParams, optional
        `DetectorParams.for_scheme` gives the settings of the thesis.

    Raises
    ------
    ImageError
        The image is empty, of another shape or type, or holds NaN or infinity.
    ParameterError
        `params` is not a `DetectorParams`.

    References
    ----------
    Thesis chapter 5.

    Examples
    --------
    >>> import numpy as np
    >>> y, x = np.mgrid[0:100, 0:120]
    >>> disc = np.clip(30.5 - np.hypot(x - 60, y - 50), 0, 1) * 200
    >>> found = detect_ellipses(disc.astype(np.uint8), DetectorParams.for_scheme("3"))
    >>> found.ellipses.x.round().tolist(), found.ellipses.semi_major.round().tolist()
    ([60.0], [30.0])
    """
    chosen: DetectorParams = as_params(params, DetectorParams)
    contours = extract_contours(image, chosen.edges)
    if chosen.ecc.scheme == "refined":  # reads no polygons
        return detect_refined(contours, None, chosen.ecc.refined)
    return detect_from_contours(contours, find_polygons(contours, chosen), chosen.ecc)


def detect_from_contours(
    contours: Contours, polygons: Polygons, params: EccParams | None = None
) -> EllipseDetections:
    """Detect ellipses from edge contours and their polygonal approximations, best first.

    Parameters
    ----------
    contours : Contours
        Scheme `refined` does best with sub-pixel positions and gradient angles.
    polygons : Polygons
        Those of the contours, one each; `refined` does not read them.
    params : EccParams, optional

    Raises
    ------
    InputError
        The polygons are not those of the contours (schemes 1, 2 and 3).
    ParameterError
        `params` is not an `EccParams`.

    References
    ----------
    Thesis 5.3.1 to 5.5.4.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 2 * np.pi, 240, endpoint=False)
    >>> circle = np.stack([60 + 40 * np.cos(t), 50 + 40 * np.sin(t)], axis=1).round()
    >>> contours = Contours(circle, [0, 240], [True], (120, 100))
    >>> polygons = Polygons(np.arange(0, 240, 12), [0, 20], [True])
    >>> found = detect_from_contours(contours, polygons, EccParams(scheme="1"))
    >>> found.ellipses.y.round().tolist()
    [50.0]
    """
    chosen: EccParams = as_params(params, EccParams)
    if chosen.scheme == "refined":
        return detect_refined(contours, polygons, chosen.refined)
    return trace_scheme(contours, polygons, chosen).detections


def trace_detection(image: AnyArray, params: DetectorParams | None = None) -> DetectionTrace:
    """Detect the ellipses in an image and keep every intermediate result.

    It takes longer than `detect_ellipses`, whose detections it gives: polygons are made whether
    the scheme reads them or not.

    Parameters
    ----------
    image : array
        As `detect_ellipses` takes it.
    params : DetectorParams, optional

    Raises
    ------
    ImageError, ParameterError
        As `detect_ellipses`.

    Examples
    --------
    >>> import numpy as np
    >>> trace = trace_detection(np.zeros((40, 50), np.uint8), DetectorParams.for_scheme("2"))
    >>> len(trace.contours), len(trace.detections)
    (0, 0)
    """
    chosen: DetectorParams = as_params(params, DetectorParams)
    edges = trace_edges(image, chosen.edges)
    polygons = find_polygons(edges.contours, chosen)
    ecc: SchemeTrace | RefinedTrace
    if chosen.ecc.scheme == "refined":
        ecc = trace_refined(edges.contours, polygons, chosen.ecc.refined)
    else:
        ecc = trace_scheme(edges.contours, polygons, chosen.ecc)
    return DetectionTrace(edges, edges.contours, polygons, ecc, ecc.detections)


def find_polygons(contours: Contours, params: DetectorParams) -> Polygons:
    """Approximate contours by the method that the parameters name.

    References
    ----------
    Thesis 5.3 (polygons of edge contours), 2.5.1.2 (the default method).

    Examples
    --------
    >>> corner = [(x, 0) for x in range(9)] + [(8, y) for y in range(1, 9)]
    >>> find_polygons(Contours(corner, [0, 17], [False]), DetectorParams()).indices.tolist()
    [0, 8, 16]
    """
    method = params.polygon_method
    return approximate(contours, method=method, params=params.polygon.of(method))
