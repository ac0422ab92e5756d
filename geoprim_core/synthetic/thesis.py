"""The synthetic sets of the thesis: crowded random ellipses, occluded or overlapping."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core.errors import InputError
from geoprim_core.synthetic import _kernels
from geoprim_core.synthetic.scene import Scene
from geoprim_core.synthetic.shapes import DRAWINGS, MODES, _choice, render_ellipses, visible_shares
from geoprim_core.types import Ellipses

ALPHAS = (4, 8, 12, 16, 20, 24)
"""The numbers of ellipses in an image of the thesis' sets."""

_LEAST_AXIS = 10.0
_LEAST_VISIBLE = 0.25
_LEAST_CONTRAST = 30.0
_PAPER, _INK = 235.0, 25.0
_LOWEST, _HIGHEST = 12.0, 243.0


def thesis_image(
    count: int,
    seed: int,
    *,
    kind: str = "occluded",
    drawing: str = "filled",
    size: int = 300,
    overhang: int = 0,
    turn: float = 0.0,
    inks: bool = False,
) -> Scene:
    """Render one image of the thesis' synthetic sets.

    Centres, directions and semi-axes (10 .. size / sqrt 2) are drawn uniformly; an ellipse is kept
    if it lies inside the image and shares an area with an earlier one. The same arguments give
    the same bytes.

    Parameters
    ----------
    count : int
        Number of ellipses; the thesis takes 4, 8, 12, 16, 20 and 24 (`ALPHAS`).
    seed : int
    kind : "occluded" (painter's order) or "overlapping" (all outlines complete)
    drawing : "filled" (one grey-level edge an outline) or "outlines" (lines 1.5 pixels wide)
    size : int
        Width and height in pixels.
    overhang : int
        Ellipses may reach so many pixels beyond each side of the image; the thesis has 0.
    turn : float
        The ellipses are turned about the centre by this angle, in radians from +x towards +y,
        before they are drawn; the frame grows to hold the turned one. Nothing is resampled.
    inks : bool
        Outlines are of random grey levels on a random ground, darker ones and brighter ones,
        instead of dark on white.

    Returns
    -------
    Scene
        Its ellipses are those of which at least a quarter of the outline is visible.

    Raises
    ------
    InputError
        A count below 1, a size below 60, a negative seed or overhang, a turn that is not finite,
        or an unknown kind or drawing.

    References
    ----------
    Thesis section 5.6.1, Figure 5.6-1.

    Examples
    --------
    >>> scene = thesis_image(8, seed=3, kind="overlapping")
    >>> len(scene.ellipses), bool((scene.visible == 1).all())
    (8, True)
    """
    _choice(kind, MODES, "kind")
    _choice(drawing, DRAWINGS, "drawing")
    if count < 1:
        raise InputError("count", "at least one ellipse", f"{count}")
    if size < 60:
        raise InputError("size", "at least 60 pixels", f"{size}")
    if min(seed, overhang) < 0:
        raise InputError("seed, overhang", "numbers of at least 0", f"{seed}, {overhang}")
    if not np.isfinite(turn):
        raise InputError("turn", "a finite angle in radians", f"{turn}")
    random = np.random.default_rng([seed, count, size])
    ellipses = _random_ellipses(random, count, size, overhang)
    ellipses, frame = _turned(ellipses, size, turn)
    if inks and drawing == "outlines":
        levels, ground = _random_inks(random, count)
    else:
        levels, ground = _grey_levels(random, ellipses, frame, kind, drawing)
    image = render_ellipses(
        ellipses, frame, kind=kind, drawing=drawing, levels=levels, background=ground
    )
    visible = visible_shares(ellipses, frame, kind=kind)
    kept = np.flatnonzero(visible >= _LEAST_VISIBLE)
    labels = ("ellipse",) * len(kept)
    return Scene(image, ellipses.select(kept), visible[kept], labels, np.ones(len(kept), bool))


def thesis_set(
    images: int, seed: int, *, kind: str = "occluded", drawing: str = "filled", size: int = 300
) -> Iterator[tuple[int, Scene]]:
    """Yield (alpha, scene), `images` of them for each number of ellipses in `ALPHAS`.

    Examples
    --------
    >>> [alpha for alpha, _ in thesis_set(1, seed=0)]
    [4, 8, 12, 16, 20, 24]
    """
    for alpha in ALPHAS:
        for index in range(images):
            yield alpha, thesis_image(alpha, seed + index, kind=kind, drawing=drawing, size=size)


