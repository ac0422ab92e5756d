"""Colours of scores: one ramp for overlays, markers and annotations."""

from __future__ import annotations

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core.errors import InputError

# Violet over pink and orange to yellow: a curve in OKLCH of rising lightness, cut into pieces of
# equal CIELAB length. Lightness alone orders it, so that it holds for colour-blind eyes and on a
# grey screen, and it stays clear of black, which outlines are edged with.
_RAMP = np.array(
    [
        (111, 65, 193), (180, 71, 179), (222, 81, 153), (252, 96, 124), (255, 129, 109),
        (255, 163, 106), (255, 203, 108), (255, 226, 81), (246, 244, 57),
    ]
)  # fmt: skip


def score_colours(score: FloatArray, low: float = 0.0, high: float = 1.0) -> FloatArray:
    """Return the colours (n, 3) of scores: red, green, blue in [0, 1].

    Parameters
    ----------
    score : (n,)
    low, high : float
        Scores of the two ends; what lies outside gets the colour of the nearer end.

    Raises
    ------
    InputError
        `low` is not less than `high`.

    Examples
    --------
    >>> (255 * score_colours(np.array([0.0, 0.5, 1.0]))).round().astype(int).tolist()
    [[111, 65, 193], [255, 129, 109], [246, 244, 57]]
    """
    if not low < high:
        raise InputError("low", f"a score less than high = {high}", f"{low}")
    place = (np.asarray(score, np.float64) - low) / (high - low)
    ends = np.linspace(0.0, 1.0, len(_RAMP))
    return np.stack([np.interp(place, ends, channel / 255) for channel in _RAMP.T], axis=1)
