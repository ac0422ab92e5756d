"""Thesis 5.5.3 and 5.5.4: which hypotheses become detections."""

from __future__ import annotations

import numpy as np

from geoprim_core._check import BoolArray, FloatArray
from geoprim_core.ecc.grouping_params import SaliencyParams
from geoprim_core.ecc.saliency import Saliency


def select_salient(saliency: Saliency, params: SaliencyParams | None = None) -> BoolArray:
    """Return the mask (n,) of the hypotheses that are selected.

    By default those that are at least average in every criterion and in sigma_add; else those
    whose sigma_mul or sigma_add reaches a share of the largest one.

    References
    ----------
    Thesis 5.5.3.3 and 5.5.3.4 (thresholds), 5.5.4, (5-16).

    Examples
    --------
    >>> equal = np.array([0.5, 0.5])
    >>> select_salient(Saliency(np.array([0.9, 0.3]), equal, equal)).tolist()
    [True, False]
    """
    chosen = params or SaliencyParams()
    if chosen.selection == "multiplicative":
        return _near_best(saliency.product, chosen.selection_threshold)
    if chosen.selection == "additive":
        return _near_best(saliency.mean, chosen.selection_threshold)
    return (
        _above_average(saliency.alignment)
        & _above_average(saliency.circumference)
        & _above_average(saliency.continuity)
        & _above_average(saliency.mean)
    )


def _above_average(values: FloatArray) -> BoolArray:
    """Return where values reach their average, rounding aside."""
    average = values.mean() if len(values) else 0.0
    return np.asarray(values >= average - 1e-12)


def _near_best(values: FloatArray, share: float) -> BoolArray:
    return np.asarray(values >= share * values.max(initial=0.0) - 1e-12)
