"""Thesis 5.5.1: one hypothesis stands for all that are similar to it."""

from __future__ import annotations

import numpy as np

from geoprim_core.ecc import _kernels_saliency as kernels
from geoprim_core.ecc.arcs import Arcs
from geoprim_core.ecc.grouping_params import SaliencyParams
from geoprim_core.ecc.hypotheses import Hypotheses
from geoprim_core.ecc.saliency import circumference_ratio


def merge_similar(arcs: Arcs, hypotheses: Hypotheses, params: SaliencyParams) -> Hypotheses:
    """Keep of similar hypotheses the one with the largest angular circumference ratio.

    From the largest ratio down, every hypothesis removes those that overlap it by more than D_0;
    among equal ratios the smaller residual comes first. The overlap is the exact ratio of areas.

    References
    ----------
    Thesis 5.5.1, (5-8), (5-9).
    """
    order = np.lexsort((hypotheses.residual, -circumference_ratio(arcs, hypotheses)))
    kept = kernels.representatives(hypotheses.ellipses, order, params.min_similarity)
    return hypotheses.select(order[kept[order]])
