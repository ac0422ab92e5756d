"""Digital geometry that more than one method room builds on: digital straight segments."""

from geoprim_core.digital.segments import DigitalSegments, is_digital_straight, maximal_segments

__all__ = ["DigitalSegments", "is_digital_straight", "maximal_segments"]
