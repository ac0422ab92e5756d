"""Hybrid methods: the half-window of every pixel chosen from its maximal segments."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core._check import FloatArray, IntArray, describe
from geoprim_core.errors import ParameterError
from geoprim_core.params import Params, as_params, option
from geoprim_core.tangent.pencils import pencils_of
from geoprim_core.tangent.windows import WINDOWS, Window, of_curve

CHOICES = ("10", "11", "12", "2", "3", "4")
_POWER = 1.5


@dataclass(frozen=True)
class HybridParams(Params):
    """Parameters of the hybrid methods."""

    max_half_window: int = option(
        100, "no half-window is larger; bounds the time on straight curves", unit="px",
        low=1, high=1000,
    )  # fmt: skip


def half_windows(points: npt.ArrayLike, choice: str, *, closed: bool = False) -> IntArray:
    """Choose the half-window Q of every pixel from the maximal segments of the curve.

    With B the number of pixels from the pixel back to the first pixel of its first maximal
    segment, F that from the pixel ahead to the last pixel of its last one, and L the mean number
    of pixels of all maximal segments of the curve:

    ====== ==================== ==========================================
    choice half-window          meaning
    ====== ==================== ==========================================
    10     max(B, F)            of this pixel, the longer side
    11     min(B, F)            the shorter side
    12     (B + F) / 2          their mean
    2      max(B, F)^(3/2)      of this pixel, grown to the optimal order
    3      L                    one for the whole curve
    4      L^(3/2)              one for the whole curve, grown
    ====== ==================== ==========================================

    On a curve of grid step h maximal segments have about h^(-1/3) pixels and smoothing wants
    windows of about h^(-1/2): the power 3/2 leads from one to the other without knowing h.

    Parameters
    ----------
    points : (n, 2) array
        Pixels of the curve in order, whole numbers.
    choice : {"10", "11", "12", "2", "3", "4"}
    closed : bool
        Whether the last pixel touches the first.

    Returns
    -------
    (n,) int64

    Raises
    ------
    InputError
        The points are not whole numbers, or a step is longer than 1000 px.
    ParameterError
        There is no such choice.

    References
    ----------
    F. de Vieilleville and J.-O. Lachaud, "Comparison and improvement of tangent estimators on
    digital curves", Pattern Recognition 42, 2009, which is the thesis' reference [20] (errata T7
    names the paper of 2007); thesis 3.6.1, method 8. What is known: the authors' program ImaGene
    tells 1 (max of B and F), 2 (the same to the power 3/2) and 3 (mean length, rounded down).
    What is assumed: 10 is that program's 1; 11 and 12 are its other symmetric combinations of B
    and F; 4 is to 3 what 2 is to 1.

    Examples
    --------
    >>> line = [(i, i // 2) for i in range(9)]
    >>> half_windows(line, "10").tolist()
    [8, 7, 6, 5, 4, 5, 6, 7, 8]
    >>> half_windows(line, "11").tolist()
    [0, 1, 2, 3, 4, 3, 2, 1, 0]
    """
    if choice not in CHOICES:
        raise ParameterError("choice", f"one of {', '.join(CHOICES)}", describe(choice))
    pencils = pencils_of(points, closed=closed)
    back, ahead = pencils.reaches()
    if choice in ("3", "4"):
        segments = pencils.segments
        pixels = segments.end - segments.start + 1
        mean = float(pixels.mean()) if len(pixels) else 0.0
        return np.full(len(back), int(mean if choice == "3" else mean**_POWER))
    if choice == "11":
        return np.minimum(back, ahead)
    if choice == "12":
        return (back + ahead) // 2
    longer = np.maximum(back, ahead)
    return longer if choice == "10" else (longer**_POWER).astype(np.int64)


def fitting_windows(
    curve: FloatArray, choice: str, closed: bool, window: Window, params: HybridParams
) -> IntArray:
    """Return the half-windows as a method can use them: enough pixels for its fit, no more.

    At the ends of an open curve a window shrinks to the pixels that are there; it stays shorter
    than a closed curve.
    """
    count = len(curve)
    halves = half_windows(curve, choice, closed=closed)
    halves = np.clip(halves, window.least, max(params.max_half_window, window.least))
    if closed:
        return np.minimum(halves, max(count - 1, 0) // 2)
    place = np.arange(count)
    return np.minimum(halves, np.minimum(place, count - 1 - place))


def hybrid_curve(
    points: npt.ArrayLike, closed: bool, params: HybridParams | None, window: Window, choice: str
) -> tuple[FloatArray, FloatArray]:
    """Return directions and curvatures of one curve with half-windows of a choice."""
    checked: HybridParams = as_params(params, HybridParams)
    curve, offsets, flags = of_curve(points, closed)
    halves = fitting_windows(curve, choice, bool(closed), window, checked)
    return window.estimate(curve, offsets, flags, halves)


def _method(window: Window, choice: str) -> Callable[..., FloatArray]:
    def estimate(
        points: npt.ArrayLike, *, closed: bool = False, params: HybridParams | None = None
    ) -> FloatArray:
        return hybrid_curve(points, closed, params, window, choice)[0]

    name = f"{window.name}_h{choice}"
    estimate.__name__ = estimate.__qualname__ = name
    estimate.__doc__ = (
        f"Estimate the direction of travel as `{window.name}`, with half-windows of choice "
        f"{choice}; see `half_windows`."
    )
    return estimate


HYBRIDS = {
    f"{window.name}_h{choice}": _method(window, choice)
    for window in WINDOWS.values()
    for choice in CHOICES
}
