"""Silhouettes and their borders: closed digital curves, and noise and scaling upon them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import BoolArray, FloatArray
from geoprim_core.errors import InputError
from geoprim_core.synthetic import _kernels_boundary as _kernels

_STEPS = 24  # samples of the outline between two control points

# Control points of each outline, clockwise on the screen; a third number marks a corner.
_OUTLINES: dict[str, tuple[tuple[float, ...], ...]] = {
    "hammer": (
        (8, 22, 1), (10, 10), (30, 6), (62, 8), (78, 4, 1), (80, 26, 1), (62, 22, 1), (50, 24, 1),
        (50, 60), (53, 110, 1), (37, 110, 1), (40, 60), (40, 24, 1), (22, 22),
    ),
    "leaf": (
        (50, 2, 1), (60, 20, 1), (76, 14, 1), (74, 32, 1), (96, 34, 1), (84, 50, 1), (92, 66, 1),
        (68, 66, 1), (54, 78, 1), (53, 104, 1), (47, 104, 1), (46, 78, 1), (32, 66, 1),
        (8, 66, 1), (16, 50, 1), (4, 34, 1), (26, 32, 1), (24, 14, 1), (40, 20, 1),
    ),
    "rabbit": (
        (20, 40), (24, 18), (30, 4, 1), (38, 20), (40, 32, 1), (48, 16), (56, 6, 1), (54, 26),
        (52, 40), (66, 50), (88, 56), (98, 76), (104, 78), (100, 86), (96, 98, 1), (70, 98, 1),
        (66, 90), (44, 92), (40, 98, 1), (24, 98, 1), (30, 80), (22, 62), (8, 56),
    ),
    "plane": (
        (4, 52), (14, 46), (40, 45, 1), (54, 8, 1), (66, 8, 1), (62, 45, 1), (84, 46, 1),
        (94, 28, 1), (102, 28, 1), (99, 52), (102, 76, 1), (94, 76, 1), (84, 58, 1), (62, 59, 1),
        (66, 96, 1), (54, 96, 1), (40, 59, 1), (14, 58),
    ),
    "key": (
        (6, 30), (16, 12), (34, 10), (44, 24, 1), (104, 24, 1), (104, 46, 1), (94, 46, 1),
        (94, 36, 1), (84, 36, 1), (84, 44, 1), (74, 44, 1), (74, 36, 1), (44, 36, 1), (34, 50),
        (16, 48),
    ),
    "fish": (
        (4, 40), (24, 22), (44, 16), (50, 4, 1), (62, 16), (80, 30), (102, 12, 1), (95, 40),
        (102, 68, 1), (80, 50), (60, 60), (52, 72, 1), (42, 62), (22, 56),
    ),
    "bottle": (
        (24, 4, 1), (40, 4, 1), (40, 26), (44, 38), (54, 52), (56, 72), (56, 112, 1), (8, 112, 1),
        (8, 72), (10, 52), (20, 38), (24, 26),
    ),
    "star": (
        (50, 2, 1), (62, 36, 1), (98, 37, 1), (69, 59, 1), (80, 94, 1), (50, 73, 1), (20, 94, 1),
        (31, 59, 1), (2, 37, 1), (38, 36, 1),
    ),
    "spanner": (
        (4, 14, 1), (16, 22, 1), (24, 18, 1), (24, 8, 1), (14, 0, 1), (32, 2), (38, 18), (36, 26),
        (82, 72), (98, 74), (104, 90, 1), (94, 84, 1), (86, 90, 1), (90, 102, 1), (74, 96),
        (70, 82), (26, 36), (10, 32),
    ),
    "hand": (
        (36, 108, 1), (32, 84), (14, 70), (4, 56), (10, 52), (28, 64, 1), (24, 34), (20, 14),
        (27, 10), (34, 30), (38, 52, 1), (39, 28), (40, 6), (48, 5), (50, 28), (50, 52, 1),
        (56, 30), (60, 10), (68, 12), (66, 34), (62, 56, 1), (72, 40), (80, 28), (86, 32),
        (78, 54), (72, 78), (68, 108, 1),
    ),
    "bean": ((10, 30), (30, 8), (60, 10), (84, 28), (86, 54), (68, 62), (50, 48), (28, 56)),
}  # fmt: skip

SILHOUETTES = tuple(_OUTLINES)
"""The names of the silhouettes."""


def silhouette(name: str, *, scale: float = 1.5) -> FloatArray:
    """Render one of the project's own silhouettes and trace its border.

    Outlines are smooth (Catmull-Rom) between corners, about 100 units wide; borders have some
    300 to 700 pixels at the default scale.

    Parameters
    ----------
    name : str
        One of `SILHOUETTES`.
    scale : float
        Pixels a unit.

    Returns
    -------
    (n, 2) float64
        Pixels (x, y) of the closed, 8-connected border.

    Raises
    ------
    InputError
        The name is unknown or the scale not from 0.2 to 100.

    Examples
    --------
    >>> border = silhouette("star")
    >>> bool(np.abs(np.diff(border, axis=0)).max() == 1)
    True
    """
    if name not in _OUTLINES:
        raise InputError("name", "one of " + ", ".join(SILHOUETTES), _check.describe(name))
    if not 0.2 <= scale <= 100:
        raise InputError("scale", "a number from 0.2 to 100", f"{scale}")
    outline = scale * _smooth_outline(_OUTLINES[name]) + 3.0
    width, height = (int(size) + 4 for size in outline.max(axis=0))
    return trace_boundary(_kernels.fill_outline(outline, width, height))


def _smooth_outline(controls: tuple[tuple[float, ...], ...]) -> FloatArray:
    """Return samples of the Catmull-Rom curve through the control points, broken at corners."""
    points = np.array([control[:2] for control in controls], float)
    corner = np.array([len(control) > 2 for control in controls])
    slopes = 0.5 * (np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0))
    t = np.arange(_STEPS)[:, None] / _STEPS
    pieces = []
    for k in range(len(points)):
        m = (k + 1) % len(points)
        chord = points[m] - points[k]
        start = chord if corner[k] else slopes[k]
        end = chord if corner[m] else slopes[m]
        bulge = (start - chord) * (1 - t) - (end - chord) * t
        pieces.append(points[k] + t * chord + t * (1 - t) * bulge)
    return np.concatenate(pieces)


def trace_boundary(mask: npt.ArrayLike) -> FloatArray:
    """Trace the outer border of the largest 8-connected part of a mask.

    Parameters
    ----------
    mask : (H, W) array
        What is not 0 is foreground.

    Returns
    -------
    (n, 2) float64
        Pixels (x, y) of the closed border, neighbours 8-connected; thin parts are walked along
        both sides. Empty where there is no foreground.

    Raises
    ------
    InputError
        The mask is not two-dimensional.

    Examples
    --------
    >>> trace_boundary([[1, 1, 0], [1, 1, 0]]).tolist()
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    """
    flags = np.asarray(mask)
    if flags.ndim != 2:
        raise InputError("mask", "an array (H, W)", _check.describe(flags))
    part = _kernels.largest_part(np.ascontiguousarray(flags != 0))
    if not part.any():
        return np.zeros((0, 2))
    return np.asarray(_kernels.trace_border(part), np.float64)


def fill_boundary(points: npt.ArrayLike, *, margin: int = 4) -> BoolArray:
    """Return the mask of what a closed digital curve encloses, the curve included.

    Parameters
    ----------
    points : (n, 2) array
        Pixels of a closed, 8-connected curve, at least one.
    margin : int
        Free pixels around the curve; pixel (0, 0) of the mask is (min x - margin, min y - margin).

    Raises
    ------
    InputError
        There is no point.

    Examples
    --------
    >>> ring = [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
    >>> int(fill_boundary(ring).sum())
    9
    """
    curve = _check.points(points)
    if len(curve) == 0:
        raise InputError("points", "at least one point", "none")
    pixels = np.rint(curve).astype(np.int64)
    pixels += max(margin, 1) - pixels.min(axis=0)
    width, height = pixels.max(axis=0) + max(margin, 1) + 1
    free = np.ones((height, width), bool)
    free[pixels[:, 1], pixels[:, 0]] = False
    outside: BoolArray = _kernels.flood(free, 0, 0, False)
    return ~outside


def scaled_curve(points: npt.ArrayLike, divisor: float, *, closed: bool = True) -> FloatArray:
    """Return a digital curve at 1 / divisor of its resolution: divided, rounded, repeats dropped.

    Raises
    ------
    InputError
        The divisor is below 1.

    References
    ----------
    Thesis 2.7.1.

    Examples
    --------
    >>> scaled_curve([(0, 0), (1, 0), (2, 0), (3, 0), (4, 0)], 2, closed=False).tolist()
    [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]
    """
    curve = _check.points(points)
    if not divisor >= 1:
        raise InputError("divisor", "a number of at least 1", f"{divisor}")
    return without_repeats(np.floor(curve / divisor + 0.5), closed=closed)


def shrunk_boundary(points: npt.ArrayLike, divisor: int) -> FloatArray:
    """Return the border of what a closed digital curve encloses at 1 / divisor of its resolution.

    A pixel of the small picture is foreground where half of the large ones in it are. Unlike
    that of `scaled_curve` the border is 8-connected without steps round corners.

    Raises
    ------
    InputError
        There is no point, or the divisor is below 1.

    References
    ----------
    Thesis 2.7.1.

    Examples
    --------
    >>> ring = [(0, 0), (1, 0), (2, 0), (3, 0), (3, 1), (3, 2), (3, 3), (2, 3), (1, 3), (0, 3),
    ...         (0, 2), (0, 1)]
    >>> len(shrunk_boundary(ring, 2))
    4
    """
    if not divisor >= 1:
        raise InputError("divisor", "a whole number of at least 1", f"{divisor}")
    mask = fill_boundary(points, margin=2 * divisor)
    height, width = (size // divisor * divisor for size in mask.shape)
    blocks = mask[:height, :width].reshape(height // divisor, divisor, width // divisor, divisor)
    return trace_boundary(blocks.mean(axis=(1, 3)) >= 0.5)


def without_repeats(curve: FloatArray, *, closed: bool) -> FloatArray:
    """Return a curve without points that equal the one before (on a closed curve: cyclically).

    Examples
    --------
    >>> without_repeats(np.array([[0.0, 0], [0, 0], [1, 0], [0, 0]]), closed=True).tolist()
    [[0.0, 0.0], [1.0, 0.0]]
    """
    if len(curve) < 2:
        return curve
    fresh = (curve != np.roll(curve, 1, axis=0)).any(axis=1)
    fresh[0] = True
    kept: FloatArray = curve[fresh]
    while closed and len(kept) > 1 and (kept[-1] == kept[0]).all():
        kept = kept[:-1]
    return kept
