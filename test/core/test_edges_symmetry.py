"""Laws: a turned or mirrored image has the turned or mirrored contours, to the last pixel."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from skimage import data

from geoprim_core.edges import extract_contours
from geoprim_core.synthetic import degraded, thesis_image

STEPS = 256  # of a position in a pixel
CHANGES = {
    "quarter turn": (lambda image: np.rot90(image), lambda x, y, w, h: (y, w - 1 - x)),
    "mirror": (lambda image: image[:, ::-1], lambda x, y, w, h: (w - 1 - x, y)),
    "transpose": (lambda image: np.swapaxes(image, 0, 1), lambda x, y, w, h: (y, x)),
}
SCENES = st.tuples(
    st.sampled_from(["occluded", "overlapping"]),
    st.sampled_from(["filled", "outlines"]),
    st.sampled_from([0.0, 2.0, 12.0]),
    st.integers(0, 9999),
)


def curves(contours, place):
    """Return how often each contour occurs, its points moved by `place`.

    Contours run with the bright side on the right, so a mirror turns them round; a closed one may
    begin anywhere.
    """
    found = Counter()
    for part, closed in zip(parts(contours), contours.closed, strict=True):
        x, y = place(*contours.positions[part].T)
        px, py = place(*contours.points[part].T)
        rows = np.stack([px, py, x * STEPS, y * STEPS], axis=1)
        np.testing.assert_array_equal(rows, np.rint(rows))
        found[min(walks(rows, closed))] += 1
    return found


def walks(rows, closed):
    for way in (rows, rows[::-1]):
        start = np.lexsort(way.T[::-1])[0] if closed else 0
        yield tuple(map(tuple, np.roll(way, -start, axis=0).tolist()))


def parts(contours):
    return [slice(a, b) for a, b in zip(contours.offsets[:-1], contours.offsets[1:], strict=True)]


def check_the_law(image, change):
    turn, move = CHANGES[change]
    height, width = image.shape[:2]
    here = curves(extract_contours(image), lambda x, y: move(x, y, width, height))
    there = curves(extract_contours(np.ascontiguousarray(turn(image))), lambda x, y: (x, y))
    assert len(here - there) == len(there - here) == 0


@pytest.mark.parametrize("change", CHANGES)
@settings(max_examples=12, deadline=None)
@given(SCENES)
def test_contours_of_scenes_turn_with_the_image(change, scene):
    kind, drawing, noise, seed = scene
    picture = thesis_image(8, seed=seed, kind=kind, drawing=drawing)
    check_the_law(degraded(picture, noise=noise, seed=seed).image, change)


@pytest.mark.parametrize("change", CHANGES)
@settings(max_examples=60, deadline=None)
@given(arrays(np.uint8, st.tuples(st.integers(1, 24), st.integers(1, 24))))
def test_contours_of_any_image_turn_with_it(change, image):
    check_the_law(image, change)


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("name", ["coins", "coffee", "camera"])
def test_contours_of_photographs_turn_with_them(change, name):
    check_the_law(getattr(data, name)(), change)
