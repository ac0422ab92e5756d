"""What the ten methods of a window of 2 Q + 1 pixels share (thesis 3.6.1, methods 1 to 6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core.params import Params, as_params, option
from geoprim_core.tangent import _kernels_windows as kernels


@dataclass(frozen=True)
class WindowParams(Params):
    """Parameters of a method that looks at as many pixels about every pixel."""

    half_window: int = option(
        10, "Q: pixels on each side of the pixel that count", unit="px", low=1, high=1000
    )


@dataclass(frozen=True)
class Window:
    """A method of a window: what its kernel does, and the smallest Q that fixes its fit."""

    name: str
    kernel: int
    order: int = 0
    least: int = 1

    def estimate(
        self, points: FloatArray, offsets: IntArray, closed: BoolArray, halves: IntArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return directions and curvatures (N,) of many curves with a half-window a pixel.

        NaN where the window reaches beyond an end or meets itself on a closed curve.
        """
        found: tuple[FloatArray, FloatArray] = kernels.window_tangents(
            points, offsets, closed, halves, self.kernel, self.order
        )
        return found


REGRESSIONS = tuple(
    Window(f"lr{order}", kernels.REGRESSION, order, (order + 1) // 2) for order in range(1, 6)
)
EPF = Window("epf", kernels.EXPLICIT, 2)
IPF = Window("ipf", kernels.IMPLICIT)
ICIPF = Window("icipf", kernels.INDEPENDENT)
GAUSSIAN_DERIVATIVE = Window("gaussian_derivative", kernels.GAUSSIAN)
MATAS = Window("matas", kernels.MEDIAN)
WINDOWS = {w.name: w for w in (*REGRESSIONS, EPF, IPF, ICIPF, GAUSSIAN_DERIVATIVE, MATAS)}


def of_curve(points: npt.ArrayLike, closed: bool) -> tuple[FloatArray, IntArray, BoolArray]:
    """Return one curve as points, offsets and closed flags of a batch."""
    curve = _check.points(points)
    return curve, np.array([0, len(curve)]), np.array([bool(closed)])


def window_curve(
    points: npt.ArrayLike, closed: bool, params: WindowParams | None, window: Window
) -> tuple[FloatArray, FloatArray]:
    """Return directions and curvatures of one curve with the same half-window everywhere."""
    checked: WindowParams = as_params(params, WindowParams)
    curve, offsets, flags = of_curve(points, closed)
    return window.estimate(curve, offsets, flags, np.full(len(curve), checked.half_window))


def window_batch(
    points: FloatArray, offsets: IntArray, closed: BoolArray, params: WindowParams, window: Window
) -> FloatArray:
    """Return the directions (N,) of many curves in one kernel call; arguments as in `Contours`."""
    halves = np.full(len(points), params.half_window)
    return window.estimate(points, offsets, closed, halves)[0]