def _random_ellipses(random: np.random.Generator, count: int, size: int, overhang: int) -> Ellipses:
    rows = np.zeros((0, 5))
    while len(rows) < count:
        row = _random_inside(random, size + 2 * overhang)
        if len(rows) == 0 or _kernels.overlap_flags(rows, row).any():
            rows = np.vstack([rows, row])
    return Ellipses.from_array(rows - np.array([overhang, overhang, 0, 0, 0]))


def _turned(ellipses: Ellipses, size: int, turn: float) -> tuple[Ellipses, tuple[int, int]]:
    """Turn ellipses about the centre of a square frame; return them and the frame that holds it."""
    if turn == 0:
        return ellipses, (size, size)
    c, s = np.cos(turn), np.sin(turn)
    side = int(np.ceil(size * (abs(c) + abs(s)) - 1e-9))
    rows = ellipses.array()
    u, v = rows[:, 0] - (size - 1) / 2, rows[:, 1] - (size - 1) / 2
    rows[:, 0] = c * u - s * v + (side - 1) / 2
    rows[:, 1] = s * u + c * v + (side - 1) / 2
    rows[:, 4] = (rows[:, 4] + turn) % np.pi
    return Ellipses.from_array(rows), (side, side)


def _random_inside(random: np.random.Generator, size: int) -> FloatArray:
    """Draw ellipses until one lies inside the image."""
    while True:
        x, y = random.uniform(0, size - 1, 2)
        b, a = np.sort(random.uniform(_LEAST_AXIS, size / np.sqrt(2), 2))
        angle = random.uniform(0, np.pi)
        half_width = np.hypot(a * np.cos(angle), b * np.sin(angle))
        half_height = np.hypot(a * np.sin(angle), b * np.cos(angle))
        margin = min(x - half_width, y - half_height)
        margin = min(margin, size - 1 - x - half_width, size - 1 - y - half_height)
        if margin >= 1:
            return np.array([x, y, a, b, angle])


def _grey_levels(
    random: np.random.Generator,
    ellipses: Ellipses,
    frame: tuple[int, int],
    kind: str,
    drawing: str,
) -> tuple[FloatArray, float]:
    """Return a grey level for each ellipse and for the ground."""
    if drawing == "outlines":
        return np.full(len(ellipses), _INK), _PAPER
    if kind == "occluded":
        return _contrasting_levels(random, ellipses)
    return _added_levels(random, ellipses, frame)


def _random_inks(random: np.random.Generator, count: int) -> tuple[FloatArray, float]:
    """Draw a ground with room on both sides, and grey levels that differ from it."""
    ground = float(random.uniform(_LOWEST + 2 * _LEAST_CONTRAST, _HIGHEST - 2 * _LEAST_CONTRAST))
    low, high = ground - _LEAST_CONTRAST - _LOWEST, _HIGHEST - ground - _LEAST_CONTRAST
    along = random.uniform(-low, high, count)
    return ground + along + np.copysign(_LEAST_CONTRAST, along), ground


def _contrasting_levels(
    random: np.random.Generator, ellipses: Ellipses
) -> tuple[FloatArray, float]:
    """Draw grey levels that differ from the ground and from every ellipse that is touched."""
    ground = float(random.uniform(_LOWEST, _HIGHEST))
    rows = ellipses.array()
    levels = np.zeros(len(rows))
    for k, row in enumerate(rows):
        touched = levels[:k][_kernels.overlap_flags(rows[:k], row)]
        trials = random.uniform(_LOWEST, _HIGHEST, 40)
        gaps = np.abs(trials[:, None] - np.append(touched, ground)[None, :]).min(axis=1)
        enough = np.flatnonzero(gaps >= _LEAST_CONTRAST)
        levels[k] = trials[enough[0] if len(enough) else gaps.argmax()]
    return levels, ground


def _added_levels(
    random: np.random.Generator, ellipses: Ellipses, frame: tuple[int, int]
) -> tuple[FloatArray, float]:
    """Draw grey-level steps, of the sign that keeps the sum small, that fill the grey scale."""
    total = np.zeros((frame[1], frame[0]))
    steps = random.uniform(0.75, 1.25, len(ellipses))
    for k, row in enumerate(ellipses.array()):
        sums = []
        for sign in (1.0, -1.0):
            trial = total.copy()
            _kernels.paint_added(trial, row[None, :], np.array([sign * steps[k]]))
            sums.append(trial)
        best = int(np.ptp(sums[1]) < np.ptp(sums[0]))
        total, steps[k] = sums[best], steps[k] * (1.0, -1.0)[best]
    scale = min((_HIGHEST - _LOWEST) / np.ptp(total), 90.0)
    ground = _LOWEST - scale * total.min()
    return ground + scale * steps, float(ground)
