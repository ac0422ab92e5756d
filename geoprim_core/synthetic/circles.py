"""Circles on plain ground: filled or drawn, apart, touching or concentric, clean or noisy."""

from __future__ import annotations

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core.errors import InputError
from geoprim_core.synthetic.scene import Scene
from geoprim_core.synthetic.shapes import (
    DRAWINGS,
    GreyImage,
    _choice,
    _frame,
    render_ellipses,
    visible_shares,
)
from geoprim_core.synthetic.variants import degraded
from geoprim_core.types import Ellipses

ARRANGEMENTS = ("apart", "touching", "concentric")

_SMALLEST, _LARGEST = 5.0, 120.0
_GAP = 6.0
_MARGIN = 3.0
_TRIALS = 400
_LEAST_CONTRAST = 50.0


def circles_image(
    count: int,
    seed: int,
    *,
    drawing: str = "filled",
    arrangement: str = "apart",
    noise: float = 0.0,
    size: tuple[int, int] = (640, 480),
    stroke: float = 2.0,
    hard: bool = False,
) -> Scene:
    """Render circles of 5 to 120 pixels radius, all inside the frame.

    Parameters
    ----------
    count : int
        Number of circles wanted; where no more find room there are fewer.
    seed : int
    drawing : "filled" or "outlines"
        The truth of a drawn line is its middle.
    arrangement : "apart", "touching" or "concentric"
        Apart: 6 pixels and more between any two. Touching: all but the first touch an earlier one
        from outside. Concentric: two or three around each centre, 6 pixels and more between them.
    noise : float
        Standard deviation of the Gaussian noise in grey levels.
    size : (width, height) in pixels
    stroke : float
        Width of the lines in pixels.
    hard : bool
        Draw without grey levels in between: a pixel is inside or outside.

    Returns
    -------
    Scene

    Raises
    ------
    InputError
        A count below 1, a negative seed or noise, a frame with no room for the smallest circle, or
        an unknown drawing or arrangement.

    Examples
    --------
    >>> scene = circles_image(4, seed=2, arrangement="touching")
    >>> x, y, r = scene.ellipses.x, scene.ellipses.y, scene.ellipses.semi_major
    >>> bool(abs(np.hypot(x[1] - x[0], y[1] - y[0]) - r[0] - r[1]) < 1e-9)
    True
    """
    _choice(drawing, DRAWINGS, "drawing")
    _choice(arrangement, ARRANGEMENTS, "arrangement")
    frame = _frame(size)
    if count < 1 or seed < 0:
        raise InputError("count, seed", "a count of 1 and a seed of 0 at least", f"{count}, {seed}")
    if min(frame) < 2 * (_SMALLEST + _MARGIN) + 2:
        raise InputError("size", "room for a circle of 5 pixels radius", f"{frame}")
    random = np.random.default_rng([seed, count, ARRANGEMENTS.index(arrangement), *frame])
    place = {"apart": _apart, "touching": _touching, "concentric": _concentric}[arrangement]
    circles = place(random, count, frame)
    rows = np.column_stack([circles, circles[:, 2], np.zeros(len(circles))])
    ellipses = Ellipses.from_array(rows)
    levels, ground = _grey_levels(random, len(circles), drawing)
    kind = "occluded" if drawing == "filled" else "overlapping"
    if hard:
        image = _render_hard(circles, frame, levels, ground, stroke if kind != "occluded" else None)
    else:
        image = render_ellipses(
            ellipses, frame, kind=kind, drawing=drawing, levels=levels, background=ground,
            stroke=stroke,
        )  # fmt: skip
    visible = visible_shares(ellipses, frame, kind="overlapping")
    labels, required = ("circle",) * len(rows), np.ones(len(rows), bool)
    return degraded(Scene(image, ellipses, visible, labels, required), noise=noise, seed=seed)


