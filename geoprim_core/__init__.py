"""geoprim: edge contours, polygons, tangents and ellipses for robot perception, without ROS.

Examples
--------
>>> import geoprim_core
>>> from geoprim_core.synthetic import disc_image
>>> found = geoprim_core.detect_ellipses(disc_image(120, 100, centre=(60, 50), radius=30))
>>> len(found), round(float(found.ellipses.semi_major[0]))
(1, 30)
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from geoprim_core.ecc import DetectorParams, detect_ellipses
    from geoprim_core.edges import EdgeParams, extract_contours
    from geoprim_core.fitting import fit_ellipse, fit_ellipses
    from geoprim_core.io.drawing import draw_overlay
    from geoprim_core.io.images import read_image, write_image
    from geoprim_core.polygon import approximate
    from geoprim_core.tangent import estimate_tangents

__version__ = "0.1.0"

__all__ = [
    "DetectorParams",
    "EdgeParams",
    "approximate",
    "detect_ellipses",
    "draw_overlay",
    "estimate_tangents",
    "extract_contours",
    "fit_ellipse",
    "fit_ellipses",
    "read_image",
    "write_image",
]

# Public name -> module. Loaded on first use, so that `import geoprim_core` stays quick; rooms too.
_HOMES = {
    "DetectorParams": "ecc",
    "EdgeParams": "edges",
    "approximate": "polygon",
    "detect_ellipses": "ecc",
    "draw_overlay": "io.drawing",
    "estimate_tangents": "tangent",
    "extract_contours": "edges",
    "fit_ellipse": "fitting",
    "fit_ellipses": "fitting",
    "read_image": "io.images",
    "write_image": "io.images",
}
_ROOMS = (
    "applications", "ecc", "edges", "errors", "evaluation", "fitting", "io", "plotting", "polygon",
    "synthetic", "tangent", "types",
)  # fmt: skip


def __getattr__(name: str) -> Any:
    """Load a room, or a public name from its module, on first use."""
    if name in _ROOMS:
        return import_module(f"geoprim_core.{name}")
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"geoprim_core.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*__all__, *_ROOMS])
