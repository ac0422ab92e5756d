"""How the time of each stage grows with the image and with the number of arcs."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from geoprim_core._check import AnyArray, FloatArray
from geoprim_core.ecc import DetectorParams, detect_from_contours, find_polygons
from geoprim_core.edges import extract_contours
from geoprim_core.errors import InputError
from geoprim_core.evaluation.speed import STAGES, one_processor
from geoprim_core.types import Contours

SIZES = ((320, 240), (640, 480), (1280, 960), (2048, 1536), (4096, 3072))
ARC_COUNTS = (50, 200, 1000, 5000, 20000)
_CHAIN = len(STAGES)


@dataclass(frozen=True, slots=True, eq=False)
class Growth:
    """Times of one kind of input at rising sizes.

    Attributes
    ----------
    name : str
        What the input is.
    size_name : str
        What `size` counts: "pixels" or "arcs".
    size : (k,) float64
    edge_pixels : (k,) float64
        Number of contour points.
    found : (k,) float64
        Number of ellipses found: where it stops to grow, a bound of the work has been reached.
    seconds : (k, 3) float64
        Time of `STAGES`; NaN for a stage that was not run.
    """

    name: str
    size_name: str
    size: FloatArray
    edge_pixels: FloatArray
    found: FloatArray
    seconds: FloatArray

    @property
    def columns(self) -> FloatArray:
        """The stages' and the whole chain's seconds (k, 4)."""
        whole = np.nansum(self.seconds, axis=1)
        return np.column_stack([self.seconds, whole])


def fitted_exponent(size: FloatArray, seconds: FloatArray) -> float:
    """Return p of seconds = c * size^p, by least squares of the logarithms.

    NaN where fewer than two times are known.

    Examples
    --------
    >>> round(fitted_exponent(np.array([1.0, 2.0, 4.0]), np.array([3.0, 12.0, 48.0])), 9)
    2.0
    """
    known = np.isfinite(seconds) & (seconds > 0) & (size > 0)
    if known.sum() < 2:
        return float("nan")
    return float(np.polyfit(np.log(size[known]), np.log(seconds[known]), 1)[0])


def measure_images(
    name: str,
    image_of: Callable[[int, int], AnyArray],
    params: DetectorParams | None = None,
    *,
    sizes: Sequence[tuple[int, int]] = SIZES,
    repeat: int = 3,
    after_size: Callable[[], object] | None = None,
) -> Growth:
    """Time the stages on images of rising size; the least of the repeats counts.

    Parameters
    ----------
    name : str
    image_of : callable(width, height) -> image
    params : DetectorParams, optional
    sizes : sequence of (width, height)
    repeat : int
    after_size : callable or None
        Called after every size, for a progress bar.

    Raises
    ------
    InputError
        A repeat below 1 or no sizes.

    Examples
    --------
    >>> growth = measure_images("noise", noise_image, sizes=[(64, 48), (96, 64)], repeat=1)
    >>> growth.columns.shape
    (2, 4)
    """
    _check_counts(sizes, repeat)
    settings = params or DetectorParams()
    rows = []
    with one_processor():
        _time_image(image_of(*sizes[0]), settings)  # warm: kernels, caches
        for size in sizes:
            image = image_of(*size)
            runs = np.array([_time_image(image, settings) for _ in range(repeat)])
            rows.append([size[0] * size[1], *runs.min(axis=0)])
            if after_size is not None:
                after_size()
    table = np.array(rows)
    return Growth(name, "pixels", table[:, 0], table[:, 1], table[:, 2], table[:, 3:])


def measure_arcs(
    name: str,
    contours_of: Callable[[int], Contours],
    params: DetectorParams | None = None,
    *,
    counts: Sequence[int] = ARC_COUNTS,
    repeat: int = 3,
    after_size: Callable[[], object] | None = None,
) -> Growth:
    """Time polygons and ECC on a rising number of contours; as `measure_images`.

    Examples
    --------
    >>> measure_arcs("arcs", strewn_arcs, counts=[5, 10], repeat=1).size.tolist()
    [5.0, 10.0]
    """
    _check_counts(counts, repeat)
    settings = params or DetectorParams()
    rows = []
    with one_processor():
        _time_contours(contours_of(counts[0]), settings)
        for count in counts:
            contours = contours_of(count)
            runs = np.array([_time_contours(contours, settings) for _ in range(repeat)])
            found, *seconds = runs.min(axis=0)
            rows.append([count, len(contours.points), found, np.nan, *seconds])
            if after_size is not None:
                after_size()
    table = np.array(rows)
    return Growth(name, "arcs", table[:, 0], table[:, 1], table[:, 2], table[:, 3:])


def tiled_image(image: AnyArray) -> Callable[[int, int], AnyArray]:
    """Return a function (width, height) -> the photograph, cut or mirrored on to that size.

    Examples
    --------
    >>> tiled_image(np.arange(6, dtype=np.uint8).reshape(2, 3))(5, 3).tolist()
    [[0, 1, 2, 2, 1], [3, 4, 5, 5, 4], [3, 4, 5, 5, 4]]
    """

    def of_size(width: int, height: int) -> AnyArray:
        missing = (max(height - image.shape[0], 0), max(width - image.shape[1], 0))
        widths = [(0, missing[0]), (0, missing[1])] + [(0, 0)] * (image.ndim - 2)
        grown = np.pad(image, widths, mode="symmetric")
        return np.ascontiguousarray(grown[:height, :width])

    return of_size


def noise_image(width: int, height: int) -> AnyArray:
    """Return Gaussian noise of 20 grey levels (height, width) uint8, always the same.

    Examples
    --------
    >>> noise_image(30, 20).shape
    (20, 30)
    """
    values = np.random.default_rng([width, height]).normal(128, 20, (height, width))
    return (np.clip(values, 0, 255) + 0.5).astype(np.uint8)


def strewn_arcs(count: int, side: float | None = None) -> Contours:
    """Return quarter to half turns of random ellipses, strewn over a square.

    Parameters
    ----------
    count : int
    side : float or None
        Side of the square in pixels; None: it grows with the number, 40 pixels square an arc.

    Examples
    --------
    >>> len(strewn_arcs(7))
    7
    """
    width = side or max(40.0 * np.sqrt(count), 120.0)
    random = np.random.default_rng([count, int(width)])
    curves, angles, lengths = list[FloatArray](), list[FloatArray](), list[int]()
    for _ in range(count):
        curve, angle = _arc(random, width)
        curves.append(curve)
        angles.append(angle)
        lengths.append(len(curve))
    points = np.concatenate(curves)
    offsets = np.concatenate([[0], np.cumsum(lengths)])
    size = (int(width) + 1, int(width) + 1)
    return Contours(
        points.round(), offsets, np.zeros(count, bool), size, points, np.concatenate(angles)
    )


def _arc(random: np.random.Generator, width: float) -> tuple[FloatArray, FloatArray]:
    """Return the points (n, 2) of an arc, about a pixel apart, and the normals' directions (n,)."""
    b, a = np.sort(random.uniform(10, 50, 2))
    turn, start, extent = random.uniform((0, 0, np.pi / 2), (np.pi, 2 * np.pi, np.pi))
    t = start + np.linspace(0, extent, int(np.ceil(extent * (a + b) / 2)))
    c, s = np.cos(turn), np.sin(turn)
    u, v, nu, nv = a * np.cos(t), b * np.sin(t), b * np.cos(t), a * np.sin(t)
    centre = random.uniform(a + 1, max(width - a - 1, a + 2), 2)
    curve = np.column_stack([c * u - s * v, s * u + c * v]) + centre
    sign = random.choice([-1.0, 1.0])
    angle: FloatArray = np.arctan2(sign * (s * nu + c * nv), sign * (c * nu - s * nv))
    return curve, angle


