"""Maximal digital straight segments: the longest straight pieces that a digital curve holds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray, IntArray
from geoprim_core.digital._kernels import freeman_codes, maximal_segments_of
from geoprim_core.errors import InputError, ParameterError


@dataclass(frozen=True, slots=True, eq=False)
class DigitalSegments:
    """Digital straight segments of one curve of n pixels, in the order of their first pixels.

    Pixel (x, y) of a segment obeys mu <= a x - b y < mu + omega, where omega is max(|a|, |b|) on
    an 8-connected and |a| + |b| on a 4-connected curve, and (b, a) is the direction of travel.
    On a closed curve pixel indices may reach beyond n - 1: take them modulo n.

    Attributes
    ----------
    start, end : (k,) int64
        First and last pixel; start lies in 0 .. n - 1, end >= start.
    a, b, mu, omega : (k,) int64
        Of the shortest direction; a = b = 0 for a segment of one pixel.
    upper : (k, 2) int64
        First and last pixel with a x - b y = mu.
    lower : (k, 2) int64
        First and last pixel with a x - b y = mu + omega - 1.
    """

    start: IntArray
    end: IntArray
    a: IntArray
    b: IntArray
    mu: IntArray
    omega: IntArray
    upper: IntArray
    lower: IntArray

    def __len__(self) -> int:
        """Return the number of segments."""
        return len(self.start)

    @property
    def angle(self) -> FloatArray:
        """Directions of travel (k,) in radians, in (-pi, pi]."""
        result: FloatArray = np.arctan2(self.a, self.b)
        return result


def maximal_segments(
    points: npt.ArrayLike, *, closed: bool = False, connectivity: int = 8
) -> DigitalSegments:
    """Find all maximal digital straight segments of a digital curve, in linear time.

    A segment is maximal if neither the pixel before nor the one behind it can be added. A window
    glides along the curve: pixels are added ahead while it is straight and removed behind until
    the next one fits; both take constant time from the window's leaning pixels.

    Parameters
    ----------
    points : (n, 2) array
        Pixels of the curve in order, whole numbers, each a neighbour of the one before.
    closed : bool
        Whether the last pixel touches the first.
    connectivity : {8, 4}
        8: naive lines, of steps in two directions 45 degrees apart. 4: standard lines, of steps
        along the axes.

    Returns
    -------
    DigitalSegments

    Raises
    ------
    InputError
        The points are not whole numbers or a step does not lead to a neighbour.
    ParameterError
        The connectivity is neither 8 nor 4.

    References
    ----------
    I. Debled-Rennesson and J.-P. Reveilles, "A linear algorithm for segmentation of digital
    curves", IJPRAI 9, 1995 (adding); F. Feschet and L. Tougne, "Optimal time computation of the
    tangent of a discrete curve", DGCI 1999, and J.-O. Lachaud, A. Vialard and F. de Vieilleville,
    "Fast, accurate and convergent tangent estimation on digital contours", Image and Vision
    Computing 25, 2007 (removing); thesis 2.4.3.1; errata P5.

    Examples
    --------
    >>> corner = [(0, 0), (1, 0), (2, 0), (3, 1), (3, 2), (3, 3)]
    >>> found = maximal_segments(corner)
    >>> found.start.tolist(), found.end.tolist()
    ([0, 2], [3, 5])
    >>> found.a.tolist(), found.b.tolist()
    ([1, 3], [3, 1])
    """
    pixels = _check.points(points)
    if connectivity not in (8, 4):
        raise ParameterError("connectivity", "8 or 4", _check.describe(connectivity))
    count = len(pixels)
    if count <= 1:
        single = np.array([[0, 0, 0, 0, 0, 1, 0, 0, 0, 0]], np.int64)
        return _in_order(np.repeat(single, count, axis=0), 1)
    x, y, codes, wrong = freeman_codes(pixels, bool(closed), connectivity == 8)
    if wrong >= 0:
        expected = f"whole numbers, each pixel one of the {connectivity} neighbours of the last"
        raise InputError("points", expected, f"{pixels[wrong : wrong + 2].tolist()} at {wrong}")
    rows = maximal_segments_of(x, y, codes, count, bool(closed), connectivity == 8)
    return _in_order(rows, count)


def is_digital_straight(points: npt.ArrayLike, *, connectivity: int = 8) -> bool:
    """Say whether an open digital curve is one digital straight segment; as `maximal_segments`.

    Examples
    --------
    >>> is_digital_straight([(0, 0), (1, 0), (2, 1), (3, 1)])
    True
    >>> is_digital_straight([(0, 0), (1, 0), (2, 0), (3, 1), (4, 2)])
    False
    """
    return len(maximal_segments(points, connectivity=connectivity)) <= 1


def _in_order(rows: IntArray, count: int) -> DigitalSegments:
    """Return the rows of the kernel with their starts in 0 .. count - 1, rising."""
    turned = int(np.searchsorted(rows[:, 0], count))  # from here on: the second round
    rows = np.concatenate([rows[turned:], rows[:turned]])
    rows[: len(rows) - turned, (0, 1, 6, 7, 8, 9)] -= count
    start, end, b, a, mu, omega = np.ascontiguousarray(rows[:, :6].T)
    return DigitalSegments(start, end, a, b, mu, omega, rows[:, 6:8].copy(), rows[:, 8:10].copy())
