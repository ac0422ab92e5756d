"""One ellipse a picture, under conditions drawn at random: what a covariance is judged by."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core.errors import InputError
from geoprim_core.synthetic.scene import Scene
from geoprim_core.synthetic.shapes import render_ellipses
from geoprim_core.synthetic.variants import degraded
from geoprim_core.types import Ellipses

_SIZES = (8.0, 150.0)
_LEAST_SEMI_MINOR = 4.0
_LEAST_RATIO = 0.2
_CONTRASTS = (30.0, 200.0)
_NOISE = (1.0, 15.0)
_MOST_BLUR = 1.5
_LEAST_VISIBLE = 0.3
_MARGIN = 24
_OUTLINE_SAMPLES = 720

# Shares of the pictures.
_CIRCLES, _OUTLINES, _WHOLE, _SHARP = 0.25, 0.35, 0.5, 0.4


@dataclass(frozen=True, slots=True, eq=False)
class SingleEllipse:
    """A picture of one ellipse and how it was made.

    Attributes
    ----------
    scene : Scene
        Its one ellipse is the truth: of a drawn line the middle, 1.5 pixels wide.
    drawing : "filled" or "outlines"
    contrast : float
        Grey levels between the two sides of an edge.
    noise : float
        Standard deviation of the noise in grey levels.
    blur : float
        Standard deviation of the picture's blur in pixels.
    """

    scene: Scene
    drawing: str
    contrast: float
    noise: float
    blur: float

    @property
    def visible(self) -> float:
        """Share of the outline that nothing hides."""
        return float(self.scene.visible[0])


def single_ellipses(count: int, seed: int) -> Iterator[SingleEllipse]:
    """Yield pictures of one ellipse each, at random places between the pixels.

    A quarter are circles, the others have axis ratios of 0.2 to 1; semi-major axes 8 to 150
    pixels, drawn evenly on a logarithmic scale; 65 % filled, 35 % outlines; half of them behind a
    straight edge that leaves 30 to 100 % visible; contrast 30 to 200 grey levels, noise 1 to 15,
    and 60 % with a blur of up to 1.5 pixels. The same arguments give the same bytes.

    Parameters
    ----------
    count : int
        Number of pictures.
    seed : int

    Yields
    ------
    SingleEllipse

    Raises
    ------
    InputError
        A negative count or seed.

    Examples
    --------
    >>> made = list(single_ellipses(3, seed=1))
    >>> [len(one.scene.ellipses) for one in made]
    [1, 1, 1]
    """
    if min(count, seed) < 0:
        raise InputError("count, seed", "numbers of at least 0", f"{count}, {seed}")
    return (_single(np.random.default_rng([seed, index])) for index in range(count))


def _single(random: np.random.Generator) -> SingleEllipse:
    row, size = _random_row(random)
    drawing = "outlines" if random.random() < _OUTLINES else "filled"
    visible = 1.0 if random.random() < _WHOLE else random.uniform(_LEAST_VISIBLE, 1.0)
    contrast = float(np.exp(random.uniform(*np.log(_CONTRASTS))))
    noise = random.uniform(*_NOISE)
    blur = 0.0 if random.random() < _SHARP else random.uniform(0.0, _MOST_BLUR)
    low = random.uniform(10.0, 245.0 - contrast)
    ground, level = random.permutation([low, low + contrast])
    truth = Ellipses.from_array(row[None])
    levels = np.array([level])
    image = render_ellipses(
        truth, (size, size), drawing=drawing, levels=levels, background=ground
    ).astype(float)
    if visible < 1.0:
        cover = ground if drawing == "outlines" else random.uniform(10.0, 245.0)
        _hide(image, row, visible, random.uniform(0.0, 2.0 * np.pi), cover)
    drawn = (image + 0.5).astype(np.uint8)
    scene = Scene(drawn, truth, np.array([visible]), ("ellipse",), np.ones(1, bool))
    shaken = degraded(scene, noise=noise, blur=blur, seed=int(random.integers(1 << 31)))
    return SingleEllipse(shaken, drawing, contrast, noise, blur)


def _random_row(random: np.random.Generator) -> tuple[FloatArray, int]:
    """Return an ellipse and the size of a square picture that holds it."""
    major = float(np.exp(random.uniform(*np.log(_SIZES))))
    ratio = 1.0 if random.random() < _CIRCLES else random.uniform(_LEAST_RATIO, 1.0)
    minor = max(major * ratio, _LEAST_SEMI_MINOR)
    size = int(2.0 * (major + _MARGIN))
    x, y = 0.5 * (size - 1) + random.uniform(-4.0, 4.0, 2)
    return np.array([x, y, major, minor, random.uniform(0.0, np.pi)]), size


def _hide(
    image: FloatArray, row: FloatArray, visible: float, direction: float, level: float
) -> None:
    """Cover what lies beyond a straight edge that leaves a share of the outline visible."""
    x, y, a, b, angle = row
    t = 2.0 * np.pi * np.arange(_OUTLINE_SAMPLES) / _OUTLINE_SAMPLES
    turn = direction - angle
    reach = a * np.cos(t) * np.cos(turn) + b * np.sin(t) * np.sin(turn)
    order = np.argsort(reach)
    length = np.cumsum(np.hypot(a * np.sin(t), b * np.cos(t))[order])
    edge = reach[order][np.searchsorted(length, visible * length[-1])]
    rows, columns = np.indices(image.shape)
    along = (columns - x) * np.cos(direction) + (rows - y) * np.sin(direction)
    cover = np.clip(along - edge + 0.5, 0.0, 1.0)
    image += cover * (level - image)
