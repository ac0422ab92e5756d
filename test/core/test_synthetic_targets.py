"""The truth of rendered circles, calibration targets and turned scenes is exact."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError
from geoprim_core.evaluation.benchmark_sets import BENCHMARK_SETS, select_sets
from geoprim_core.fitting.overlap import overlap_matrix
from geoprim_core.fitting.shape import ellipse_boxes
from geoprim_core.synthetic import (
    ARRANGEMENTS,
    TARGETS,
    circles_image,
    disc_image,
    disc_scene,
    project_circle,
    rotated,
    thesis_image,
)


def moments(image, ground, around=None):
    """Return volume and centre of what differs from the ground, within x, y, reach if given."""
    cover = image.astype(float) - ground
    y, x = np.mgrid[: image.shape[0], : image.shape[1]]
    if around is not None:
        cover[np.hypot(x - around[0], y - around[1]) > around[2]] = 0
    total = cover.sum()
    return total, (cover * x).sum() / total, (cover * y).sum() / total


@given(
    radius=st.floats(5, 45), x=st.floats(50, 70), y=st.floats(50, 70), inside=st.integers(90, 255)
)
@settings(max_examples=40, deadline=None)
def test_the_edge_of_a_disc_lies_at_its_radius(radius, x, y, inside):
    image = disc_image(120, 120, centre=(x, y), radius=radius, inside=inside, outside=0)
    total, cx, cy = moments(image, 0)
    # a pixel's cover is taken from its distance alone, which costs a few hundredths of a pixel
    assert np.sqrt(total / inside / np.pi) == pytest.approx(radius, abs=0.04)
    assert (cx, cy) == pytest.approx((x, y), abs=0.04)


@pytest.mark.parametrize("seed", range(3))
def test_every_filled_circle_has_its_area_and_centre(seed):
    scene = circles_image(8, seed, size=(400, 300))
    ground = float(scene.image[0, 0])
    for e in scene.ellipses:
        assert e.semi_major == e.semi_minor
        total, x, y = moments(scene.image, ground, (e.x, e.y, e.semi_major + 3))
        tone = float(scene.image[round(e.y), round(e.x)]) - ground
        assert np.sqrt(total / tone / np.pi) == pytest.approx(e.semi_major, abs=0.03)
        assert (x, y) == pytest.approx((e.x, e.y), abs=0.03)


@pytest.mark.parametrize("arrangement", ARRANGEMENTS)
@pytest.mark.parametrize("seed", range(4))
def test_circles_lie_as_arranged(arrangement, seed):
    e = circles_image(9, seed, arrangement=arrangement, drawing="outlines").ellipses
    gap = np.hypot(e.x[:, None] - e.x, e.y[:, None] - e.y) - e.semi_major[:, None] - e.semi_major
    np.fill_diagonal(gap, np.inf)
    assert e.semi_major.min() >= 5
    assert e.semi_major.max() <= 120
    if arrangement == "apart":
        assert gap.min() >= 6
    elif arrangement == "touching":
        assert np.abs(gap.min(axis=1)).max() < 1e-9
    else:
        same = (e.x[:, None] == e.x) & (e.y[:, None] == e.y)
        steps = np.abs(e.semi_major[:, None] - e.semi_major)[same & ~np.eye(len(e), dtype=bool)]
        assert len(steps) >= 2
        assert steps.min() >= 6


def test_a_drawn_circle_is_darkest_or_brightest_on_its_outline():
    scene = circles_image(1, 5, drawing="outlines")
    e, ground = scene.ellipses[0], int(scene.image[0, 0])
    y, x = np.mgrid[: scene.image.shape[0], : scene.image.shape[1]]
    distance = np.hypot(x - e.x, y - e.y) - e.semi_major
    stroke = np.abs(scene.image.astype(int) - ground)
    assert stroke[np.abs(distance) < 0.4].min() >= 0.99 * stroke.max()
    assert stroke[np.abs(distance) > 1.6].max() == 0
    assert (stroke * distance).sum() / stroke.sum() == pytest.approx(0, abs=0.02)


@pytest.mark.parametrize("drawing", ["filled", "outlines"])
def test_hard_circles_have_no_grey_levels_in_between(drawing):
    soft, hard = (circles_image(6, 3, drawing=drawing, hard=h, stroke=3.0) for h in (False, True))
    assert np.array_equal(soft.ellipses.array(), hard.ellipses.array())
    assert len(np.unique(hard.image)) <= len(hard.ellipses) + 1
    y, x = np.mgrid[: hard.image.shape[0], : hard.image.shape[1]]
    for e in hard.ellipses:
        beyond = np.abs(np.hypot(x - e.x, y - e.y) - e.semi_major - 1.5 * (drawing != "filled"))
        near = (beyond > 0.6) & (beyond < 2.0)  # where both drawings are of one level
        assert np.array_equal(soft.image[near], hard.image[near])


planes = st.tuples(st.floats(-50, 50), st.floats(0, 0.9), st.floats(0, 6.3), st.floats(0, 6.3))


@given(planes, st.floats(-40, 40), st.floats(-40, 40), st.floats(2, 30))
@settings(max_examples=60, deadline=None)
def test_a_projected_circle_is_the_ellipse_of_its_projected_points(plane, x, y, radius):
    shift, tilt, turn, spin = plane
    c, s = np.cos([tilt, turn, spin]), np.sin([tilt, turn, spin])
    turn_z = np.array([[c[1], -s[1], 0], [s[1], c[1], 0], [0, 0, 1]])
    turn_x = np.array([[1, 0, 0], [0, c[0], -s[0]], [0, s[0], c[0]]])
    spin_z = np.array([[c[2], -s[2], 0], [s[2], c[2], 0], [0, 0, 1]])
    rotation = turn_z @ turn_x @ spin_z
    camera = np.array([[500.0, 0, 320], [0, 500, 240], [0, 0, 1]])
    homography = camera @ np.column_stack([rotation[:, :2], [shift, 10, 500]])
    row = project_circle(homography, x, y, radius)
    t = np.linspace(0, 2 * np.pi, 24)
    circle = np.array([x + radius * np.cos(t), y + radius * np.sin(t), np.ones_like(t)])
    seen = homography @ circle
    d = (seen[:2] / seen[2]).T - row[:2]
    ca, sa = np.cos(row[4]), np.sin(row[4])
    values = (d @ [ca, sa] / row[2]) ** 2 + (d @ [-sa, ca] / row[3]) ** 2
    np.testing.assert_allclose(values, 1, atol=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_discs_on_plain_ground_have_their_area_and_centre(seed):
    scene = disc_scene(np.full((480, 640), 128, np.uint8), seed)
    assert len(scene.ellipses) >= 3
    for e in scene.ellipses:
        total, x, y = moments(scene.image, 128, (e.x, e.y, e.semi_major + 3))
        area = total / (float(scene.image[round(e.y), round(e.x)]) - 128)
        assert area == pytest.approx(np.pi * e.semi_major * e.semi_minor, rel=0.01)
        assert (x, y) == pytest.approx((e.x, e.y), abs=0.05)


def test_rings_lie_inside_one_another_and_dots_apart():
    ground = np.random.default_rng(1).integers(0, 255, (300, 400, 3)).astype(np.uint8)
    rings = disc_scene(ground, 4, target="rings").ellipses
    boxes = ellipse_boxes(rings)
    inside = (boxes[:, None, :2] < boxes[None, :, :2]).all(2) & (
        boxes[:, None, 2:] > boxes[None, :, 2:]
    ).all(2)
    assert inside.any(axis=0).sum() >= len(rings) / 2
    dots = disc_scene(ground, 4, target="dots").ellipses
    shared = overlap_matrix(dots, dots)
    assert shared.sum() == pytest.approx(len(dots))
    assert ellipse_boxes(dots).min() > 0


@pytest.mark.parametrize("target", TARGETS)
def test_noise_blur_and_light_change_the_image_and_not_the_truth(target):
    ground = np.full((240, 320, 3), 90, np.uint8)
    plain = disc_scene(ground, 2, target=target)
    worse = disc_scene(ground, 2, target=target, noise=5, blur=1, shading=0.5)
    np.testing.assert_array_equal(plain.ellipses.array(), worse.ellipses.array())
    assert worse.image.mean() < 0.9 * plain.image.mean()
    assert ground.min() == ground.max() == 90  # the caller's array stays as it is


def test_a_quarter_turn_of_the_ellipses_is_the_quarter_turn_of_the_image():
    for kind in ("occluded", "overlapping"):
        turned = thesis_image(8, 3, kind=kind, turn=np.pi / 2)
        exact = rotated(thesis_image(8, 3, kind=kind))
        assert np.abs(turned.image.astype(int) - exact.image).max() <= 1
        shared = overlap_matrix(turned.ellipses, exact.ellipses)
        np.testing.assert_allclose(np.diag(shared), 1, atol=1e-6)


@pytest.mark.parametrize("turn", [0.4, 2.0, -1.0])
def test_a_turned_scene_shows_the_same_gray_at_the_turned_place(turn):
    scene, turned = thesis_image(12, 7), thesis_image(12, 7, turn=turn)
    side = turned.image.shape[0]
    random = np.random.default_rng(0)
    same = 0
    for x, y in random.integers(5, 295, (400, 2)):
        u, v = x - 149.5, y - 149.5
        px = np.cos(turn) * u - np.sin(turn) * v + (side - 1) / 2
        py = np.sin(turn) * u + np.cos(turn) * v + (side - 1) / 2
        same += turned.image[round(py), round(px)] == scene.image[y, x]
    assert same > 370  # all but those at a border
    np.testing.assert_allclose(turned.ellipses.semi_minor, scene.ellipses.semi_minor)
    np.testing.assert_allclose(turned.visible, scene.visible, atol=0.003)
    boxes = ellipse_boxes(turned.ellipses)
    assert boxes.min() > -1
    assert boxes.max() < side


def test_the_table_has_all_variants_of_all_four_sets():
    names = {row.name for row in select_sets(["thesis", "variants"])}
    for kind in ("occluded", "overlapping"):
        for drawing in ("filled", "outlines"):
            assert f"{kind}_{drawing}" in names
            for change in ("noisy", "blurred", "faint", "rotated", "out_of_frame"):
                assert f"{kind}_{drawing}_{change}" in names
        assert f"{kind}_outlines_inks" in names
    assert set(select_sets(["all"])) == set(BENCHMARK_SETS.values())
    assert [s.name for s in select_sets(["noise", "noise", "circles"])] == [
        "noise", "circles_clean", "circles_hard", "circles_noisy",
    ]  # fmt: skip


@pytest.mark.parametrize("row", BENCHMARK_SETS.values(), ids=lambda row: row.name)
def test_a_set_is_the_same_for_the_same_seed_and_its_truth_lies_where_it_says(row):
    first, again = (next(row.images(1, seed=5)) for _ in range(2))
    other = next(row.images(1, seed=6))
    assert first.image.tobytes() == again.image.tobytes()
    assert first.image.tobytes() != other.image.tobytes()
    assert first.truth.group == row.name
    assert not first.truth.uncertain.any()
    boxes = ellipse_boxes(first.truth.ellipses)
    if row.name == "noise":
        assert len(boxes) == 0
    elif not row.name.endswith("out_of_frame"):
        size = first.image.shape[1], first.image.shape[0]
        assert boxes[:, :2].min() > -0.5
        assert (boxes[:, 2:] < np.array(size) - 0.5).all()


def test_ellipses_out_of_the_frame_are_there_and_mostly_visible():
    images = BENCHMARK_SETS["overlapping_filled_out_of_frame"].images(6)
    boxes = np.vstack([ellipse_boxes(image.truth.ellipses) for image in images])
    assert ((boxes.min(axis=1) < 0) | (boxes.max(axis=1) > 299)).mean() > 0.2


def test_discs_go_round_the_given_backgrounds():
    grounds = {name: np.full((200, 260), tone, np.uint8) for name, tone in (("a", 60), ("b", 200))}
    images = list(BENCHMARK_SETS["discs"].images(6, backgrounds=grounds))
    assert [image.truth.name.split("_")[1] for image in images] == list("ababab")
    assert {image.truth.name.split("_")[0] for image in images} == set(TARGETS)


@pytest.mark.parametrize(
    "call",
    [
        lambda: circles_image(0, 1),
        lambda: circles_image(3, 1, arrangement="strewn"),
        lambda: circles_image(3, 1, size=(12, 200)),
        lambda: circles_image(3, 1, noise=-1),
        lambda: disc_scene(np.zeros((100, 300), np.uint8), 1),
        lambda: disc_scene(np.zeros((200, 300)), 1),
        lambda: disc_scene(np.zeros((200, 300), np.uint8), 1, target="squares"),
        lambda: disc_scene(np.zeros((200, 300), np.uint8), 1, shading=1.0),
        lambda: thesis_image(4, 1, turn=np.inf),
        lambda: select_sets(["photographs"]),
        lambda: list(BENCHMARK_SETS["noise"].images(0)),
    ],
)
def test_wrong_arguments_are_refused(call):
    with pytest.raises(InputError):
        call()
