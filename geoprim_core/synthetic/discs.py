"""Calibration targets in perspective on a photograph: discs, rings, and plates of dots.

A circle on a tilted plane is seen as an ellipse; it is computed from the projected conic, so the
truth is exact, and painted with the anti-aliased border of `shapes`.
"""

from __future__ import annotations

import numpy as np

from geoprim_core import _check
from geoprim_core._check import AnyArray, FloatArray
from geoprim_core.errors import InputError
from geoprim_core.fitting.conic import ellipse_from_conic
from geoprim_core.synthetic import _kernels
from geoprim_core.synthetic.scene import Scene
from geoprim_core.synthetic.shapes import _choice
from geoprim_core.synthetic.variants import degraded
from geoprim_core.types import Ellipses

TARGETS = ("discs", "rings", "dots")

_SMALLEST, _LARGEST = 10.0, 100.0
_GAP = 8.0
_TRIALS = 300
_FOCAL = 1.2  # focal length in image diagonals: a field of view of 45 degrees
_MAX_TILT = np.deg2rad(50)
_RING_RATIOS = ((0.6,), (0.7, 0.35))


def disc_scene(
    background: AnyArray,
    seed: int,
    *,
    target: str = "discs",
    noise: float = 0.0,
    blur: float = 0.0,
    shading: float = 0.0,
) -> Scene:
    """Put calibration targets of 20 to 200 pixels on a photograph.

    Parameters
    ----------
    background : (H, W) or (H, W, 3) uint8, at least 120 pixels wide and high
    seed : int
    target : "discs", "rings" or "dots"
        Discs of one tone, each with its own tilt; the same with one or two circles of the other
        tone around the same centre inside; one bright plate with a grid of dark dots.
    noise : float
        Standard deviation of the Gaussian noise in grey levels.
    blur : float
        Standard deviation of the Gaussian blur in pixels.
    shading : float
        The light falls by this share, in [0, 1), from one side of the image to the other.

    Returns
    -------
    Scene
        Its ellipses are the targets' edges; what is round in the photograph is not listed.

    Raises
    ------
    InputError
        The background is no such image, an unknown target, or a value is out of range.

    References
    ----------
    R. Hartley and A. Zisserman, Multiple View Geometry, 2003, result 2.13 (transformed conics).

    Examples
    --------
    >>> scene = disc_scene(np.full((240, 320), 90, np.uint8), seed=1)
    >>> row = scene.ellipses[0]
    >>> abs(int(scene.image[round(row.y), round(row.x)]) - 90) > 60
    True
    """
    values = _checked(background, seed, shading)
    _choice(target, TARGETS, "target")
    random = np.random.default_rng([seed, TARGETS.index(target), *values.shape[:2]])
    if target == "dots":
        rows = _paint_dots(random, values)
    else:
        rows = _paint_discs(random, values, with_rings=target == "rings")
    values *= _light(random, values.shape, shading)
    image = (np.clip(values, 0, 255) + 0.5).astype(np.uint8)
    labels, flags = (target,) * len(rows), np.ones(len(rows), bool)
    scene = Scene(image, Ellipses.from_array(rows), np.ones(len(rows)), labels, flags)
    return degraded(scene, noise=noise, blur=blur, seed=seed)


def _checked(background: AnyArray, seed: int, shading: float) -> FloatArray:
    image = _check.image(background, "background")
    if image.dtype != np.uint8 or image.shape[2:] == (4,) or min(image.shape[:2]) < 120:
        expected = "uint8, gray or three colours, at least 120 pixels wide and high"
        raise InputError("background", expected, _check.describe(background))
    if seed < 0 or not 0 <= shading < 1:
        got = f"{seed}, {shading}"
        raise InputError("seed, shading", "a seed of at least 0, shading in [0, 1)", got)
    return image.astype(np.float64)


def project_circle(plane: FloatArray, x: float, y: float, radius: float) -> FloatArray:
    """Return the ellipse (5,) as which a circle of a plane is seen.

    Parameters
    ----------
    plane : (3, 3)
        Homography from the plane to the image; the circle is wholly in front of the camera.
    x, y, radius : float
        Of the circle, in the units of the plane.

    Examples
    --------
    >>> project_circle(np.diag([2.0, 1.0, 1.0]), 3.0, 4.0, 1.0).round(9).tolist()
    [6.0, 4.0, 2.0, 1.0, 0.0]
    """
    circle = np.array([[1, 0, -x], [0, 1, -y], [-x, -y, x * x + y * y - radius**2]])
    inverse = np.linalg.inv(plane)
    seen = inverse.T @ circle @ inverse
    a, b, c = seen[0, 0], 2 * seen[0, 1], seen[1, 1]
    fit = ellipse_from_conic([a, b, c, 2 * seen[0, 2], 2 * seen[1, 2], seen[2, 2]])
    if fit.ellipse is None:
        raise InputError("plane", "a homography that shows the circle as an ellipse", fit.reason)
    e = fit.ellipse
    return np.array([e.x, e.y, e.semi_major, e.semi_minor, e.angle])


def _tilted_plane(
    random: np.random.Generator, shape: tuple[int, ...], x: float, y: float
) -> FloatArray:
    """Draw the homography of a tilted plane: its origin is seen at (x, y), lengths there as is."""
    height, width = shape[:2]
    focal = _FOCAL * np.hypot(width, height)
    tilt, turn, spin = random.uniform(0, _MAX_TILT), *random.uniform(0, 2 * np.pi, 2)
    rotation = _turn_z(turn) @ _turn_x(tilt) @ _turn_z(spin)
    u, v = x - (width - 1) / 2, y - (height - 1) / 2
    camera = np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1.0]])
    origin = np.array([u, v, focal])  # at the distance of the focal length: scale 1
    plane: FloatArray = camera @ np.column_stack([rotation[:, 0], rotation[:, 1], origin])
    return plane


