"""Edge contours: an image becomes ordered 8-connected chains of edge pixels, thesis section 5.3.

Canny edge detector, then one of two linking methods (`TABLE`): `direction` passes through
junctions where the gradient says so, `junctions` cuts there as the thesis does.
"""

from geoprim_core.edges.extraction import TABLE, EdgeTrace, extract_contours, trace_edges
from geoprim_core.edges.params import EdgeParams

__all__ = ["TABLE", "EdgeParams", "EdgeTrace", "extract_contours", "trace_edges"]
