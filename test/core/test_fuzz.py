"""Ten thousand random and corrupted small images: an answer that holds, or a refusal with a reason.

The default run takes the first few hundred. All of them:

    GEOPRIM_FUZZ_IMAGES=10000 python -m pytest test/core/test_fuzz.py

With `NUMBA_BOUNDSCHECK=1` and a `GEOPRIM_CACHE_DIR` of its own, kernels check every index too.
Image k depends on k alone, so that a failure names all that is needed to repeat it.
"""

from __future__ import annotations

import math
import os

import numpy as np
import pytest

from geoprim_core.ecc import TABLE, DetectorParams, detect_ellipses
from geoprim_core.errors import ImageError, ParameterError
from geoprim_core.synthetic import ellipse_image
from geoprim_core.types import Ellipse

IMAGES = int(os.environ.get("GEOPRIM_FUZZ_IMAGES", "400"))
PARTS = 8
LARGEST = {np.uint8: 255, np.uint16: 65535, np.float32: 1.0, np.float64: 1.0}


def noise(random, height, width):
    return random.random((height, width))


def constant(random, height, width):
    return np.full((height, width), random.choice([0.0, 0.5, 1.0, random.random()]))


def stripes(random, height, width):
    y, x = np.mgrid[:height, :width]
    period, tilt = random.integers(1, 9), random.choice([0, 1, 2])
    return (x + tilt * y) // period % 2 * 1.0


