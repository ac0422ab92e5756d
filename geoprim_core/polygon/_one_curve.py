"""From one curve to the batch kernels, which take many."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import IntArray
from geoprim_core.params import Params, as_params


def of_one_curve(
    batch: Callable[..., tuple[IntArray, IntArray]],
    points: npt.ArrayLike,
    closed: bool,
    params: Params | None,
    wanted: type[Params],
) -> IntArray:
    """Return the vertex indices of one curve, checked, from a batch function.

    Raises
    ------
    InputError
        The points are not a finite (n, 2) array.
    ParameterError
        The parameters are of another class.
    """
    curve = _check.points(points)
    indices, _ = batch(
        curve, np.array([0, len(curve)]), np.array([bool(closed)]), as_params(params, wanted)
    )
    return indices
