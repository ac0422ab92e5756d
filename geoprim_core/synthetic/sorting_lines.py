"""What lies on the four rendered sorting lines, in millimetres, and how it is filmed."""

from __future__ import annotations

from dataclasses import dataclass

from geoprim_core.synthetic._kernels_sorting import COIN, FRUIT, LID, STONE
from geoprim_core.types import Camera

Colour = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class SortingObject:
    """A class of objects: its label, its true size and its looks.

    Attributes
    ----------
    label : str
    diameter : (low, high) in millimetres
        Length of the major axis.
    ratio : (low, high)
        Minor axis divided by major axis.
    colour : (blue, green, red) in [0, 1]
    shape : int
        The kernel's number of the surface.
    body : float
        Height of the body below the outline, in millimetres.
    gloss : float
        Strength of the highlight.
    """

    label: str
    diameter: tuple[float, float]
    ratio: tuple[float, float]
    colour: Colour
    shape: int
    body: float = 0.0
    gloss: float = 0.0


@dataclass(frozen=True, slots=True)
class SortingLine:
    """A belt, its camera and the objects on it.

    Attributes
    ----------
    name : str
    objects : tuple of SortingObject
    distance : float
        From the camera to the belt in metres.
    speed : float
        Movement of the belt to the right, in pixels a frame.
    belt : (blue, green, red) in [0, 1]
    grain : float
        Strength of the belt's texture, relative.
    seam : float
        Distance between the belt's seams, in millimetres.
    fill : float
        Share of the belt that objects would cover if none overlapped.
    spacing : float
        Least distance of two objects, in units of the sum of their mean radii: below 1 they
        overlap.
    shadow : float
        Reach of the drop shadow in millimetres.
    light : (3,)
        Relative brightness in the middle and its change to the right and down.
    noise : float
        Standard deviation of the sensor noise at mid-grey, in grey levels.
    """

    name: str
    objects: tuple[SortingObject, ...]
    distance: float
    speed: float
    belt: Colour
    grain: float
    seam: float
    fill: float
    spacing: float
    shadow: float
    light: tuple[float, float, float]
    noise: float

    def camera(self, size: tuple[int, int]) -> Camera:
        """Return the camera for an image of (width, height) pixels."""
        width, height = size
        return Camera(FOCAL_LENGTH, FOCAL_LENGTH, (width - 1) / 2, (height - 1) / 2, self.distance)

    @property
    def scale(self) -> float:
        """Pixels a millimetre on the belt."""
        return FOCAL_LENGTH / (1000.0 * self.distance)


FOCAL_LENGTH = 620.0
"""Focal length of the rendered camera in pixels."""

_STEEL, _GOLD, _BARE = (0.83, 0.84, 0.82), (0.52, 0.76, 0.88), (0.72, 0.74, 0.76)
_COPPER, _BRASS, _NICKEL = (0.36, 0.50, 0.74), (0.42, 0.68, 0.80), (0.74, 0.77, 0.78)

_CANS = SortingLine(
    name="cans",
    objects=(
        SortingObject("can_52", (52.0, 52.0), (0.74, 0.96), _GOLD, LID, body=38.0),
        SortingObject("can_66", (66.0, 66.0), (0.74, 0.96), _STEEL, LID, body=45.0),
        SortingObject("can_84", (84.0, 84.0), (0.74, 0.96), _BARE, LID, body=40.0),
    ),
    distance=0.52,
    speed=4.0,
    belt=(0.20, 0.27, 0.17),
    grain=0.10,
    seam=260.0,
    fill=0.42,
    spacing=0.90,
    shadow=16.0,
    light=(1.0, -0.28, -0.12),
    noise=3.0,
)
_COINS = SortingLine(
    name="coins",
    objects=(
        SortingObject("coin_18", (18.0, 18.0), (1.0, 1.0), _COPPER, COIN),
        SortingObject("coin_20", (20.5, 20.5), (1.0, 1.0), _BRASS, COIN),
        SortingObject("coin_23", (23.2, 23.2), (1.0, 1.0), _NICKEL, COIN),
        SortingObject("coin_26", (26.0, 26.0), (1.0, 1.0), _BRASS, COIN),
    ),
    distance=0.25,
    speed=5.0,
    belt=(0.24, 0.20, 0.20),
    grain=0.14,
    seam=150.0,
    fill=0.44,
    spacing=0.80,
    shadow=2.6,
    light=(0.95, 0.25, 0.15),
    noise=3.0,
)
_PRODUCE = SortingLine(
    name="produce",
    objects=(
        SortingObject("orange", (76.0, 84.0), (0.93, 1.0), (0.08, 0.46, 0.92), FRUIT, gloss=0.25),
        SortingObject("tomato", (56.0, 64.0), (0.90, 1.0), (0.10, 0.14, 0.80), FRUIT, gloss=0.55),
        SortingObject("lemon", (66.0, 74.0), (0.68, 0.76), (0.16, 0.82, 0.92), FRUIT, gloss=0.20),
    ),
    distance=0.58,
    speed=4.0,
    belt=(0.36, 0.18, 0.07),
    grain=0.08,
    seam=220.0,
    fill=0.44,
    spacing=0.86,
    shadow=22.0,
    light=(0.95, 0.22, -0.20),
    noise=3.0,
)
_ORES = SortingLine(
    name="ores",
    objects=(
        SortingObject("ore_small", (30.0, 38.0), (0.66, 0.96), (0.52, 0.58, 0.62), STONE),
        SortingObject("ore_medium", (46.0, 56.0), (0.62, 0.94), (0.50, 0.60, 0.70), STONE),
        SortingObject("ore_large", (66.0, 80.0), (0.60, 0.92), (0.60, 0.62, 0.62), STONE),
    ),
    distance=0.60,
    speed=4.0,
    belt=(0.15, 0.15, 0.15),
    grain=0.16,
    seam=300.0,
    fill=0.40,
    spacing=0.84,
    shadow=12.0,
    light=(1.0, -0.20, 0.20),
    noise=4.0,
)

SORTING_LINES = {line.name: line for line in (_CANS, _COINS, _PRODUCE, _ORES)}
"""The four rendered sorting lines by name."""
