"""Parameters of the edge stage."""

from __future__ import annotations

from dataclasses import dataclass

from geoprim_core.errors import ParameterError
from geoprim_core.params import Params, option

COLOUR_RULES = ("strongest", "gray")
THRESHOLD_RULES = ("auto", "absolute", "fraction")
LINKINGS = ("direction", "junctions")


@dataclass(frozen=True)
class EdgeParams(Params):
    """Parameters of `extract_contours`.

    Raises
    ------
    ParameterError
        A value is out of its range, or a high threshold lies below its low one.
    """

    colour: str = option(
        "strongest",
        "gradient of a colour image: of the channel where it is largest, or of the grey image",
        choices=COLOUR_RULES,
    )
    equalise: bool = option(
        False, "equalise the grey-level histogram first (errata C7); takes the grey image"
    )
    sigma: float = option(
        0.7, "standard deviation of the Gaussian blur", unit="px", low=0.0, high=5.0
    )
    threshold_rule: str = option(
        "auto", "how the hysteresis thresholds are chosen", choices=THRESHOLD_RULES
    )
    low_fraction: float = option(
        0.1, "low threshold as a share of the largest gradient (rule fraction)", low=0.0, high=1.0
    )
    high_fraction: float = option(
        0.2, "high threshold as a share of the largest gradient (rule fraction)", low=0.0, high=1.0
    )
    low_gradient: float = option(
        3.0, "low threshold (rule absolute)", unit="grey levels/px", low=0.0, high=200.0
    )
    high_gradient: float = option(
        7.5, "high threshold (rule absolute)", unit="grey levels/px", low=0.0, high=200.0
    )
    low_auto: float = option(
        0.08, "low threshold in typical gradients (rule auto)", low=0.0, high=10.0
    )
    high_auto: float = option(
        0.2, "high threshold in typical gradients (rule auto)", low=0.0, high=10.0
    )
    noise_factor: float = option(
        2.5,
        "least high threshold in standard deviations of the noise (rule auto)",
        low=0.0,
        high=20.0,
    )
    noise_sigma: float = option(
        1.2,
        "standard deviation that the blur may grow to in a noisy image, 0 for no such growth",
        unit="px",
        low=0.0,
        high=5.0,
    )
    drowned_sigma: float = option(
        1.5,
        "standard deviation that it may grow to where noise all but drowns the edges",
        unit="px",
        low=0.0,
        high=5.0,
    )
    noise_share: float = option(
        0.12,
        "noise of the gradient, in typical gradients, above which the blur grows",
        low=0.01,
        high=1.0,
    )
    stair_sigma: float = option(
        1.0,
        "standard deviation that the blur grows to in an image drawn without grey levels in "
        "between, 0 for no such growth",
        unit="px",
        low=0.0,
        high=5.0,
    )
    linking: str = option("direction", "how edge pixels are joined", choices=LINKINGS)
    max_turn: float = option(
        15.0,
        "largest gradient turn of one step (linking direction)",
        unit="deg",
        low=1.0,
        high=60.0,
    )
    reach: float = option(2.3, "longest step (linking direction)", unit="px", low=1.0, high=2.3)
    max_slant: float = option(
        35.0,
        "largest angle of a step with the edge (linking direction)",
        unit="deg",
        low=5.0,
        high=80.0,
    )
    max_jerk: float = option(
        1.0,
        "share of the bend of a contour that the turn of a step may differ from it more, between "
        "strong pixels of an image blurred for noise or stairs (linking direction)",
        low=0.0,
        high=5.0,
    )
    min_length: int = option(5, "fewest pixels of a contour", unit="px", low=2, high=10000)
    subpixel: bool = option(True, "give sub-pixel edge positions too")

    def __post_init__(self) -> None:
        super().__post_init__()
        for kind in ("fraction", "gradient", "auto"):
            low, high = getattr(self, f"low_{kind}"), getattr(self, f"high_{kind}")
            if high < low:
                expected = f"at least low_{kind} = {low}"
                raise ParameterError(f"high_{kind}", expected, f"{high}")