def _render_hard(
    circles: FloatArray,
    frame: tuple[int, int],
    levels: FloatArray,
    ground: float,
    stroke: float | None,
) -> GreyImage:
    """Draw discs, or lines of a width, of their own level only."""
    x, y = np.meshgrid(np.arange(frame[0]), np.arange(frame[1]))
    image = np.full(x.shape, ground)
    for (cx, cy, r), level in zip(circles, levels, strict=True):
        beyond = np.hypot(x - cx, y - cy) - r
        image[beyond <= 0.0 if stroke is None else np.abs(beyond) <= 0.5 * stroke] = level
    return (image + 0.5).astype(np.uint8)


def _radius(random: np.random.Generator, frame: tuple[int, int]) -> float:
    """Draw a radius, small ones as likely as large ones on a scale of ratios."""
    largest = min(_LARGEST, (min(frame) - 1) / 2 - _MARGIN)
    return float(np.exp(random.uniform(np.log(_SMALLEST), np.log(largest))))


def _inside(circle: FloatArray, frame: tuple[int, int]) -> bool:
    x, y, r = circle
    reach = r + _MARGIN
    return bool(min(x, y, frame[0] - 1 - x, frame[1] - 1 - y) >= reach)


def _free(circle: FloatArray, others: FloatArray, gap: float) -> bool:
    apart = np.hypot(others[:, 0] - circle[0], others[:, 1] - circle[1])
    return bool((apart >= others[:, 2] + circle[2] + gap).all())


def _apart(random: np.random.Generator, count: int, frame: tuple[int, int]) -> FloatArray:
    circles = np.zeros((0, 3))
    for _ in range(_TRIALS):
        radius = _radius(random, frame)
        circle = np.array(
            [random.uniform(0, frame[0] - 1), random.uniform(0, frame[1] - 1), radius]
        )
        if _inside(circle, frame) and _free(circle, circles, _GAP):
            circles = np.vstack([circles, circle])
        if len(circles) == count:
            break
    return circles if len(circles) else _centred(frame)


def _touching(random: np.random.Generator, count: int, frame: tuple[int, int]) -> FloatArray:
    circles = _apart(random, 1, frame)
    for _ in range(_TRIALS):
        if len(circles) == count:
            break
        at = int(random.integers(len(circles)))
        x, y, r = circles[at]
        radius, angle = _radius(random, frame), random.uniform(0, 2 * np.pi)
        reach = r + radius
        circle = np.array([x + reach * np.cos(angle), y + reach * np.sin(angle), radius])
        if _inside(circle, frame) and _free(circle, np.delete(circles, at, axis=0), _GAP):
            circles = np.vstack([circles, circle])
    return circles


def _concentric(random: np.random.Generator, count: int, frame: tuple[int, int]) -> FloatArray:
    """Put one or two smaller circles into each circle that has room for them, outer ones first."""
    circles = np.zeros((0, 3))
    for x, y, radius in _apart(random, count, frame):
        circles = np.vstack([circles, [x, y, radius]])
        for _ in range(int(random.integers(1, 3))):
            if len(circles) >= count or radius - _GAP < _SMALLEST:
                break
            radius = random.uniform(_SMALLEST, radius - _GAP)
            circles = np.vstack([circles, [x, y, radius]])
        if len(circles) >= count:
            break
    return circles


def _centred(frame: tuple[int, int]) -> FloatArray:
    return np.array([[(frame[0] - 1) / 2, (frame[1] - 1) / 2, _SMALLEST]])


def _grey_levels(random: np.random.Generator, count: int, drawing: str) -> tuple[FloatArray, float]:
    """Draw levels that differ from the ground and from the circle before (which may enclose)."""
    ground = float(random.uniform(20, 235))
    if drawing == "outlines":
        dark = ground > 128
        return np.full(count, random.uniform(10, 50) if dark else random.uniform(205, 245)), ground
    levels = np.zeros(count)
    before = ground
    for k in range(count):
        trials = random.uniform(10, 245, 40)
        gaps = np.minimum(np.abs(trials - ground), np.abs(trials - before))
        enough = np.flatnonzero(gaps >= _LEAST_CONTRAST)
        before = levels[k] = trials[enough[0] if len(enough) else gaps.argmax()]
    return levels, ground
