"""Rendered sorting lines: objects on a moving belt under a camera, with exact ground truth."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core.errors import InputError
from geoprim_core.synthetic import _kernels_sorting as kernels
from geoprim_core.synthetic.scene import Scene
from geoprim_core.synthetic.shapes import _choice, _frame
from geoprim_core.synthetic.sorting_lines import SORTING_LINES, SortingLine, SortingObject
from geoprim_core.types import Ellipses

_ROW = 13
_TILE_SIZE = 512
_OUTLINE_SAMPLES = 360
_SOFTNESS = 0.12
_LEAST_REQUIRED, _LEAST_IN_FRAME, _LEAST_TOLD = 0.4, 0.5, 0.02
_INNER_RINGS = {kernels.LID: (0.86, 0.80), kernels.COIN: (0.90, 0.86)}


@dataclass(frozen=True, slots=True, eq=False)
class _Load:
    """What lies on the belt: rows for the kernels in painter's order, and the elliptic edges."""

    rows: FloatArray
    rings: FloatArray
    owners: IntArray
    labels: tuple[str, ...]
    outline: FloatArray


def sorting_sequence(
    name: str, *, seed: int, frames: int = 60, size: tuple[int, int] = (640, 480)
) -> Iterator[Scene]:
    """Render a sorting line frame by frame.

    Everything moves to the right with the belt by `SORTING_LINES[name].speed` pixels a frame;
    light and camera stand still. The same arguments give the same bytes.

    Parameters
    ----------
    name : "cans", "coins", "produce" or "ores"
    seed : int, at least 0
    frames : int
        Number of frames.
    size : (width, height) in pixels

    Yields
    ------
    Scene
        A colour image (H, W, 3) in the order blue, green, red. Labels are those of
        `SORTING_LINES[name].objects`; further elliptic edges of an object, which are real but
        not its outline, carry its label with " ring", " stem" or " base" and are never required.
        Required is an outline of which at least half is in the frame and 40 % is visible.

    Raises
    ------
    InputError
        An unknown name, a negative seed, no frames or a size without pixels.

    Examples
    --------
    >>> scene = next(sorting_sequence("coins", seed=1, frames=1, size=(160, 120)))
    >>> scene.image.shape, scene.camera.distance
    ((120, 160, 3), 0.25)
    """
    _choice(name, tuple(SORTING_LINES), "name")
    if seed < 0:
        raise InputError("seed", "a whole number of at least 0", f"{seed}")
    if frames < 1:
        raise InputError("frames", "at least one frame", f"{frames}")
    return _frames(SORTING_LINES[name], seed, frames, _frame(size))


def _frames(line: SortingLine, seed: int, frames: int, size: tuple[int, int]) -> Iterator[Scene]:
    load = _loaded_belt(line, seed, frames, size)
    for index in range(frames):
        shift = line.speed * index
        noise_seed = int(np.random.default_rng([seed, index]).integers(1, 2**40))
        yield _scene(line, _in_view(load, shift, size), shift, noise_seed, size)


def _scene(
    line: SortingLine, load: _Load, shift: float, noise_seed: int, size: tuple[int, int]
) -> Scene:
    image = _render(line, load.rows, shift, size)
    exposed = kernels.expose(image, _SOFTNESS, np.array(line.light), line.noise, noise_seed)
    shares = kernels.seen_shares(load.rings, load.owners, load.rows, *size, _OUTLINE_SAMPLES)
    in_frame, visible = shares[:, 0], shares[:, 1]
    told = np.flatnonzero(visible >= _LEAST_TOLD)
    required = (visible >= _LEAST_REQUIRED) & (in_frame >= _LEAST_IN_FRAME) & (load.outline > 0)
    return Scene(
        exposed,
        Ellipses.from_array(load.rings[told, :5]),
        visible[told],
        tuple(load.labels[k] for k in told),
        required[told],
        line.camera(size),
    )


def _render(line: SortingLine, rows: FloatArray, shift: float, size: tuple[int, int]) -> FloatArray:
    image = np.empty((size[1], size[0], 3))
    tile = _tile()
    seam = line.seam * line.scale
    kernels.paint_belt(image, tile, np.array(line.belt), line.grain, seam, shift)
    for row in rows:
        kernels.paint_shadow(image, row, line.shadow * line.scale, 0.55)
        kernels.paint_object(image, row, tile)
    kernels.soften_rows(image, _SOFTNESS)
    return image


def _in_view(load: _Load, shift: float, size: tuple[int, int]) -> _Load:
    """Return what the camera sees, or nearly sees, when the belt has moved by `shift`."""
    rows, rings = load.rows.copy(), load.rings.copy()
    rows[:, 0] += shift
    rings[:, 0] += shift
    reach = 2.0 * (rows[:, 2] + np.abs(rows[:, 5]))
    near = (rows[:, 0] > -reach) & (rows[:, 0] < size[0] + reach)
    kept = np.flatnonzero(near[load.owners])
    owners = (np.cumsum(near) - 1)[load.owners[kept]]
    labels = tuple(load.labels[k] for k in kept)
    return _Load(rows[near], rings[kept], owners, labels, load.outline[kept])


