"""First steps of the `refined` scheme: edge points, centre lines of strokes, smooth arcs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from operator import itemgetter

import numpy as np

from geoprim_core._check import FloatArray, Int32Array, IntArray
from geoprim_core.ecc.refined import _kernels_arcs as _arcs
from geoprim_core.ecc.refined import _kernels_mates as _mates
from geoprim_core.ecc.refined import _kernels_split as _split
from geoprim_core.ecc.refined import _kernels_stroke as _stroke
from geoprim_core.ecc.refined._kernels_points import EdgeIndex, index_points
from geoprim_core.ecc.refined._kernels_second_look import MateSearch
from geoprim_core.ecc.refined.params import RefinedParams
from geoprim_core.types import Contours

SOBEL_VARIANCE = 0.5  # of the Sobel filter as a blur, in square pixels

_NOISY = (0.8, 1.2)  # pixels of blur from which an image counts as noisy, a little and fully
_SOFT = (1.2, 1.5)  # softness in pixels from which blur hides parts of outlines, a little and fully
_BLUR_HIDES = 0.7  # of what noise hides
_NOISE_HIDES = 0.45  # share of the points on lines of which noise hides the other edge
_ONE_WIDTH = 0.65  # share of the mates across a line that are at its width: of texture, half
_RUN_TOGETHER = 3.3  # width of a line over the softness of its edges
_PICTURE_BLUR = 0.7  # pixels, the least that lines show of the blur of a picture
_ALIKE = 0.5  # pixels between the width of a line and that of most: other gaps vary


@dataclass(frozen=True, slots=True, eq=False)
class EdgePoints:
    """All edge points of an image and where to find them.

    Attributes
    ----------
    index : EdgeIndex
        Positions, those of the edges of drawn lines moved to the line's middle; normals; and which
        points are in each pixel.
    offsets : (K + 1,) int64
        Contour k is `points[offsets[k]:offsets[k + 1]]`.
    heights : (N,) float64
        Length of the grey-level gradient in grey levels per pixel; ones where it is not known.
    stroke : (N,) float64
        Signed width in pixels of the line that a point is on (negative: dark), 0 for none.
    signed : bool
        False where the sign of the gradient means nothing: in line drawings, and when the
        contours carry no gradient.
    spread : float
        Variance of the smoothing of the image in square pixels, that of the Sobel filter
        included; 0 where it is not known or the points are not the steepest places of an image.
    line_spread : float
        That variance with the blur of the picture itself, in square pixels, where the lines of a
        drawing show it; else 0.
    softness : float
        How soft edges typically are: see `Contours.softness`.
    """

    index: EdgeIndex
    offsets: IntArray
    heights: FloatArray
    stroke: FloatArray
    signed: bool
    spread: float
    line_spread: float = 0.0
    softness: float = math.nan

    @property
    def points(self) -> FloatArray:
        """Positions (N, 2) in pixels."""
        return self.index.points

    @property
    def normals(self) -> FloatArray:
        """Unit vectors (N, 2) along the gradient, from dark to bright."""
        return self.index.normals

    @property
    def head(self) -> Int32Array:
        """The first edge point (H, W) of every pixel, -1 for none."""
        return self.index.head

    @property
    def noisiness(self) -> float:
        """How far noise decides where edges lie and break: 0 not, 1 fully.

        By the blur: the edge stage blurs an image more than others when it has measured noise, or
        stairs, of which the outlines lie as badly. So do both edges of a line in a picture that
        is blurred as much: where it bends they are not as far from its middle.
        """
        edge_blur = math.sqrt(max(0.0, self.spread - SOBEL_VARIANCE))
        line_blur = math.sqrt(max(0.0, self.line_spread - self.spread))
        return max(_noisiness(edge_blur), _noisiness(line_blur))

    @property
    def vagueness(self) -> float:
        """How far noise or blur hide parts of outlines: 0 not, 1 fully.

        Blur hides less than noise. What is hidden of one edge of a drawn line the other one shows.
        """
        if not self.signed:
            return 0.0
        soft = 0.0 if math.isnan(self.softness) else _ramp(self.softness, _SOFT)
        return max(self.noisiness, _BLUR_HIDES * soft)

    @property
    def diagonal(self) -> float:
        """The diagonal of the image in pixels."""
        return math.hypot(*self.head.shape)


@dataclass(frozen=True, slots=True, eq=False)
class SmoothArcs:
    """Smooth arcs of edge points, longest first, of those as long the highest over their chord.

    Attributes
    ----------
    indices : (M,) int64
        Indices of edge points, in order along each arc.
    offsets : (A + 1,) int64
        Arc k is `indices[offsets[k]:offsets[k + 1]]`.
    table : (A, 19) float64
        Middle, ends, inner normals, chord, polarity, height and number of points; the columns
        have names in `_kernels_arcs`.
    moments : (A, 25) float64
        Sums of x^p y^q about the middle at [5 p + q], p + q <= 4.
    """

    indices: IntArray
    offsets: IntArray
    table: FloatArray
    moments: FloatArray

    def __len__(self) -> int:
        """Return the number of arcs."""
        return len(self.offsets) - 1


def gather_edges(contours: Contours, params: RefinedParams) -> EdgePoints:
    """Gather the edge points of all contours, those of drawn lines on the centre line.

    A contour is an edge of a line when more than a share `stroke_alone` of its points have an
    edge of the opposite direction at one distance within `stroke_reach`. Where a share
    `stroke_share` of all long contours has, within `drawing_reach`, the image is a line drawing:
    contours are edges of lines unless they are long and nothing says so. Lines have one width:
    bricks and grass have as many edges side by side, at any distance. Blur makes lines wider, up
    to `soft_reach`; what is as wide without it has a plateau between its edges. Both sides of an
    edge are looked at, as the next line may be nearer than its own is wide. Lines darker and lines
    brighter than the ground count together (`both_inks`). The other edge is looked for along the
    normal, and again beside those of the neighbours (`second_look`): normals pass between the
    pixels of an edge that runs diagonally. The points of lines move by half the median line
    width: both edges of a line then give one curve. Reason: each edge alone gives an ellipse that
    is half a line off. The rim of a coin or of a lid has two edges too, of which the outer one
    counts: it parts two different grounds, so that one edge is higher than the other
    (`stroke_evenness`).
    """
    size = _frame(contours)
    points = contours.positions
    normals = _normals(contours)
    signed = contours.gradient_angle is not None
    index = index_points(points, normals, *size)
    heights = contours.gradient_magnitude
    if heights is None:
        heights = np.ones(len(points))
    stroke, moved = np.zeros(len(points)), 0
    if signed and len(points) and max(params.stroke_reach, params.drawing_reach) > 0.0:
        stroke, moved = _stroke_widths(index, heights, contours, params)
    if moved:
        points = points + (0.5 * stroke)[:, np.newaxis] * normals
        index = index_points(points, normals, *size)
    located = signed and contours.subpixel is not None and not math.isnan(contours.blur)
    spread = contours.blur**2 + SOBEL_VARIANCE if located else 0.0
    signed = signed and 2 * moved <= len(points)
    return EdgePoints(
        index,
        contours.offsets,
        heights,
        stroke,
        signed,
        spread,
        0.0 if signed else _line_spread(stroke, spread, contours, params),
        contours.softness,
    )


def _stroke_widths(
    index: EdgeIndex, heights: FloatArray, contours: Contours, params: RefinedParams
) -> tuple[FloatArray, int]:
    """Return the signed width of the line that each point is on, 0 for none, and how many are."""
    shown = _shown_share(contours)
    alone, reach, within = params.stroke_alone * shown, params.stroke_reach, _ALIKE / shown
    widest = max(reach, params.drawing_reach, _soft_reach(contours, params))
    gaps, drawn = _mates.find_mates(
        MateSearch(index, heights, params.stroke_evenness, widest),
        contours.offsets,
        contours.closed,
        params.min_arc if params.second_look else len(contours.points) + 1,
        alone,
        params.stroke_share * shown,
        within,
    )
    common = _common_width(gaps, contours, params) if drawn else 0.0
    return _stroke.stroke_widths(
        gaps, contours.offsets, contours.closed, alone, reach, within, common, params.both_inks
    )


def _noisiness(blur: float) -> float:
    """Return how far noise decides where edges lie, by the standard deviation of the blur."""
    return _ramp(blur, _NOISY)


def _ramp(value: float, limits: tuple[float, float]) -> float:
    """Return 0 up to the first limit, 1 from the second, and on a line in between."""
    return min(1.0, max(0.0, (value - limits[0]) / (limits[1] - limits[0])))


def _line_spread(
    stroke: FloatArray, spread: float, contours: Contours, params: RefinedParams
) -> float:
    """Return the variance of what has blurred lines whose edges run together, 0 for other lines.

    Either edge of a hair line falls as one that is smoothed with half of that variance. It is not
    told from the width of the line where the picture was blurred but a little.
    """
    widths = np.abs(stroke[stroke != 0.0])
    width = float(np.median(widths)) if len(widths) else 0.0
    found = 2.0 * contours.softness**2
    blurred = width < _soft_reach(contours, params) and found > spread + _PICTURE_BLUR**2
    return found if blurred else 0.0


def _shown_share(contours: Contours) -> float:
    """Return the share of the points on lines of which noise does not hide the other edge."""
    noise = 0.0 if math.isnan(contours.blur) else _noisiness(contours.blur)
    return 1.0 - _NOISE_HIDES * noise


def _soft_reach(contours: Contours, params: RefinedParams) -> float:
    """Return how wide a line may be whose two edges run into each other, 0 where not known.

    That of a hair line is 2.8 times as wide as its edges are soft; from 3.3 times on there is a
    plateau in between.
    """
    if math.isnan(contours.softness):
        return 0.0
    return min(params.soft_reach, _RUN_TOGETHER * contours.softness)


def _common_width(gaps: FloatArray, contours: Contours, params: RefinedParams) -> float:
    """Return the signed width of the lines of a line drawing, 0 where the image is none.

    On one side of enough points on long contours there are mates at one distance. Where neither
    side makes it a drawing, both together may: lines darker and brighter than the ground.
    """
    dark, bright = _mates.gaps_of_long(gaps, contours.offsets)
    least = params.stroke_share * _shown_share(contours) * len(dark)
    widths = [_one_width(mates[mates > 0.0], least) for mates in (dark, bright)]
    sign = 1.0 if widths[1][1] > widths[0][1] else -1.0
    width = max(widths, key=itemgetter(1))[0]
    if width == 0.0 and params.both_inks:
        sign = 1.0 if np.count_nonzero(bright) > np.count_nonzero(dark) else -1.0
        nearer = np.where((dark > 0.0) & ~((bright > 0.0) & (bright < dark)), dark, bright)
        width = _one_width(nearer[nearer > 0.0], least)[0]
    return sign * width


def _one_width(mates: FloatArray, least: float) -> tuple[float, int]:
    """Return the distance of most mates and how many lie at it, zeros where they are too few."""
    if not len(mates) > least:
        return 0.0, 0
    width = float(np.median(mates))
    alike = int(np.count_nonzero(np.abs(mates - width) < _ALIKE))
    return (width, alike) if alike > max(least, _ONE_WIDTH * len(mates)) else (0.0, 0)


def _frame(contours: Contours) -> tuple[int, int]:
    if contours.image_size is not None:
        return contours.image_size
    if len(contours.points) == 0:
        return 1, 1
    far = np.maximum(contours.points.max(axis=0), 0.0)
    return int(far[0]) + 2, int(far[1]) + 2


def _normals(contours: Contours) -> FloatArray:
    if contours.gradient_angle is not None:
        return _arcs.unit_vectors(contours.gradient_angle)
    return _arcs.chain_normals(contours.positions, contours.offsets, contours.closed)


def split_arcs(edges: EdgePoints, contours: Contours, params: RefinedParams) -> SmoothArcs:
    """Split the contours into smooth arcs and keep those that are long and bent enough.

    Contours are cut at sharp turns and inflexions; the sign of the turn is that of the local
    majority (the thesis compares all turns with the first, errata C1). What one ellipse does not
    fit within `max_arc_rms` is split further, the longest part that one fits first: a contour may
    leave an ellipse smoothly.

    References
    ----------
    Thesis 5.3.3, 5.3.4 (sharp turns, inflexion points); errata C1.
    """
    indices, ends, vertices = _split.split_contours(
        edges.points,
        contours.offsets,
        contours.closed,
        params.flatness,
        math.radians(params.max_turn),
        params.min_arc,
    )
    indices, ends = _split.split_misfits(
        edges.points, indices, ends, vertices, params.max_arc_rms, params.min_arc
    )
    table, moments = _arcs.describe_arcs(edges.points, edges.normals, indices, ends)
    kept = _arcs.longest_first(table, params.min_sagitta)  # not by where they lie
    return SmoothArcs(*_arcs.gather(indices, ends, table, moments, kept))
