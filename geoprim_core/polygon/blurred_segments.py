"""Blurred segments: vertices where the widest straight windows of a noisy curve hand over."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import IntArray
from geoprim_core.params import Params, as_params, option
from geoprim_core.polygon._kernels import farthest_pair_of
from geoprim_core.polygon._kernels_blurred import maximal_blurred_segments, vertices_of
from geoprim_core.polygon.bounds import RULES


@dataclass(frozen=True)
class BlurredSegmentsParams(Params):
    """Parameters of the approximation by blurred segments."""

    width: float = option(
        1.5, "largest thickness of a segment along x or y", unit="px", low=0.0, high=1000.0
    )
    bound: str = option(
        "width",
        "thickness allowed: the width, or the digitisation bound of the segment under a rule",
        choices=("width", *RULES),
    )


def blurred_segments(
    points: npt.ArrayLike, *, closed: bool = False, params: BlurredSegmentsParams | None = None
) -> IntArray:
    """Approximate a noisy curve by way of its maximal blurred segments.

    A blurred segment is a stretch of the curve whose convex hull is, along x or along y, at most
    `width` thick in the best direction; maximal ones overlap. Wherever a segment and the last
    one that it meets have pixels in common, the pixel from which their far ends are seen under
    the least angle becomes a vertex. Neighbouring vertices lie in one blurred segment, so the
    pixels from one to the next fill a strip of at most that thickness. With a `bound` rule the
    thickness allowed is d_max of (2-37) for the chord of the window, but at least one pixel, which
    digital lines have, and there is nothing to choose.

    Each segment is built pixel by pixel, ahead and backwards, and most pixels are settled by the
    strip found last, so the time is that of the segments' lengths together: linear in the length of
    a curve whose bends stay (measured exponent 1.0 to 1.14 from 10,000 to 300,000 pixels, noise or
    not), 1.26 for a wave that is scaled up, where more segments overlap, and the square of the
    number of points a pixel where a curve is sampled that densely.

    Parameters
    ----------
    points : (n, 2) array
        Pixels of the curve in order; the first is not repeated at the end.
    closed : bool
        Whether the last pixel touches the first.
    params : BlurredSegmentsParams, optional

    Returns
    -------
    (m,) int64
        Indices of the vertices, strictly increasing; an open curve keeps both ends. A closed
        curve that is one blurred segment gives its two farthest pixels, or the one that it is.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array.

    References
    ----------
    T. P. Nguyen and I. Debled-Rennesson, "A discrete geometry approach for dominant point
    detection", Pattern Recognition 44, 2011; I. Debled-Rennesson, F. Feschet and J.
    Rouyer-Degli, "Optimal blurred segments decomposition of noisy shapes in linear time",
    Computers & Graphics 30, 2006; thesis 2.6.7; errata P4. A zone is taken between a segment and
    the last one that it meets; the sequences of equal turn of the paper are not told apart.

    Examples
    --------
    >>> corner = [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (4, 1), (4, 2), (4, 3), (4, 4)]
    >>> blurred_segments(corner).tolist()
    [0, 4, 8]
    """
    curve = _check.points(points)
    settings: BlurredSegmentsParams = as_params(params, BlurredSegmentsParams)
    count = len(curve)
    if count <= 2:
        return np.arange(count)
    rule = RULES.index(settings.bound) if settings.bound in RULES else -1
    found, whole = maximal_blurred_segments(curve, bool(closed), settings.width, rule)
    if whole:
        first, second = farthest_pair_of(curve)
        return np.unique([first, second])
    return np.unique(vertices_of(curve, found, bool(closed)) % count)