def _loaded_belt(line: SortingLine, seed: int, frames: int, size: tuple[int, int]) -> _Load:
    """Strew objects over the belt that will pass; far ones are painted first."""
    random = np.random.default_rng([seed, len(line.name), frames, *size])
    largest = max(kind.diameter[1] for kind in line.objects) * line.scale
    left = -line.speed * (frames - 1) - largest
    room = (left, size[0] + largest, 0.0, float(size[1]))
    rows, kinds = _strewn(random, line, room)
    order = np.argsort(rows[:, 1], kind="stable") if len(rows) else np.zeros(0, int)
    return _with_rings(rows[order], [kinds[k] for k in order])


def _strewn(
    random: np.random.Generator, line: SortingLine, room: tuple[float, float, float, float]
) -> tuple[FloatArray, list[SortingObject]]:
    """Throw objects until the belt is filled or too crowded."""
    left, right, top, bottom = room
    wanted = line.fill * (right - left) * (bottom - top)
    rows, kinds, covered = np.zeros((0, _ROW)), list[SortingObject](), 0.0
    for _ in range(4000):
        if covered >= wanted:
            break
        kind = line.objects[int(random.integers(len(line.objects)))]
        row = _thrown(random, kind, line.scale)
        row[:2] = random.uniform(left, right), random.uniform(top, bottom)
        radii = np.sqrt(rows[:, 2] * rows[:, 3]) + np.sqrt(row[2] * row[3])
        gaps = np.hypot(rows[:, 0] - row[0], rows[:, 1] - row[1])
        if (gaps >= line.spacing * radii).all():
            rows, kinds = np.vstack([rows, row]), [*kinds, kind]
            covered += np.pi * row[2] * row[3]
    return rows, kinds


def _thrown(random: np.random.Generator, kind: SortingObject, scale: float) -> FloatArray:
    """Draw the looks of one object; its place is still missing."""
    row = np.zeros(_ROW)
    ratio = random.uniform(*kind.ratio)
    row[2] = 0.5 * scale * random.uniform(*kind.diameter)
    row[3] = ratio * row[2]
    # cans are seen from one side, everything else lies as it fell; round things have no direction
    lean = random.uniform(-0.4, 0.4) if kind.body else random.uniform(0, np.pi)
    row[4] = lean % np.pi if ratio < 1 else 0.0
    down = 1.0 if lean >= 0 else -1.0
    row[5] = down * scale * kind.body * np.sqrt(1 - ratio**2) if kind.body else 0.0
    tint = random.uniform(0.88, 1.06) * (1 + random.uniform(-0.04, 0.04, 3))
    row[6:9] = np.clip(np.array(kind.colour) * tint, 0, 1)
    row[9] = kind.shape
    row[10:12] = random.uniform(0, _TILE_SIZE, 2)
    row[12] = kind.gloss
    return row


def _with_rings(rows: FloatArray, kinds: list[SortingObject]) -> _Load:
    """List every elliptic edge: outlines, rings within them and the bases of bodies."""
    rings, owners, labels, outline = list[FloatArray](), list[int](), list[str](), list[float]()
    for k, (row, kind) in enumerate(zip(rows, kinds, strict=True)):
        for label, share, u, v, side in _edges(row, kind):
            ring = np.append(row[:5], side)
            c, s = np.cos(row[4]), np.sin(row[4])
            ring[:2] += u * c - v * s, u * s + v * c
            ring[2:4] = share * row[2], share * row[3 if label != f"{kind.label} stem" else 2]
            rings.append(ring)
            owners.append(k)
            labels.append(label)
            outline.append(float(label == kind.label))
    table = np.array(rings).reshape(-1, 6)
    return _Load(rows, table, np.array(owners, np.int64), tuple(labels), np.array(outline))


def _edges(
    row: FloatArray, kind: SortingObject
) -> Iterator[tuple[str, float, float, float, float]]:
    """Yield label, relative size, offset along both axes and visible side of every edge."""
    yield kind.label, 1.0, 0.0, 0.0, 0.0
    for share in _INNER_RINGS.get(kind.shape, ()):
        yield f"{kind.label} ring", share, 0.0, 0.0, 0.0
    if kind.shape == kernels.FRUIT:  # a round dot, as the kernel paints it
        yield f"{kind.label} stem", 0.09, 0.15 * row[2], -0.10 * row[3], 0.0
    if row[5] != 0:
        yield f"{kind.label} base", 1.0, 0.0, row[5], float(np.sign(row[5]))


@cache
def _tile() -> FloatArray:
    """Return a periodic texture of mean 0 and standard deviation 1: noise of several scales."""
    random = np.random.default_rng(20121115)
    frequency = np.hypot(np.fft.fftfreq(_TILE_SIZE)[:, None], np.fft.rfftfreq(_TILE_SIZE)[None, :])
    weight = 1.0 / (0.02 + frequency) ** 1.1
    weight[0, 0] = 0.0
    spectrum = np.fft.rfft2(random.standard_normal((_TILE_SIZE, _TILE_SIZE))) * weight
    # rounded, so that the last bits of another Fourier transform do not reach a picture
    tile = np.fft.irfft2(spectrum, s=(_TILE_SIZE, _TILE_SIZE))
    return np.ascontiguousarray(np.round(tile / tile.std(), 6))
