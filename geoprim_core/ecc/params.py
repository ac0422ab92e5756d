"""Parameters of the ellipse detector, from image to selected ellipses."""

from __future__ import annotations

from dataclasses import dataclass

from geoprim_core.ecc.grouping_params import GroupingParams, SaliencyParams
from geoprim_core.ecc.refined.params import RefinedParams
from geoprim_core.ecc.smooth_params import SmoothParams
from geoprim_core.edges import EdgeParams
from geoprim_core.errors import ParameterError
from geoprim_core.params import Params, group, option
from geoprim_core.polygon import TABLE as POLYGON_TABLE
from geoprim_core.polygon import PolygonParams
from geoprim_core.tangent import TABLE as TANGENT_TABLE
from geoprim_core.tangent import DebParams

SCHEMES = ("refined", "1", "2", "3")


@dataclass(frozen=True)
class EccParams(Params):
    """Parameters of the ECC steps; `refined` belongs to that scheme, the others to 1, 2 and 3."""

    scheme: str = option("refined", "how arcs become ellipses", choices=SCHEMES)
    smooth: SmoothParams = group(SmoothParams)
    tangent_method: str = option(
        "deb", "tangents of the arcs (schemes 1, 2 and 3)", choices=TANGENT_TABLE.names
    )
    tangent: DebParams = group(DebParams)
    grouping: GroupingParams = group(GroupingParams)
    saliency: SaliencyParams = group(SaliencyParams)
    refined: RefinedParams = group(RefinedParams)


@dataclass(frozen=True)
class DetectorParams(Params):
    """Parameters of the whole chain: edges, polygons, ECC."""

    edges: EdgeParams = group(EdgeParams)
    polygon_method: str = option("rdp_mod", "polygonal approximation", choices=POLYGON_TABLE.names)
    polygon: PolygonParams = group(PolygonParams)
    ecc: EccParams = group(EccParams)

    @classmethod
    def for_scheme(cls, scheme: str) -> DetectorParams:
        """Return the settings that belong to a scheme: the thesis' for 1, 2 and 3.

        Raises
        ------
        ParameterError
            There is no such scheme.

        References
        ----------
        Thesis 5.3 (edge detector, contours cut at junctions), 5.6.3 (schemes).

        Examples
        --------
        >>> DetectorParams.for_scheme("3").edges.linking
        'junctions'
        """
        if scheme not in SCHEMES:
            raise ParameterError("scheme", f"one of {', '.join(SCHEMES)}", repr(scheme))
        if scheme == "refined":
            return cls()
        edges = EdgeParams(
            colour="gray",
            sigma=1.0,
            threshold_rule="fraction",
            low_fraction=0.1,
            high_fraction=0.2,
            linking="junctions",
            min_length=5,
            subpixel=False,
        )
        return cls(edges=edges, ecc=EccParams(scheme=scheme))
