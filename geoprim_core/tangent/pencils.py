"""The pencil of maximal digital straight segments through every pixel of a curve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray, IntArray
from geoprim_core.digital import DigitalSegments, maximal_segments
from geoprim_core.errors import InputError
from geoprim_core.tangent._kernels_pencils import survey, without_corners

LONGEST_STEP = 1000.0


@dataclass(frozen=True, slots=True, eq=False)
class Pencils:
    """Maximal segments of a curve without gaps, and the place of the given pixels on it.

    Attributes
    ----------
    segments : DigitalSegments
        Of the curve without gaps, in the order of their first pixels; none of a single pixel.
    before, behind : (n,) int64
        Place of every given pixel on that curve; of its two neighbours where it was cut.
    count : int
        Pixels of that curve.
    closed : bool
    """

    segments: DigitalSegments
    before: IntArray
    behind: IntArray
    count: int
    closed: bool

    def reaches(self) -> tuple[IntArray, IntArray]:
        """Return how many pixels the pencil of each given pixel reaches back and ahead.

        Back: to the first pixel of its first segment; ahead: to the last pixel of its last one.
        0 where there is no segment.
        """
        start, end = self.segments.start, self.segments.end
        if len(start) == 0:
            return np.zeros_like(self.before), np.zeros_like(self.before)
        if self.closed:  # one more round before and behind
            turns = np.array([[-self.count], [0], [self.count]])
            start, end = (start + turns).ravel(), (end + turns).ravel()
        first = start[np.searchsorted(end, self.before, side="left")]
        last = end[np.searchsorted(start, self.behind, side="right") - 1]
        return self.before - first, last - self.behind


def pencils_of(points: npt.ArrayLike, *, closed: bool) -> Pencils:
    """Find the maximal segments of a curve that may repeat pixels and leave some out.

    A pixel that repeats the one before counts once. Where a step leaves pixels out, as the
    contours of direction linking do, those of the straight line between stand in. A curve with
    steps along the axes only is 4-connected and holds standard lines. In any other the pixels
    at right angles are cut, so that it is 8-connected and holds naive lines.

    Raises
    ------
    InputError
        The points are not whole numbers, or a step is longer than 1000 px.

    Examples
    --------
    >>> found = pencils_of([(0, 0), (1, 0), (1, 0), (4, 0)], closed=False)
    >>> found.before.tolist(), found.count
    ([0, 1, 1, 4], 5)
    >>> corner = pencils_of([(0, 0), (1, 0), (1, 1), (2, 2)], closed=False)
    >>> corner.before.tolist(), corner.behind.tolist(), corner.count
    ([0, 0, 1, 2], [0, 1, 1, 2], 3)
    """
    curve = _check.points(points)
    wrong, longest, neighbours, axial = survey(curve, bool(closed))
    if wrong >= 0:
        raise InputError("points", "whole numbers", f"{curve[wrong].tolist()} at {wrong}")
    if longest > LONGEST_STEP:
        raise InputError("points", f"steps of at most {LONGEST_STEP:.0f} px", f"{longest:.0f} px")
    whole, place = (curve, np.arange(len(curve))) if neighbours else _without_gaps(curve, closed)
    if axial and len(whole) > 1:
        segments = maximal_segments(whole, closed=closed, connectivity=4)
        return Pencils(segments, place, place, len(whole), bool(closed))
    kept = without_corners(whole, bool(closed))
    if kept.all():
        segments = maximal_segments(whole, closed=closed)
        return Pencils(segments, place, place, len(whole), bool(closed))
    last, count = np.cumsum(kept) - 1, int(np.count_nonzero(kept))
    behind = (last + ~kept)[place] % count
    segments = maximal_segments(whole[kept], closed=closed)
    return Pencils(segments, last[place] % count, behind, count, bool(closed))


def _without_gaps(curve: FloatArray, closed: bool) -> tuple[FloatArray, IntArray]:
    """Return the curve in steps of one pixel, and the place of every given pixel on it."""
    steps = np.diff(curve, axis=0, append=curve[:1] if closed else curve[-1:])
    lengths = np.abs(steps).max(axis=1).astype(np.int64)
    kept = lengths.copy()
    if not closed or not kept.any():
        kept[-1] = 1
    place = np.cumsum(kept) - kept
    owner = np.repeat(np.arange(len(curve)), kept)
    along = (np.arange(len(owner)) - place[owner]) / np.maximum(lengths, 1)[owner]
    whole = curve[owner] + np.floor(steps[owner] * along[:, None] + 0.5)
    return whole, place % len(whole)
