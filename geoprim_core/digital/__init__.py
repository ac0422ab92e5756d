"""Digital geometry that several method rooms build on: straight segments, bounds of chords."""

from geoprim_core.digital.bounds import exact_slope_bounds
from geoprim_core.digital.segments import DigitalSegments, is_digital_straight, maximal_segments

__all__ = [
    "DigitalSegments",
    "exact_slope_bounds",
    "is_digital_straight",
    "maximal_segments",
]
