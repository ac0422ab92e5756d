"""Kanungo's model of document degradation: pixels near a border flip by chance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import BoolArray, FloatArray
from geoprim_core.errors import InputError
from geoprim_core.params import Params, as_params, option
from geoprim_core.synthetic.boundaries import fill_boundary, trace_boundary

_FAR = 1e-9  # flips below this probability are left out


@dataclass(frozen=True)
class KanungoParams(Params):
    """Parameters of the degradation; the defaults are those of thesis 2.7.2."""

    alpha_0: float = option(4.0, "foreground: probability at distance 0, cut at 1", low=0.0)
    alpha: float = option(2.0, "foreground: decay with the squared distance", low=0.05)
    beta_0: float = option(4.0, "background: probability at distance 0, cut at 1", low=0.0)
    beta: float = option(2.0, "background: decay with the squared distance", low=0.05)
    eta_foreground: float = option(0.0, "foreground: probability far away", low=0.0, high=1.0)
    eta_background: float = option(0.0, "background: probability far away", low=0.0, high=1.0)
    closing: int = option(3, "diameter of the disc of the closing", unit="px", low=1, high=99)


def degrade_mask(mask: npt.ArrayLike, seed: int, params: KanungoParams | None = None) -> BoolArray:
    """Flip pixels of a mask by chance, most likely along its border, and close the result.

    A foreground pixel at distance d from the nearest background pixel flips with probability
    alpha_0 exp(-alpha d^2) + eta_foreground, a background pixel likewise with beta and its
    distance from the foreground; a morphological closing with a disc follows.

    Parameters
    ----------
    mask : (H, W) array
        What is not 0 is foreground.
    seed : int
    params : KanungoParams, optional

    Returns
    -------
    (H, W) bool

    Raises
    ------
    InputError
        The mask is not two-dimensional or the seed negative.

    References
    ----------
    T. Kanungo, R. M. Haralick and I. Phillips, "Nonlinear global and local document degradation
    models", International Journal of Imaging Systems and Technology 5, 1994; thesis 2.7.2, which
    does not tell the disc of its closing.

    Examples
    --------
    >>> square = np.zeros((40, 40), bool)
    >>> square[10:30, 10:30] = True
    >>> noisy = degrade_mask(square, seed=1)
    >>> bool(noisy[20, 20]), bool(noisy[2, 2]), bool((noisy != square).any())
    (True, False, True)
    """
    flags = np.asarray(mask) != 0
    settings: KanungoParams = as_params(params, KanungoParams)
    if flags.ndim != 2:
        raise InputError("mask", "an array (H, W)", _check.describe(flags))
    if seed < 0:
        raise InputError("seed", "a number of at least 0", f"{seed}")
    fore = _probability(flags, settings.alpha_0, settings.alpha, settings.eta_foreground)
    back = _probability(~flags, settings.beta_0, settings.beta, settings.eta_background)
    draws = np.random.default_rng(seed).random(flags.shape)
    return _closed(flags ^ (draws < np.where(flags, fore, back)), settings.closing)


def degrade_curve(
    points: npt.ArrayLike, seed: int, params: KanungoParams | None = None
) -> FloatArray:
    """Return the border of a degraded silhouette: a noisy version of a closed digital curve.

    Raises
    ------
    InputError
        As `fill_boundary` and `degrade_mask`.

    Examples
    --------
    >>> from geoprim_core.synthetic import silhouette
    >>> noisy = degrade_curve(silhouette("bean"), seed=3)
    >>> bool(np.abs(np.diff(noisy, axis=0)).max() == 1)
    True
    """
    curve = _check.points(points)
    margin = 8
    noisy = trace_boundary(degrade_mask(fill_boundary(curve, margin=margin), seed, params))
    shifted: FloatArray = noisy + (np.rint(curve.min(axis=0)) - margin)
    return shifted


def _probability(flags: BoolArray, first: float, decay: float, far: float) -> FloatArray:
    """Return the flip probability of every pixel of `flags` by its distance from the others."""
    reach = int(np.sqrt(max(np.log(max(first, _FAR) / _FAR), 0.0) / decay)) + 1
    height, width = flags.shape
    around = np.ones((height + 2 * reach, width + 2 * reach), bool)  # beyond the frame: the same
    around[reach : reach + height, reach : reach + width] = flags
    nearest = np.full(flags.shape, np.inf)
    for dy, dx in _disc(2 * reach + 1):
        other = ~around[reach + dy : reach + dy + height, reach + dx : reach + dx + width]
        nearest[other] = np.minimum(nearest[other], dx * dx + dy * dy)
    probability: FloatArray = first * np.exp(-decay * nearest) + far
    return probability


def _disc(diameter: int) -> list[tuple[int, int]]:
    """Return the offsets (dy, dx) of a digital disc."""
    radius = diameter // 2
    span = range(-radius, radius + 1)
    return [(y, x) for y in span for x in span if 4 * (x * x + y * y) <= diameter**2]


def _closed(flags: BoolArray, diameter: int) -> BoolArray:
    """Return the morphological closing with a disc: dilated, then eroded."""
    reach = diameter // 2
    height, width = flags.shape
    grown = np.zeros((height + 2 * reach, width + 2 * reach), bool)
    for dy, dx in _disc(diameter):
        grown[reach + dy : reach + dy + height, reach + dx : reach + dx + width] |= flags
    result = np.ones_like(flags)
    for dy, dx in _disc(diameter):
        result &= grown[reach + dy : reach + dy + height, reach + dx : reach + dx + width]
    return result
