"""DEB as it walks along pixels (Figure 3.3-1), against the bounds of thesis 3.4."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core.digital import exact_slope_bounds
from geoprim_core.evaluation.reproduce_tangent_bounds import RADII, line_angle
from geoprim_core.synthetic import digital_circle
from geoprim_core.tangent import DebParams, deb
from geoprim_core.tangent.bounds import walk_bound


@dataclass(frozen=True, slots=True)
class WalkRow:
    """DEB as it walks along the pixels of a digitised circle, in degrees.

    `beyond_total` and `beyond_walk` count the pixels above the total bound of their chord, and
    above it with `walk_bound` added.
    """

    rho: float
    radius: float
    pixels: int
    worst: float
    beyond_total: int
    beyond_walk: int


def walk_row(rho: float, radius: float, seed: int, count: int = 10) -> WalkRow:
    """Compare DEB on digitised circles with the total bound, and with that of the walk.

    Examples
    --------
    >>> walk_row(50.0, 10.0, seed=0, count=2).beyond_walk
    0
    """
    random = np.random.default_rng([seed, round(rho)])
    errors, limits = [], []
    for x, y in random.uniform(-1.0, 1.0, (count, 2)).tolist():
        circle = digital_circle(rho, (x, y))
        angle = deb(circle.points, closed=True, params=DebParams(radius=radius))
        known = np.isfinite(angle)
        chords = _pixel_chords(circle.points, radius)[known]
        errors.append(line_angle(chords, circle.tangent[known]))
        limits.append(exact_slope_bounds(chords))
    error, limit = np.concatenate(errors), np.concatenate(limits)
    beyond = error > limit + float(walk_bound(1.0 / rho))
    worst = float(np.degrees(error.max()))
    return WalkRow(rho, radius, len(error), worst, int((error > limit).sum()), int(beyond.sum()))


def walk_rows(seed: int, count: int = 10) -> list[WalkRow]:
    """Return rows for circles of radius 20 to 320, `count` of each, and all of `RADII`.

    Examples
    --------
    >>> sum(row.beyond_walk for row in walk_rows(0, count=1))
    0
    """
    sizes = (20.0, 40.0, 80.0, 160.0, 320.0)
    return [walk_row(rho, radius, seed, count) for rho in sizes for radius in RADII]


def _pixel_chords(points: FloatArray, radius: float) -> FloatArray:
    """Return P2 - P1 of every pixel of a closed curve: the first pixels in the ring about R."""
    reach = min(int(2 * radius) + 4, len(points) - 1)
    ends = []
    for way in (-1, 1):
        around = (np.arange(len(points))[:, None] + way * np.arange(1, reach + 1)) % len(points)
        far = np.hypot(*(points[around] - points[:, None]).transpose(2, 0, 1))
        first = np.argmax(np.abs(far - radius) <= np.sqrt(0.5), axis=1)
        ends.append(points[around[np.arange(len(points)), first]])
    return np.asarray(ends[1] - ends[0])
