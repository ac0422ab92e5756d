"""The rendered sorting lines move as stated, and their truth lies on the edges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from geoprim_core.errors import InputError
from geoprim_core.fitting.shape import point_at
from geoprim_core.synthetic import SORTING_LINES, sorting_sequence, visible_shares
from geoprim_core.types import Ellipses

SIZE = (320, 240)
NAMES = tuple(SORTING_LINES)


def first_frames(name, count, seed=5, frames=60, size=SIZE):
    scenes = sorting_sequence(name, seed=seed, frames=frames, size=size)
    return [next(scenes) for _ in range(count)]


@pytest.mark.parametrize("name", NAMES)
def test_the_same_seed_gives_the_same_bytes(name):
    for first, again in zip(first_frames(name, 2), first_frames(name, 2), strict=True):
        assert first.image.tobytes() == again.image.tobytes()
        assert first.ellipses.array().tobytes() == again.ellipses.array().tobytes()
        assert first.labels == again.labels
    other = first_frames(name, 1, seed=6)[0]
    assert other.image.tobytes() != first_frames(name, 1)[0].image.tobytes()


@pytest.mark.parametrize("name", NAMES)
def test_everything_moves_with_the_belt(name):
    before, after = first_frames(name, 2)
    speed = SORTING_LINES[name].speed
    moved = before.ellipses.array() + np.array([speed, 0, 0, 0, 0])
    now = after.ellipses.array()
    distances = np.abs(moved[:, None, :] - now[None, :, :]).max(axis=2)
    kept = distances.min(axis=1) < 1e-9
    assert kept[before.required & (before.ellipses.x < SIZE[0] - 60)].all()
    for k in np.flatnonzero(kept):
        assert before.labels[k] == after.labels[distances[k].argmin()]


@pytest.mark.parametrize("name", NAMES)
def test_objects_enter_and_leave_during_a_sequence(name):
    scenes = list(sorting_sequence(name, seed=2, frames=40, size=(200, 120)))
    speed = SORTING_LINES[name].speed

    def on_belt(index):
        e = scenes[index].ellipses
        return {(round(x - speed * index, 6), round(y, 6)) for x, y in zip(e.x, e.y, strict=True)}

    assert on_belt(0) - on_belt(39)
    assert on_belt(39) - on_belt(0)


@pytest.mark.parametrize("name", NAMES)
def test_the_size_in_millimetres_tells_the_label(name):
    line = SORTING_LINES[name]
    kinds = {kind.label: kind for kind in line.objects}
    scene = first_frames(name, 1)[0]
    pixels_a_mm = scene.camera.fx / (1000 * scene.camera.distance)
    outlines = [k for k, label in enumerate(scene.labels) if label in kinds]
    assert len({scene.labels[k] for k in outlines}) >= 2
    for k in outlines:
        low, high = kinds[scene.labels[k]].diameter
        diameter = 2 * scene.ellipses.semi_major[k] / pixels_a_mm
        assert low - 1e-9 <= diameter <= high + 1e-9
    assert not scene.required[[k for k in range(len(scene.labels)) if k not in outlines]].any()


@pytest.mark.parametrize("name", ["coins", "produce", "ores"])
def test_the_visible_share_of_flat_objects_is_that_of_painted_ellipses(name):
    scene = first_frames(name, 1, size=(640, 480))[0]
    outlines = [k for k, label in enumerate(scene.labels) if " " not in label]
    shares = visible_shares(scene.ellipses.select(outlines), scene.image_size)
    np.testing.assert_allclose(scene.visible[outlines], shares, atol=0.01)


def test_an_object_is_required_when_enough_of_it_is_seen():
    scene = first_frames("produce", 1, size=(640, 480))[0]
    outline = np.array([" " not in label for label in scene.labels])
    whole = visible_shares(scene.ellipses, scene.image_size, kind="overlapping")
    enough = outline & (scene.visible >= 0.4) & (whole >= 0.5)
    np.testing.assert_array_equal(scene.required, enough)


@pytest.mark.parametrize("name", NAMES)
def test_without_noise_the_truth_lies_on_the_steepest_slope(name, monkeypatch):
    monkeypatch.setitem(SORTING_LINES, name, replace(SORTING_LINES[name], noise=0.0))
    scene = first_frames(name, 1, size=(640, 480))[0]
    image = scene.image.astype(float).sum(axis=2)
    chosen = np.flatnonzero(scene.required & (scene.visible > 0.999))
    assert len(chosen) >= 5
    offsets = [np.median(_steepest(image, scene.ellipses.select([k]))) for k in chosen]
    assert abs(np.median(offsets)) < 0.3
    assert np.percentile(np.abs(offsets), 80) < 0.75


def _steepest(image, one: Ellipses):
    """Return where, from 3 pixels inside to 3 outside, the profiles of an outline are steepest."""
    ellipse = one[0]
    t = np.linspace(0, 2 * np.pi, 120, endpoint=False)
    u, v = np.cos(t) / ellipse.semi_major, np.sin(t) / ellipse.semi_minor
    c, s = np.cos(ellipse.angle), np.sin(ellipse.angle)
    outward = np.stack([u * c - v * s, u * s + v * c], axis=1)
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    along = np.arange(-3.0, 3.01, 0.25)
    points = point_at(ellipse, t)[:, None, :] + along[:, None] * outward[:, None, :]
    x = np.clip(points[..., 0], 0, image.shape[1] - 2)
    y = np.clip(points[..., 1], 0, image.shape[0] - 2)
    j, i = x.astype(int), y.astype(int)
    p, q = x - j, y - i
    values = (1 - q) * ((1 - p) * image[i, j] + p * image[i, j + 1])
    values += q * ((1 - p) * image[i + 1, j] + p * image[i + 1, j + 1])
    slope = np.abs(values[:, 4:] - values[:, :-4])
    return along[2:-2][slope.argmax(axis=1)]


@pytest.mark.parametrize("name", NAMES)
def test_the_noise_has_the_stated_strength(name, monkeypatch):
    line = SORTING_LINES[name]
    noisy = first_frames(name, 1)[0].image.astype(float)
    monkeypatch.setitem(SORTING_LINES, name, replace(line, noise=0.0))
    clean = first_frames(name, 1)[0].image.astype(float)
    inner = (clean > 40) & (clean < 220)
    expected = line.noise * np.sqrt(0.4 + 0.6 * clean[inner] / 128)
    assert ((noisy - clean)[inner] / expected).std() == pytest.approx(1.0, abs=0.05)
    assert abs((noisy - clean)[inner].mean()) < 0.2


@pytest.mark.parametrize(
    "arguments",
    [
        {"name": "nuts", "seed": 1},
        {"name": "cans", "seed": -1},
        {"name": "cans", "seed": 1, "frames": 0},
        {"name": "cans", "seed": 1, "size": (0, 5)},
    ],
)
def test_wrong_arguments_are_refused_at_the_call(arguments):
    with pytest.raises(InputError):
        sorting_sequence(**arguments)
