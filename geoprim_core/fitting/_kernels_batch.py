"""Kernel that fits every arc of a ragged array by any of the methods."""

from __future__ import annotations

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel
from geoprim_core.fitting._kernels_ahn import ahn_points
from geoprim_core.fitting._kernels_fit import ELLIFIT, NSAF, OK, fit_points_of
from geoprim_core.fitting._kernels_geometric import geometric_points
from geoprim_core.fitting._kernels_hyper import hyper_points
from geoprim_core.fitting._kernels_maini import maini_points
from geoprim_core.fitting._kernels_pencil import pencil_points
from geoprim_core.fitting._kernels_selective import selective_points
from geoprim_core.fitting._kernels_sequential import liu_points

DIRECT, PENCIL, HYPER, MAINI, LIU, AHN, GEOMETRIC, SELECTIVE = range(8)


@kernel
def _fit_one(
    points: FloatArray, weights: FloatArray, kind: int, options: FloatArray
) -> tuple[int, FloatArray, float]:
    """Fit one arc by a kernel and its options (3,)."""
    first, second = options[0], options[1]
    if kind == PENCIL:
        return pencil_points(points, weights, int(first))
    if kind == HYPER:
        return hyper_points(points, weights, first != 0.0)
    if kind == MAINI:
        return maini_points(points, weights, first, int(second))
    if kind == LIU:
        return liu_points(points, weights, first, int(second))
    if kind == AHN:
        return ahn_points(points, weights, int(first), second != 0.0)
    if kind == GEOMETRIC:
        return geometric_points(points, weights, int(first), second)
    if kind == SELECTIVE:
        return selective_points(points, weights, first, second, options[2])
    return fit_points_of(points, weights, ELLIFIT if first == ELLIFIT else NSAF)


@kernel
def fit_many(
    points: FloatArray,
    offsets: IntArray,
    weights: FloatArray,
    kind: int,
    options: FloatArray,
    status: IntArray,
    ellipses: FloatArray,
    residual: FloatArray,
) -> None:
    """Fit an ellipse to every arc: status (k,), ellipse (k, 5), residual (k,)."""
    for k in range(len(offsets) - 1):
        arc = points[offsets[k] : offsets[k + 1]]
        own = weights[offsets[k] : offsets[k + 1]] if len(weights) else weights
        status[k], row, residual[k] = _fit_one(arc, own, kind, options)
        if status[k] == OK:
            ellipses[k] = row
