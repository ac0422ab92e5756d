"""Harder versions of a scene: noisy, blurred, faint, turned."""

from __future__ import annotations

import numpy as np

from geoprim_core._check import AnyArray, FloatArray
from geoprim_core.errors import InputError
from geoprim_core.synthetic.scene import Scene
from geoprim_core.types import Ellipses

_REACH_IN_SIGMAS = 4.0


def degraded(
    scene: Scene, *, noise: float = 0.0, blur: float = 0.0, contrast: float = 1.0, seed: int = 0
) -> Scene:
    """Blur a scene, lower its contrast and add noise, in this order.

    Parameters
    ----------
    scene : Scene
    noise : float
        Standard deviation of the Gaussian noise in grey levels.
    blur : float
        Standard deviation of the Gaussian blur in pixels; beyond the border the image goes on
        with its last pixels.
    contrast : float
        Factor in (0, 1] on the differences from the mean grey level.
    seed : int, at least 0
        Seed of the noise.

    Returns
    -------
    Scene
        With the same truth.

    Raises
    ------
    InputError
        A value is negative, or the contrast is not in (0, 1].

    Examples
    --------
    >>> from geoprim_core.synthetic import thesis_image
    >>> faint = degraded(thesis_image(4, seed=1), contrast=0.2)
    >>> int(np.ptp(faint.image)) < 60
    True
    """
    if min(noise, blur, seed) < 0 or not 0 < contrast <= 1:
        got = f"noise {noise}, blur {blur}, contrast {contrast}, seed {seed}"
        raise InputError("noise, blur, contrast, seed", "none below 0, contrast in (0, 1]", got)
    values = scene.image.astype(np.float64)
    if blur > 0:
        values = _blurred(_blurred(values, blur, 0), blur, 1)
    values = values.mean() + contrast * (values - values.mean())
    if noise > 0:
        values += np.random.default_rng(seed).normal(0.0, noise, values.shape)
    image = (np.clip(values, 0, 255) + 0.5).astype(np.uint8)
    return _with(scene, image, scene.ellipses, scene.visible)


def rotated(scene: Scene, quarter_turns: int = 1) -> Scene:
    """Turn a scene by quarter turns from +x towards +y, without any resampling.

    Examples
    --------
    >>> from geoprim_core.synthetic import thesis_image
    >>> scene = thesis_image(4, seed=1)
    >>> bool((rotated(scene, 4).image == scene.image).all())
    True
    """
    turns = quarter_turns % 4
    image, rows = scene.image, scene.ellipses.array()
    for _ in range(turns):
        x, y = rows[:, 0].copy(), rows[:, 1].copy()
        rows[:, 0], rows[:, 1] = image.shape[0] - 1 - y, x
        rows[:, 4] = (rows[:, 4] + np.pi / 2) % np.pi
        image = np.rot90(image, -1)
    turned = Ellipses.from_array(rows)
    return _with(scene, np.ascontiguousarray(image), turned, scene.visible)


def _blurred(values: FloatArray, sigma: float, axis: int) -> FloatArray:
    reach = int(np.ceil(_REACH_IN_SIGMAS * sigma))
    offsets = np.arange(-reach, reach + 1)
    weights = np.exp(-0.5 * (offsets / sigma) ** 2)
    weights /= weights.sum()
    edges = [(0, 0)] * values.ndim
    edges[axis] = (reach, reach)
    padded = np.moveaxis(np.pad(values, edges, mode="edge"), axis, 0)
    count = values.shape[axis]
    result = np.zeros_like(np.moveaxis(values, axis, 0))
    for start, weight in enumerate(weights):
        result += weight * padded[start : start + count]
    return np.moveaxis(result, 0, axis)


def _with(scene: Scene, image: AnyArray, ellipses: Ellipses, visible: FloatArray) -> Scene:
    return Scene(image, ellipses, visible, scene.labels, scene.required, scene.camera)
