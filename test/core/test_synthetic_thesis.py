"""The thesis' sets keep the thesis' rules (section 5.6.1)."""

from __future__ import annotations

import numpy as np
import pytest

from geoprim_core.errors import InputError
from geoprim_core.fitting.overlap import overlap_matrix
from geoprim_core.fitting.shape import ellipse_boxes
from geoprim_core.synthetic import ALPHAS, degraded, rotated, thesis_image, thesis_set
from geoprim_core.types import Ellipses

SETS = [
    (kind, drawing) for kind in ("occluded", "overlapping") for drawing in ("filled", "outlines")
]


@pytest.mark.parametrize("count", ALPHAS)
@pytest.mark.parametrize("seed", [0, 1])
def test_every_ellipse_lies_inside_and_overlaps_another(count, seed):
    ellipses = thesis_image(count, seed, kind="overlapping", drawing="outlines").ellipses
    assert len(ellipses) == count
    boxes = ellipse_boxes(ellipses)
    assert boxes.min() >= 0
    assert boxes.max() <= 299
    assert ellipses.semi_minor.min() >= 10
    assert ellipses.semi_major.max() <= 300 / np.sqrt(2)
    shared = overlap_matrix(ellipses, ellipses)
    np.fill_diagonal(shared, 0)
    assert (shared.max(axis=1) > 0).all()


@pytest.mark.parametrize("drawing", ["filled", "outlines"])
def test_listed_are_exactly_the_ellipses_of_which_a_quarter_is_visible(drawing):
    scene = thesis_image(24, 5, drawing=drawing)
    every = thesis_image(24, 5, kind="overlapping", drawing=drawing)
    assert scene.visible.min() >= 0.25
    assert scene.visible[-1] == 1  # nothing lies on the last one
    rows = {tuple(row) for row in every.ellipses.array()}
    assert {tuple(row) for row in scene.ellipses.array()} < rows
    assert (every.visible == 1).all()


@pytest.mark.parametrize(("kind", "drawing"), SETS)
def test_the_same_seed_gives_the_same_bytes_and_another_one_others(kind, drawing):
    first = thesis_image(8, 3, kind=kind, drawing=drawing)
    again = thesis_image(8, 3, kind=kind, drawing=drawing)
    other = thesis_image(8, 4, kind=kind, drawing=drawing)
    assert first.image.tobytes() == again.image.tobytes()
    assert first.ellipses.array().tobytes() == again.ellipses.array().tobytes()
    assert first.image.tobytes() != other.image.tobytes()


def test_inks_lie_on_both_sides_of_the_ground_and_leave_the_ellipses_as_they_are():
    plain = thesis_image(12, 3, kind="overlapping", drawing="outlines")
    scene = thesis_image(12, 3, kind="overlapping", drawing="outlines", inks=True)
    assert np.array_equal(scene.ellipses.array(), plain.ellipses.array())
    ground = np.median(scene.image)
    assert scene.image.min() < ground - 25
    assert scene.image.max() > ground + 25


def test_overlapping_discs_stay_within_the_grey_scale():
    for seed in range(3):
        image = thesis_image(24, seed, kind="overlapping").image
        assert image.min() >= 11
        assert image.max() <= 244


def test_ellipses_may_reach_beyond_the_frame():
    scene = thesis_image(12, 2, kind="overlapping", overhang=80)
    boxes = ellipse_boxes(scene.ellipses)
    assert boxes.min() < 0
    assert boxes.min() >= -80
    assert boxes.max() <= 379
    assert scene.visible.min() < 1


def test_a_set_has_the_same_number_of_images_for_every_alpha():
    assert [alpha for alpha, _ in thesis_set(2, 0)] == sorted(2 * ALPHAS)


def test_a_quarter_turn_moves_image_and_truth_alike():
    scene = thesis_image(4, 1)
    turned = rotated(scene)
    x, y = 40, 210
    assert turned.image[x, 299 - y] == scene.image[y, x]
    again = rotated(rotated(turned, 2))
    assert (again.image == scene.image).all()
    np.testing.assert_allclose(again.ellipses.array(), scene.ellipses.array(), atol=1e-9)
    first, moved = scene.ellipses[0], turned.ellipses[0]
    expected = Ellipses(
        [299 - first.y], [first.x], *_axes(first), [(first.angle + np.pi / 2) % np.pi]
    )
    assert overlap_matrix(expected, Ellipses.from_array([_row(moved)]))[0, 0] > 1 - 1e-9


def _axes(e):
    return [e.semi_major], [e.semi_minor]


def _row(e):
    return [e.x, e.y, e.semi_major, e.semi_minor, e.angle]


def test_noise_has_the_stated_strength_and_leaves_the_truth_alone():
    scene = thesis_image(4, 1, drawing="outlines")
    noisy = degraded(scene, noise=6.0, contrast=0.5, seed=9)
    clean = degraded(scene, contrast=0.5)
    difference = noisy.image.astype(float) - clean.image
    assert difference.std() == pytest.approx(6.0, rel=0.03)
    assert noisy.ellipses is scene.ellipses
    assert degraded(scene, noise=6.0, seed=9).image.tobytes() == (
        degraded(scene, noise=6.0, seed=9).image.tobytes()
    )


def test_blur_keeps_the_mean_and_lowers_the_steepest_slope():
    scene = thesis_image(4, 1)
    blurred = degraded(scene, blur=2.0)
    before, after = scene.image.astype(float), blurred.image.astype(float)
    assert after.mean() == pytest.approx(before.mean(), abs=0.6)
    step = np.abs(np.diff(before, axis=1)).max()
    assert np.abs(np.diff(after, axis=1)).max() < 0.3 * step


@pytest.mark.parametrize(
    "call",
    [
        lambda: thesis_image(0, 1),
        lambda: thesis_image(4, -1),
        lambda: thesis_image(4, 1, size=20),
        lambda: thesis_image(4, 1, kind="free"),
        lambda: thesis_image(4, 1, overhang=-5),
        lambda: degraded(thesis_image(4, 1), contrast=0.0),
        lambda: degraded(thesis_image(4, 1), noise=-1.0),
    ],
)
def test_wrong_arguments_are_refused(call):
    with pytest.raises(InputError):
        call()