def growth_markdown(growths: Iterable[Growth]) -> str:
    """Return a Markdown table of the times and of the exponents that fit them."""
    lines = [
        "| input | size | edge pixels | found | edges ms | polygons ms | ecc ms | all ms |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for growth in growths:
        lines += list(_lines(growth))
    return "\n".join(lines) + "\n"


def _lines(growth: Growth) -> Iterator[str]:
    columns = growth.columns
    for k, times in enumerate(columns * 1e3):
        counts = f"{growth.edge_pixels[k]:.0f}", f"{growth.found[k]:.0f}"
        cells = [growth.name, f"{growth.size[k]:.0f} {growth.size_name}", *counts]
        yield _line([*cells, *("" if np.isnan(t) else f"{t:.2f}" for t in times)])
    for what, size in ((growth.size_name, growth.size), ("edge pixels", growth.edge_pixels)):
        exponents = [fitted_exponent(size, columns[:, k]) for k in range(_CHAIN + 1)]
        cells = [growth.name, f"exponent in {what}", "", ""]
        yield _line([*cells, *("" if np.isnan(e) else f"{e:.2f}" for e in exponents)])


def _line(cells: Iterable[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def _time_image(image: AnyArray, params: DetectorParams) -> list[float]:
    """Return the numbers of edge pixels and of ellipses, and the seconds of each stage."""
    start = time.perf_counter()
    contours = extract_contours(image, params.edges)
    edges = time.perf_counter() - start
    found, *seconds = _time_contours(contours, params)
    return [len(contours.points), found, edges, *seconds]


def _time_contours(contours: Contours, params: DetectorParams) -> list[float]:
    """Return the number of ellipses and the seconds of polygons and ECC."""
    clock = [time.perf_counter()]
    polygons = find_polygons(contours, params)
    clock.append(time.perf_counter())
    found = detect_from_contours(contours, polygons, params.ecc)
    clock.append(time.perf_counter())
    return [len(found), *(float(step) for step in np.diff(clock))]


def _check_counts(sizes: Sequence[object], repeat: int) -> None:
    if not sizes or repeat < 1:
        raise InputError("sizes, repeat", "at least one size and one run", f"{sizes}, {repeat}")
