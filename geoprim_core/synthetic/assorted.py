"""Scenes of every kind under one roof: what a score is calibrated by."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from geoprim_core.errors import InputError
from geoprim_core.synthetic.scene import Scene
from geoprim_core.synthetic.shapes import DRAWINGS, MODES, disc_image
from geoprim_core.synthetic.sorting import sorting_sequence
from geoprim_core.synthetic.sorting_lines import SORTING_LINES
from geoprim_core.synthetic.thesis import ALPHAS, thesis_set
from geoprim_core.synthetic.variants import degraded
from geoprim_core.types import Ellipses

# Name -> kind, drawing, noise, blur, contrast of a harder thesis set.
_HARDER = {
    "noisy filled": ("occluded", "filled", 12.0, 0.0, 1.0),
    "noisy outlines": ("overlapping", "outlines", 12.0, 0.0, 1.0),
    "blurred": ("occluded", "filled", 3.0, 1.2, 1.0),
    "faint": ("occluded", "filled", 4.0, 0.0, 0.3),
}


def assorted_scenes(images: int, seed: int) -> Iterator[tuple[str, Scene]]:
    """Yield (set, scene) of all synthetic sets.

    The four thesis sets, noisy, blurred and faint variants with other ellipses, `images` for each
    number of ellipses; six times as many noisy discs; and first frames of every sorting line,
    `images` of each.

    Raises
    ------
    InputError
        A number of images below 1 or a negative seed.

    Examples
    --------
    >>> sets = [name for name, _ in assorted_scenes(1, seed=0)]
    >>> len(sets), len(set(sets)), sets[0]
    (58, 13, 'occluded filled')
    """
    if images < 1 or seed < 0:
        raise InputError("images, seed", "at least 1 and at least 0", f"{images}, {seed}")
    return _assorted(images, seed)


def _assorted(images: int, seed: int) -> Iterator[tuple[str, Scene]]:
    for kind in MODES:
        for drawing in DRAWINGS:
            for _, scene in thesis_set(images, seed, kind=kind, drawing=drawing):
                yield f"{kind} {drawing}", scene
    for shift, (name, values) in enumerate(_HARDER.items(), start=1):
        kind, drawing, noise, blur, contrast = values
        scenes = thesis_set(images, seed + 10000 * shift, kind=kind, drawing=drawing)
        for index, (_, scene) in enumerate(scenes):
            worse = degraded(scene, noise=noise, blur=blur, contrast=contrast, seed=seed + index)
            yield name, worse
    for index in range(len(ALPHAS) * images):
        yield "discs", _noisy_disc(np.random.default_rng([seed, index]))
    for line in SORTING_LINES:
        for index in range(images):
            yield f"sorting {line}", next(iter(sorting_sequence(line, seed=seed + index, frames=1)))


def _noisy_disc(random: np.random.Generator) -> Scene:
    x, y = random.uniform(90.0, 110.0, 2)
    radius = random.uniform(8.0, 80.0)
    bright, dark = random.uniform(130.0, 240.0), random.uniform(10.0, 90.0)
    image = disc_image(200, 200, centre=(x, y), radius=radius, inside=bright, outside=dark)
    truth = Ellipses.from_array([[x, y, radius, radius, 0.0]])
    scene = Scene(image, truth, np.ones(1), ("disc",), np.ones(1, bool))
    return degraded(scene, noise=random.uniform(0.0, 20.0), seed=int(random.integers(1 << 31)))
