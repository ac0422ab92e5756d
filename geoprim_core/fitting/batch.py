"""Fitting an ellipse to every one of many arcs in one call."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import BoolArray, FloatArray, IntArray
from geoprim_core.errors import ParameterError
from geoprim_core.fitting import _kernels_batch as kinds
from geoprim_core.fitting._kernels_arcs import fit_arcs
from geoprim_core.fitting._kernels_batch import fit_many
from geoprim_core.fitting._kernels_fit import ELLIFIT, NSAF, OK
from geoprim_core.fitting._kernels_pencil import (
    CHAUDHURI,
    FITZGIBBON,
    HARKER,
    LINEAR,
    RAW,
    TAUBIN,
)
from geoprim_core.fitting._outcome import (
    REASONS,
    TOO_LARGE,
    TOO_THIN,
    outcome,
)
from geoprim_core.fitting.ahn import AhnParams
from geoprim_core.fitting.fit_params import FitParams
from geoprim_core.fitting.fitzgibbon import FitzgibbonParams
from geoprim_core.fitting.geometric import GeometricParams
from geoprim_core.fitting.hyper import HyperParams
from geoprim_core.fitting.liu import LiuParams
from geoprim_core.fitting.maini import MainiParams
from geoprim_core.fitting.selective import SelectiveParams
from geoprim_core.params import Params
from geoprim_core.types import Contours, EllipseFit, Ellipses

_PLAIN = {
    "nsaf": (kinds.DIRECT, NSAF),
    "halir_flusser": (kinds.DIRECT, NSAF),
    "ellifit": (kinds.DIRECT, ELLIFIT),
    "taubin": (kinds.PENCIL, TAUBIN),
    "harker": (kinds.PENCIL, HARKER),
    "chaudhuri": (kinds.PENCIL, CHAUDHURI),
    "linear": (kinds.PENCIL, LINEAR),
}


@dataclass(frozen=True, slots=True, eq=False)
class EllipseFits:
    """The outcome of many fits, one an arc.

    Attributes
    ----------
    ellipses : Ellipses
        The m ellipses that were found, in the order of their arcs.
    arc : (m,) int64
        The arc of each of them.
    status : (k,) int64
        0 for an ellipse, else the number of a reason.
    residual : (k,) float64
        As of `EllipseFit`; NaN without an ellipse.
    """

    ellipses: Ellipses
    arc: IntArray
    status: IntArray
    residual: FloatArray

    def __len__(self) -> int:
        """Return the number of arcs."""
        return len(self.status)

    def __getitem__(self, index: int) -> EllipseFit:
        """Return the fit of one arc, as its method returns it."""
        status = int(self.status[index])
        if status != OK:
            return EllipseFit(None, REASONS[status])
        place = np.searchsorted(self.arc, index % len(self))
        row = np.array([column[place] for column in self.ellipses.columns()])
        return outcome(status, row, float(self.residual[index]))

    def __iter__(self) -> Iterator[EllipseFit]:
        """Iterate over the fits of all arcs."""
        return (self[k] for k in range(len(self)))

    @property
    def found(self) -> BoolArray:
        """Whether each arc has an ellipse (k,)."""
        return np.asarray(self.status == OK)

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why each arc has no ellipse, empty where it has one."""
        return tuple(REASONS[status] for status in self.status)


def fit_arrays(
    points: FloatArray,
    offsets: IntArray,
    weights: FloatArray,
    method: str,
    params: Params,
) -> EllipseFits:
    """Fit checked arrays; `fit_ellipses` is the face of it.

    Examples
    --------
    >>> points = np.array([[5.0, 0.0], [0, 5], [-5, 0], [0, -5], [3, 4], [4, 3]])
    >>> offsets = np.array([0, 6])
    >>> len(fit_arrays(points, offsets, np.zeros(0), "nsaf", FitParams()).ellipses)
    1
    """
    count = len(offsets) - 1
    status, rows = np.zeros(count, np.int64), np.full((count, 5), np.nan)
    residual = np.full(count, np.nan)
    kind, *options = _kernel_of(method, params)
    if kind == kinds.DIRECT and len(weights) == 0:
        fit_arcs(points, offsets, int(options[0]), status, rows, residual)
    else:
        fit_many(points, offsets, weights, kind, np.array(options), status, rows, residual)
    _limit(status, rows, params)
    arc = np.flatnonzero(status == OK)
    residual[status != OK] = np.nan
    return EllipseFits(Ellipses.from_array(rows[arc]), arc, status, residual)


def ragged(arcs: Contours | Sequence[npt.ArrayLike]) -> tuple[FloatArray, IntArray]:
    """Return arcs as points (N, 2) and offsets (k + 1,); of contours the best known positions.

    Raises
    ------
    InputError
        An arc is not a finite (n, 2) array.

    Examples
    --------
    >>> ragged([[(0, 0), (1, 1)], [(2, 3)]])[1].tolist()
    [0, 2, 3]
    """
    if isinstance(arcs, Contours):
        return arcs.positions, arcs.offsets
    checked = [_check.numbers(arc, f"arcs[{k}]", (None, 2)) for k, arc in enumerate(arcs)]
    offsets = np.cumsum([0, *map(len, checked)])
    points = np.concatenate([np.zeros((0, 2)), *checked])
    if not np.isfinite(points).all():
        for k, arc in enumerate(checked):
            _check.points(arc, f"arcs[{k}]")
    return points, offsets


def _limit(status: IntArray, rows: FloatArray, params: Params) -> None:
    if not isinstance(params, FitParams):
        raise ParameterError("params", "the parameters of a fit", _check.describe(params))
    ok = status == OK
    thin = ok & (rows[:, 3] < params.min_axis_ratio * rows[:, 2])
    status[thin] = TOO_THIN
    if params.max_semi_major > 0:
        status[ok & (rows[:, 2] > params.max_semi_major)] = TOO_LARGE


def _kernel_of(method: str, params: Params) -> tuple[int, float, float, float]:
    """Return the kernel's number and its options, as the method's face would pass them."""
    if isinstance(params, HyperParams):
        return kinds.HYPER, float(params.terms == "all"), 0.0, 0.0
    if isinstance(params, MainiParams):
        return kinds.MAINI, params.noise, float(params.copies), 0.0
    if isinstance(params, LiuParams):
        return kinds.LIU, params.rate, float(params.sweeps), 0.0
    if isinstance(params, AhnParams):
        return kinds.AHN, float(params.iterations), float(params.start == "circle"), 0.0
    if isinstance(params, GeometricParams):
        return kinds.GEOMETRIC, float(params.iterations), params.huber or float("inf"), 0.0
    if isinstance(params, FitzgibbonParams):
        return kinds.PENCIL, float(FITZGIBBON if params.normalise else RAW), 0.0, 0.0
    if isinstance(params, SelectiveParams):
        gap = math.radians(params.direct_gap)
        return kinds.SELECTIVE, params.certainty, params.direct_noise, gap
    kind, first = _PLAIN[method]
    return kind, float(first), 0.0, 0.0
