"""Kernels of the `refined` scheme: the support that all edge points give an ellipse."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_fit import offset_of
from geoprim_core.ecc.refined._kernels_outline import (
    COVERED,
    CROSSING,
    IN_FRAME,
    SQUARES,
    STEPS,
    TURN,
    TURN_COVERED,
    TURNED,
)
from geoprim_core.ecc.refined._kernels_refit import MAD

NEARLY_WHOLE = (0.7, 0.9)  # shares of the outline from which it counts as whole, a little and fully
ROUND_BY_CHANCE = (3.0, 5.0)  # semi-minor axes in pixels at which any blob is round, and no longer
EVEN = (0.03, 0.015)  # scatter in semi-minor axes from which a whole outline counts, and fully
UNEVEN = 90.0  # evidence lost for a scatter of one semi-minor axis
FEW_PIXELS = (40.0, 60.0)  # lengths of an outline in pixels up to which it is small, and no longer
SLANTED = (0.05, 0.1)  # radians between gradients and normals from which they disagree, and fully
ROUND = (0.9, 0.95)  # ratio of the axes from which an outline is round, a little and fully

# Weights of the evidence: of a logistic regression.
SUPPORT_WEIGHT = 3.7  # of the logarithm of the aligned length
SCATTER_WEIGHT = 16.0  # of the scatter in pixels, over the unsupported rest of the outline
OUTSIDE_WEIGHT = 30.0  # of the share beyond the image, over that rest
GOING_ON_WEIGHT, UNEXPLAINED_WEIGHT = 11.5, 7.0  # of both kinds of ends, over that rest
CLUTTER_WEIGHT = 8.0  # of the points across for each along, over that rest
NO_SUPPORT = -17.7  # evidence of nothing
LEAST_RMS, LEAST_SLANT = 0.05, 0.03  # pixels, radians: closer alignment is hardly better
LEAST_ALIGNED = 0.1  # that each pixel counts, however badly aligned

# Columns of the figures of an ellipse, see `Supported`.
EVIDENCE, COVERAGE, TURN_COVERAGE, RMS, ACROSS_EACH, LENGTH, GOING_ON, UNEXPLAINED = range(8)
FIGURES = 8


class Supported(NamedTuple):
    """Ellipses with the support that all edge points give them.

    Attributes
    ----------
    ellipses : (V, 5) float64
    figures : (V, 8) float64
        Evidence (log odds), coverage, covered share of the turn, rms distance, points across the
        outline per supporting one, supported length in pixels, share of the ends of the support
        at which a contour goes on elsewhere, share of the ends of gaps that no edge crosses.
    offsets : (V + 1,) int64
        The support of ellipse k is `support[offsets[k]:offsets[k + 1]]`.
    support : (S,) int64
        Indices of edge points.
    """

    ellipses: FloatArray
    figures: FloatArray
    offsets: IntArray
    support: IntArray


class Weights(NamedTuple):
    """What parts of the evidence count for, in the image at hand.

    Attributes
    ----------
    whole : float
        Evidence that an outline adds which is even and whole or nearly so.
    small : float
        Evidence that one of few pixels loses where gradients are not along its normals.
    noise_scatter : float
        Scatter in pixels that is no misfit, as noise makes it.
    noise_gaps : float
        Share of an outline that noise hides.
    round_scatter : float
        Share of the scatter of a whole and round outline that is no misfit.
    """

    whole: float
    small: float
    noise_scatter: float
    noise_gaps: float
    round_scatter: float


@kernel
def rising(value: float, low: float, high: float) -> float:
    """Return 0 up to `low`, 1 from `high`, and on a line in between."""
    return min(1.0, max(0.0, (value - low) / (high - low)))


@kernel
def evidence_of(
    share: float,
    rms: float,
    slant: float,
    length: float,
    semi_minor: float,
    ratio: float,
    growth: float,
    outside: float,
    weights: Weights,
) -> float:
    """Return the log odds that an ellipse is right, as far as its support tells.

    `share` of the outline is supported over `length` pixels, with a scatter of `rms` pixels, that
    may be `growth` times as long as on a small ellipse, and of `slant` radians; a share `outside`
    lies beyond the image. Close alignment over a length is what chance does not give: an edge
    point at random is as near with a probability in proportion to both scatters, so that their
    logarithms count for each pixel. The rest of the outline is extrapolated: the scatter, and
    what lies beyond the image, count in proportion to it. An outline that is as good as whole
    has more for it than its length, up to a weight: few curves close evenly by chance, but
    for blobs of some pixels. In a noisy image some scatter along the support is no misfit, and a
    gap in an outline that is as good as whole no sign against it: how much comes in `weights`.
    Blobs that close by chance have axes of any `ratio`, hardly one near 1: of the scatter of an
    outline that is whole and round another share is no misfit.
    What is extrapolated from scattered points is as doubtful whatever scatters them.
    """
    aligned = math.log(2.0 / (rms + LEAST_RMS)) - math.log(slant + LEAST_SLANT)
    misfit = math.sqrt(max(0.0, rms * rms - weights.noise_scatter**2))
    whole = rising(share + weights.noise_gaps, NEARLY_WHOLE[0], NEARLY_WHOLE[1])
    misfit *= 1.0 - weights.round_scatter * whole * rising(ratio, ROUND[0], ROUND[1])
    extrapolated = SCATTER_WEIGHT * rms / growth + OUTSIDE_WEIGHT * outside
    doubt = (1.0 - share) * extrapolated + UNEVEN * misfit / semi_minor
    whole *= rising(semi_minor, ROUND_BY_CHANCE[0], ROUND_BY_CHANCE[1])
    whole *= rising(-misfit / semi_minor, -EVEN[0], -EVEN[1])
    support = SUPPORT_WEIGHT * math.log(1.0 + length * max(aligned, LEAST_ALIGNED))
    return float(support + weights.whole * whole - doubt + NO_SUPPORT)


@kernel
def doubt_of_ends(share: float, continuing: float, unexplained: float) -> float:
    """Return what the ends of the supported stretches take from the evidence.

    It counts in proportion to the unsupported rest, as in `evidence_of`.
    """
    return (1.0 - share) * (GOING_ON_WEIGHT * continuing + UNEXPLAINED_WEIGHT * unexplained)


@kernel
def doubt_of_clutter(share: float, across: float) -> float:
    """Return what `across` crossing edge points for each supporting one take from the evidence.

    Mild: it is not known yet which of them belong to other ellipses.
    """
    return CLUTTER_WEIGHT * (1.0 - share) * across


@kernel
def typical_slant(
    points: FloatArray, normals: FloatArray, ellipse: FloatArray, chosen: IntArray, count: int
) -> float:
    """Return the typical angle in radians between the gradients and the normals of an ellipse.

    From the median, so that a neighbour that touches the ellipse has no say.
    """
    cos, sin = math.cos(ellipse[4]), math.sin(ellipse[4])
    slants = np.empty(count)
    for k in range(count):
        p = chosen[k]
        _, nx, ny = offset_of(ellipse, cos, sin, points[p, 0], points[p, 1])
        slants[k] = abs(nx * normals[p, 1] - ny * normals[p, 0])
    return float(MAD * np.median(slants))


@kernel
def doubt_of_small(slant: float, outline: float, weight: float) -> float:
    """Return what slanted gradients take from the evidence of an outline of few pixels.

    Letters, bubbles and specks of texture are as round as a disc to a tenth of a pixel, as far as
    their outline goes; their gradients are not along the normals of an ellipse as those of a disc
    are, also where a shape is but a little squarer than round.
    """
    small = rising(-outline, -FEW_PIXELS[1], -FEW_PIXELS[0])
    return weight * small * rising(slant, SLANTED[0], SLANTED[1])


@inner_kernel
def support_evidence(
    sums: FloatArray,
    count: int,
    length: float,
    ellipse: FloatArray,
    growth: float,
    weights: Weights,
) -> float:
    """Return the evidence of an ellipse from the sums that `collect` made, but for clutter."""
    share = min(sums[COVERED] / sums[IN_FRAME], sums[TURN_COVERED] / sums[TURN])
    rms, slant = math.sqrt(sums[SQUARES] / count), math.sqrt(sums[TURNED] / count)
    outside = 1.0 - sums[IN_FRAME] / sums[STEPS]
    ratio = ellipse[3] / ellipse[2]
    return evidence_of(share, rms, slant, length, ellipse[3], ratio, growth, outside, weights)


@inner_kernel
def hopeless(
    sums: FloatArray,
    count: int,
    stride: float,
    ellipse: FloatArray,
    growth: float,
    weights: Weights,
    least: float,
) -> bool:
    """Tell whether the evidence of a first collection of support is below `least`.

    The scatter counts over the gaps only: a small ellipse is easily some tenths of its size off
    before it is fitted to all of its support.
    """
    share = min(sums[COVERED] / sums[IN_FRAME], sums[TURN_COVERED] / sums[TURN])
    length = stride * sums[COVERED]
    evidence = support_evidence(sums, count, length, ellipse, growth, weights)
    evidence += UNEVEN * math.sqrt(sums[SQUARES] / count) / ellipse[3]
    return bool(evidence - doubt_of_clutter(share, sums[CROSSING] / count) < least)
