"""Kernels of the `refined` scheme: the support that all edge points give an ellipse."""

from __future__ import annotations

import math

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc._kernels_refined_fit import offset_of
from geoprim_core.ecc._kernels_refined_outline import (
    COVERED,
    CROSSING,
    IN_FRAME,
    SQUARES,
    STEPS,
    TURN,
    TURN_COVERED,
    TURNED,
    Int32Array,
)
from geoprim_core.ecc._kernels_refined_refit import MAD

TINY = 1e-9  # pixels
NEARLY_WHOLE = (0.7, 0.9)  # shares of the outline from which it counts as whole, a little and fully
ROUND_BY_CHANCE = (3.0, 5.0)  # semi-minor axes in pixels at which any blob is round, and no longer
EVEN = (0.03, 0.015)  # scatter in semi-minor axes from which a whole outline counts, and fully
UNEVEN = 90.0  # evidence lost for a scatter of one semi-minor axis
FEW_PIXELS = (40.0, 60.0)  # lengths of an outline in pixels up to which it is small, and no longer
SLANTED = (0.05, 0.1)  # radians between gradients and normals from which they disagree, and fully
ROUND = (0.9, 0.95)  # ratio of the axes from which an outline is round, a little and fully

# Entries of the array of weights that `evidence_of` takes.
WHOLE_WEIGHT, NOISE_SCATTER, NOISE_GAPS, SMALL_WEIGHT, ROUND_SCATTER = range(5)


@kernel
def index_points(
    points: FloatArray, normals: FloatArray, width: int, height: int
) -> tuple[Int32Array, Int32Array]:
    """Return, for every pixel, the first edge point in it (-1: none) and each point's successor.

    Of two pixels as near that on the brighter side has the point, whichever way the image is
    turned: where the edge lies half a pixel from its pixel, many points are in between.
    """
    head = np.full((height, width), -1, np.int32)
    following = np.full(len(points), -1, np.int32)
    for k in range(len(points) - 1, -1, -1):
        x = int(math.floor(points[k, 0] + TINY * normals[k, 0] + 0.5))
        y = int(math.floor(points[k, 1] + TINY * normals[k, 1] + 0.5))
        if 0 <= x < width and 0 <= y < height:
            following[k] = head[y, x]
            head[y, x] = k
    return head, following


@kernel
def arcs_of_points(order: IntArray, ends: IntArray, total: int) -> IntArray:
    """Return for each of `total` points the arc that it is on, -1 for none."""
    arc_of = np.full(total, -1, np.int64)
    for i in range(len(ends) - 1):
        for k in range(ends[i], ends[i + 1]):
            arc_of[order[k]] = i
    return arc_of


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
    weights: FloatArray,
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
    What is extrapolated from scattered points is as doubtful whatever scatters them. The other
    weights, here and below, are those of a logistic regression.
    """
    aligned = math.log(2.0 / (rms + 0.05)) - math.log(slant + 0.03)
    misfit = math.sqrt(max(0.0, rms * rms - weights[NOISE_SCATTER] ** 2))
    whole = rising(share + weights[NOISE_GAPS], NEARLY_WHOLE[0], NEARLY_WHOLE[1])
    misfit *= 1.0 - weights[ROUND_SCATTER] * whole * rising(ratio, ROUND[0], ROUND[1])
    extrapolated = 16.0 * rms / growth + 30.0 * outside
    doubt = (1.0 - share) * extrapolated + UNEVEN * misfit / semi_minor
    whole *= rising(semi_minor, ROUND_BY_CHANCE[0], ROUND_BY_CHANCE[1])
    whole *= rising(-misfit / semi_minor, -EVEN[0], -EVEN[1])
    support = 3.7 * math.log(1.0 + length * max(aligned, 0.1))
    return float(support + weights[WHOLE_WEIGHT] * whole - doubt - 17.7)


@kernel
def doubt_of_ends(share: float, continuing: float, unexplained: float) -> float:
    """Return what the ends of the supported stretches take from the evidence.

    It counts in proportion to the unsupported rest, as in `evidence_of`.
    """
    return (1.0 - share) * (11.5 * continuing + 7.0 * unexplained)


@kernel
def doubt_of_clutter(share: float, across: float) -> float:
    """Return what `across` crossing edge points for each supporting one take from the evidence.

    Mild: it is not known yet which of them belong to other ellipses.
    """
    return 8.0 * (1.0 - share) * across


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
    weights: FloatArray,
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
    weights: FloatArray,
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
