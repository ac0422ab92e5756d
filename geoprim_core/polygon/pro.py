"""PRO: splitting until precision and reliability of every segment are within a tolerance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy.typing as npt

from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core.params import Params, option
from geoprim_core.polygon._kernels_split import PRO, PRO_FIRST, split_curves
from geoprim_core.polygon._one_curve import of_one_curve

SPANS = ("any", "first")


@dataclass(frozen=True)
class ProParams(Params):
    """Parameters of PRO; the thesis finds 0.8 to 1 a reasonable trade-off."""

    tolerance: float = option(
        1.0,
        "largest precision and reliability of a segment, epsilon_0",
        unit="px",
        low=0.0,
        high=10000.0,
    )
    span: str = option(
        "any", "s_max of the reliability: between any two pixels or from the first", choices=SPANS
    )


def pro(
    points: npt.ArrayLike, *, closed: bool = False, params: ProParams | None = None
) -> IntArray:
    """Approximate a curve by a polygon of balanced precision and reliability.

    A segment of M pixels with deviations d is split at its pixel of largest deviation until
    both the precision sqrt(sum d^2 / M) and the reliability sum |d| / s_max are at most the
    tolerance. (2-21) is printed with <, the pseudo-code has <=, which holds here. Deviations are
    true distances from the line through the segment's ends, the root mean square replaces (2-1)
    (errata P1), and s_max is the largest distance between any two pixels, as the text says; the
    printed tables measured it from the first pixel (errata P2, `span="first"`).

    Parameters
    ----------
    points : (n, 2) array
        Points of the curve in order, digital or not; the first is not repeated at the end.
    closed : bool
        Whether the last point leads back to the first; the curve is first split at its two
        mutually farthest pixels (errata P6).
    params : ProParams, optional

    Returns
    -------
    (m,) int64
        Indices of the dominant points, strictly increasing; empty for an empty curve.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array.

    References
    ----------
    D. K. Prasad, C. Quek, M. K. H. Leung and S.-Y. Cho, "A parameter independent line fitting
    method", Asian Conference on Pattern Recognition, 2011; thesis 2.3, (2-18)-(2-21),
    Figure 2.3-1; errata P1, P2, P6.

    Examples
    --------
    >>> step = [(0, 0), (1, 0), (2, 1), (3, 1)]
    >>> pro(step).tolist(), pro(step, params=ProParams(tolerance=0.2)).tolist()
    ([0, 3], [0, 1, 2, 3])
    """
    return of_one_curve(pro_batch, points, closed, params, ProParams)


def pro_batch(
    points: FloatArray, offsets: IntArray, closed: BoolArray, params: ProParams
) -> tuple[IntArray, IntArray]:
    """Approximate many curves in one kernel call; arguments as in `Contours`.

    Returns
    -------
    indices : (M,) int64
    offsets : (K + 1,) int64
        As in `Polygons`.

    Examples
    --------
    >>> import numpy as np
    >>> line = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    >>> indices, offsets = pro_batch(line, np.array([0, 3]), np.array([False]), ProParams())
    >>> indices.tolist(), offsets.tolist()
    ([0, 2], [0, 2])
    """
    result: tuple[IntArray, IntArray]
    test = PRO if params.span == "any" else PRO_FIRST
    result = split_curves(points, offsets, closed, test, params.tolerance)
    return result