def checkerboard(random, height, width):
    size = random.integers(1, 9)
    return (np.indices((height, width)) // size).sum(axis=0) % 2 * 1.0


def single_pixels(random, height, width):
    image = np.zeros((height, width))
    count = random.integers(1, 4)
    image[random.integers(0, height, count), random.integers(0, width, count)] = 1.0
    return image if random.random() < 0.5 else 1.0 - image


def gradient(random, height, width):
    y, x = np.mgrid[:height, :width]
    across, down, bend = random.normal(size=3)
    slope = across * x + down * y + bend * np.hypot(x - width / 2, y - height / 2)
    return np.clip(0.5 + slope / (1.0 + np.abs(slope).max()) / 2, 0, 1)


def text_like(random, height, width):
    strokes = np.zeros((height, width))
    for _ in range(random.integers(1, 12)):
        y, x = random.integers(0, height), random.integers(0, width)
        long, thick = random.integers(2, 12), random.integers(1, 3)
        if random.random() < 0.5:
            strokes[y : y + long, x : x + thick] = 1.0
        else:
            strokes[y : y + thick, x : x + long] = 1.0
    return strokes


def discs(random, height, width):
    image = np.full((height, width), random.random())
    for _ in range(random.integers(1, 5)):
        major = random.uniform(1.0, max(1.5, 0.6 * max(height, width)))
        ellipse = Ellipse(
            random.uniform(-5, width + 5), random.uniform(-5, height + 5), major,
            major * random.uniform(0.05, 1.0), random.uniform(0, np.pi * 0.999),
        )  # fmt: skip
        mask = ellipse_image(width, height, ellipse, inside=255, outside=0) / 255.0
        image = image * (1 - mask) + random.random() * mask
    return image


SCENES = (noise, constant, stripes, checkerboard, single_pixels, gradient, text_like, discs, discs)


def salt_and_pepper(random, image):
    hit = random.random(image.shape) < random.uniform(0.01, 0.4)
    return np.where(hit, random.integers(0, 2, image.shape), image)


def cut_rows(random, image):
    image = image.copy()
    first = random.integers(0, len(image))
    image[first : first + random.integers(1, 9)] = random.random()
    image[random.integers(0, len(image)) :] = image[0] if random.random() < 0.5 else 0.0
    return image


def saturated(random, image):
    return np.clip(image * random.uniform(1, 6) - random.uniform(0, 1), 0, 1)


def faint(random, image):
    return 0.5 + (image - 0.5) * 10.0 ** -random.uniform(1, 9)


def noisy(random, image):
    return np.clip(image + random.normal(0, random.uniform(0.001, 0.3), image.shape), 0, 1)


DAMAGES = (salt_and_pepper, cut_rows, saturated, faint, noisy)


def drawn_image(random):
    """Return an image and whether it has to be refused."""
    height, width = random.integers(1, 65, 2) if random.random() < 0.5 else (64, 64)
    scene = SCENES[random.integers(len(SCENES))]
    count = random.choice([1, 1, 1, 3, 4])
    layers = [scene(random, height, width) for _ in range(count)]
    image = layers[0] if count == 1 else np.stack(layers, axis=2)
    damaged = random.random() < 0.6
    for damage in DAMAGES:
        if damaged and random.random() < 0.4:
            image = damage(random, image)
    kind = list(LARGEST)[random.choice(4, p=[0.6, 0.15, 0.15, 0.1])]
    image = (image * LARGEST[kind]).astype(kind)
    if kind in (np.float32, np.float64):
        scale = kind(random.choice([1.0, 255.0, 1e-30, 0.9 * float(np.finfo(kind).max), -7.0]))
        image = image * scale
        if random.random() < 0.15:
            spot = tuple(random.integers(0, n) for n in image.shape)
            image[spot] = random.choice([np.nan, np.inf, -np.inf])
            return image, True
    return spoiled(random, image)


def spoiled(random, image):
    """Return the image, at times as something that is none, and whether that is to be refused."""
    way = random.integers(0, 60)
    if way == 0:
        return image[:0], True
    if way == 1:
        return np.zeros(image.shape, np.int32), True
    if way == 2:
        return np.stack([image] * 5, axis=-1), True
    if way == 3:
        return image[::-1, ::-1], False  # not contiguous
    if way == 4:
        return np.asfortranarray(image), False
    return image, False


# Settings that let almost everything through, so that wrong ellipses come up.
LENIENT = {
    "min_arc": 5, "min_sagitta": 0.0, "max_arc_rms": 3.0, "max_pair_rms": 5.0,
    "min_pair_share": 0.01, "region_slack": 20.0, "max_tries": 1000, "reach": 5.0,
    "max_normal_angle": 35.0, "min_coverage": 0.05, "min_in_frame": 0.05, "max_size": 10.0,
    "min_semi_minor": 0.5, "min_unclaimed": 0.0, "max_overlap": 1.0, "min_score": 0.0,
}  # fmt: skip

BOUNDED = {"ecc.grouping.sets": 60.0, "edges.sigma": 3.0, "ecc.tangent.reach": 30.0}


def drawn_params(random):
    """Return the settings of a scheme with some values drawn from their whole ranges."""
    params = DetectorParams.for_scheme(str(random.choice(TABLE.names)))
    if params.ecc.scheme == "refined" and random.random() < 0.5:
        params = params.updated({f"ecc.refined.{name}": v for name, v in LENIENT.items()})
    options = [o for o in DetectorParams.options() if o.name != "ecc.scheme"]
    for _ in range(random.choice([0, 0, 1, 2, 5, 12])):
        option = options[random.integers(len(options))]
        try:
            params = params.updated({option.name: drawn_value(random, option)})
        except ParameterError:  # a high threshold below the low one
            assert "edges." in option.name
    return params


def drawn_value(random, option):
    if option.choices:
        return str(random.choice(option.choices))
    if option.kind is bool:
        return bool(random.random() < 0.5)
    low = option.low if option.low is not None else 0.0
    high = option.high if option.high is not None else low + 1000.0
    high = min(high, BOUNDED.get(option.name, high))
    ends = [low, high, option.default]
    value = random.choice([*ends, random.uniform(low, high), random.uniform(low, ends[2] * 2 + 1)])
    return option.kind(min(max(value, low), high))


def check(found, image, params):
    """Assert all that is promised of detections, whatever the image."""
    height, width = image.shape[:2]
    assert found.image_size == (width, height)
    rows = found.ellipses.array()
    assert np.isfinite(rows).all()
    assert (rows[:, 2] >= rows[:, 3]).all()
    assert (rows[:, 3] > 0).all()
    assert ((rows[:, 4] >= 0) & (rows[:, 4] < np.pi)).all()
    for name in ("score", "coverage", "alignment", "continuity"):
        values = getattr(found, name)
        assert ((values >= 0) & (values <= 1)).all(), name
    assert (np.diff(found.score) <= 0).all(), "best first"
    assert found.complete == (not found.reason)
    if params.ecc.scheme == "refined":
        settings = params.ecc.refined
        assert (rows[:, 2] <= settings.max_size * math.hypot(width, height)).all()
        assert (rows[:, 3] >= settings.min_semi_minor).all()
        assert (found.score >= settings.min_score - 1e-12).all()
    for matrix in found.covariance:
        unknown = np.isnan(matrix)
        assert unknown.all() or not unknown.any()
        if not unknown.any():
            assert np.array_equal(matrix, matrix.T)
            scale = np.sqrt(np.diag(matrix))
            values = np.linalg.eigvalsh(matrix / np.outer(scale, scale))
            assert values.min() > -1e-9


def run(k):
    random = np.random.default_rng([20120229, k])
    image, refused = drawn_image(random)
    params = drawn_params(random)
    before = image.tobytes()
    if refused:
        with pytest.raises(ImageError, match=r"^image: expected .*, got "):
            detect_ellipses(image, params)
        return
    check(detect_ellipses(image, params), image, params)
    assert image.tobytes() == before, "the image is not written to"


@pytest.mark.parametrize("part", range(PARTS))
def test_every_image_is_answered_or_refused(part):
    for k in range(part, IMAGES, PARTS):
        try:
            run(k)
        except Exception as problem:
            problem.add_note(f"image {k}")
            raise


@pytest.mark.parametrize("k", [34867])
def test_images_that_once_broke_a_promise(k):
    """34867: the last refit undercut `min_semi_minor`."""
    run(k)
