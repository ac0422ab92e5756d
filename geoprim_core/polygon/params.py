"""The parameters of every method of the table, as one group."""

from __future__ import annotations

from dataclasses import dataclass

from geoprim_core.params import Params, group
from geoprim_core.polygon.blurred_segments import BlurredSegmentsParams
from geoprim_core.polygon.break_points import BreakPointsParams
from geoprim_core.polygon.carmona import CarmonaParams
from geoprim_core.polygon.carmona_mod import CarmonaModParams
from geoprim_core.polygon.lowe import LoweParams
from geoprim_core.polygon.masood import MasoodParams
from geoprim_core.polygon.masood_mod import MasoodModParams
from geoprim_core.polygon.optimal import OptimalParams
from geoprim_core.polygon.pro import ProParams
from geoprim_core.polygon.rdp import RdpParams
from geoprim_core.polygon.rdp_mod import RdpModParams
from geoprim_core.polygon.teh_chin import TehChinParams
from geoprim_core.polygon.visvalingam import VisvalingamParams


@dataclass(frozen=True)
class PolygonParams(Params):
    """Parameters of all methods, each under the name of its row; a method reads its own."""

    rdp: RdpParams = group(RdpParams)
    rdp_mod: RdpModParams = group(RdpModParams)
    pro: ProParams = group(ProParams)
    masood: MasoodParams = group(MasoodParams)
    masood_mod: MasoodModParams = group(MasoodModParams)
    carmona: CarmonaParams = group(CarmonaParams)
    carmona_mod: CarmonaModParams = group(CarmonaModParams)
    optimal: OptimalParams = group(OptimalParams)
    lowe: LoweParams = group(LoweParams)
    blurred_segments: BlurredSegmentsParams = group(BlurredSegmentsParams)
    break_points: BreakPointsParams = group(BreakPointsParams)
    teh_chin: TehChinParams = group(TehChinParams)
    visvalingam: VisvalingamParams = group(VisvalingamParams)

    def of(self, method: str) -> Params:
        """Return the parameters of a method of the table.

        Examples
        --------
        >>> PolygonParams().of("rdp")
        RdpParams(tolerance=1.0)
        """
        chosen: Params = getattr(self, method)
        return chosen