def _turn_z(angle: float) -> FloatArray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])


def _turn_x(angle: float) -> FloatArray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0, 0], [0, c, -s], [0, s, c]])


def _paint_discs(
    random: np.random.Generator, values: FloatArray, *, with_rings: bool
) -> FloatArray:
    """Paint discs that keep apart from one another; return all their edges."""
    height, width = values.shape[:2]
    wanted = int(random.integers(3, 7) if with_rings else random.integers(4, 10))
    outer, edges = np.zeros((0, 5)), list[FloatArray]()
    for _ in range(_TRIALS):
        if len(outer) == wanted:
            break
        least = 1.8 * _SMALLEST if with_rings else _SMALLEST
        most = min(_LARGEST, 0.3 * min(width, height))
        radius = np.exp(random.uniform(np.log(least), np.log(most)))
        x, y = random.uniform(0, width - 1), random.uniform(0, height - 1)
        plane = _tilted_plane(random, values.shape, x, y)
        row = project_circle(plane, 0, 0, radius)
        if not _has_room(row, outer, width, height):
            continue
        outer = np.vstack([outer, row])
        ratios = _RING_RATIOS[int(random.integers(len(_RING_RATIOS)))] if with_rings else ()
        inner = [project_circle(plane, 0, 0, ratio * radius) for ratio in ratios]
        _paint_rings(random, values, [row, *inner])
        edges += [row, *inner]
    return np.array(edges).reshape(-1, 5)


def _has_room(row: FloatArray, others: FloatArray, width: int, height: int) -> bool:
    x, y, reach = row[0], row[1], row[2] + _GAP
    if min(x, y, width - 1 - x, height - 1 - y) < reach:
        return False
    apart = np.hypot(others[:, 0] - x, others[:, 1] - y)
    return bool((apart >= others[:, 2] + reach).all())


def _paint_rings(random: np.random.Generator, values: FloatArray, rows: list[FloatArray]) -> None:
    """Paint circles into one another, the outermost in the tone that stands out more."""
    dark, bright = random.uniform(10, 50), random.uniform(205, 245)
    cover = _cover(rows[0], values.shape)
    around = float(np.average(values.reshape(*cover.shape, -1).mean(axis=2), weights=cover))
    tones = (dark, bright) if around > 128 else (bright, dark)
    for k, row in enumerate(rows):
        _blend(values, _cover(row, values.shape), tones[k % 2])


def _paint_dots(random: np.random.Generator, values: FloatArray) -> FloatArray:
    """Paint one plate with a grid of dots; return the dots' edges."""
    height, width = values.shape[:2]
    most = min(_LARGEST, 0.1 * min(width, height))
    radius = float(np.exp(random.uniform(np.log(min(_SMALLEST, most)), np.log(most))))
    step = radius * random.uniform(2.6, 4.0)
    plane = _tilted_plane(random, values.shape, (width - 1) / 2, (height - 1) / 2)
    room = 0.62 * min(width, height) / step  # also a tilted and turned plate stays in the frame
    columns, lines = (int(random.integers(2, max(int(room), 2) + 1)) for _ in range(2))
    half = 0.5 * step * np.array([columns, lines])
    _blend(values, _plate_cover(plane, half, values.shape), random.uniform(205, 245))
    dark, rows = random.uniform(10, 50), []
    for i in range(columns):
        for j in range(lines):
            x, y = (i + 0.5) * step - half[0], (j + 0.5) * step - half[1]
            rows.append(project_circle(plane, x, y, radius))
            _blend(values, _cover(rows[-1], values.shape), dark)
    return np.array(rows)


def _plate_cover(plane: FloatArray, half: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    """Return the cover (H, W) of the rectangle -half .. half of a plane."""
    corners = (
        plane
        @ np.array(
            [[sx * half[0], sy * half[1], 1.0] for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        ).T
    )
    seen = (corners[:2] / corners[2]).T
    y, x = np.mgrid[: shape[0], : shape[1]].astype(np.float64)
    cover = np.ones(shape[:2])
    middle = seen.mean(axis=0)
    for start, end in zip(seen, np.roll(seen, -1, axis=0), strict=True):
        normal = np.array([start[1] - end[1], end[0] - start[0]]) / np.hypot(*(end - start))
        normal *= np.sign(normal @ (middle - start))  # inwards
        inside = (x - start[0]) * normal[0] + (y - start[1]) * normal[1]
        cover = np.minimum(cover, np.clip(inside + 0.5, 0, 1))
    return cover


def _cover(row: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    distance = np.empty(shape[:2])
    _kernels.distance_map(shape[1], shape[0], row, -0.5, 0.5, distance)
    cover: FloatArray = 0.5 - distance
    return cover


def _blend(values: FloatArray, cover: FloatArray, tone: float) -> None:
    share = cover if values.ndim == 2 else cover[:, :, None]
    values += share * (tone - values)


def _light(random: np.random.Generator, shape: tuple[int, ...], shading: float) -> FloatArray:
    """Return the light (H, W) or (H, W, 1), falling in a random direction from 1."""
    angle = random.uniform(0, 2 * np.pi)
    y, x = np.mgrid[: shape[0], : shape[1]]
    along = x * np.cos(angle) + y * np.sin(angle)
    light: FloatArray = 1 - shading * (along - along.min()) / np.ptp(along)
    return light if len(shape) == 2 else light[:, :, None]
