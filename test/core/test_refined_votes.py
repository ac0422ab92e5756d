"""Votes of single edge points for small circles, and what noise explains, in the refined scheme."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.ecc import DetectorParams, detect_ellipses
from geoprim_core.ecc.refined import _kernels_votes as votes
from geoprim_core.ecc.refined._kernels_points import index_points
from geoprim_core.ecc.refined.arcs import gather_edges
from geoprim_core.edges import extract_contours
from geoprim_core.evaluation import match_ellipses
from geoprim_core.synthetic import circles_image
from geoprim_core.types import Contours

WIDTH, HEIGHT = 160, 120


def scattered(seed, circles, clutter=400):
    """Return points that lie near circles and face their centres roughly, and others anywhere."""
    random = np.random.default_rng(seed)
    points, angles = [random.uniform(0, (WIDTH - 1, HEIGHT - 1), (clutter, 2))], []
    angles.append(random.uniform(-np.pi, np.pi, clutter))
    for x, y, r in circles:
        t = np.arange(0, 2 * np.pi, 1.2 / r)
        radius = r + random.normal(0, 0.2, len(t))
        points.append(np.stack((x + radius * np.cos(t), y + radius * np.sin(t)), axis=1))
        angles.append(t + random.normal(0, 0.15, len(t)))
    angle = np.concatenate(angles)
    return np.concatenate(points), np.stack((np.cos(angle), np.sin(angle)), axis=1)


def voted(points, normals, width=WIDTH, height=HEIGHT, most=16.0):
    return votes.circles_by_votes(index_points(points, normals, width, height), most)


X, Y = st.floats(40.0, 110.0), st.floats(40.0, 80.0)


def assert_best(seed, circle, clutter):
    """The circle is found within half a pixel, and has the most points for its size."""
    circles, counts = voted(*scattered(seed, [circle], clutter))
    off = np.abs(circles[:, :3] - circle).max(axis=1)
    assert off.min() < 0.5
    assert off[np.argmax(counts / circles[:, 2])] < 0.5


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), X, Y, st.floats(6.0, 15.0))
def test_points_of_a_circle_in_no_order_find_it_among_others(seed, x, y, radius):
    assert_best(seed, (x, y, radius), 400)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), X, Y, st.floats(5.0, 6.0))
def test_points_of_the_smallest_circles_find_them_among_fewer_others(seed, x, y, radius):
    assert_best(seed, (x, y, radius), 100)


def test_the_smallest_circles_are_hardly_ever_missed_among_others():
    """Of 5 pixels radius about 3 in 1,000 are: as many points lie about them as on them."""
    missed = 0
    for seed in range(300):
        x = 40.0 + seed % 50
        circles, _ = voted(*scattered(seed, [(x, 48.0, 5.0)]))
        missed += not (np.abs(circles[:, :3] - [x, 48.0, 5.0]).max(axis=1) < 0.5).any()
    assert missed <= 2


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10**6), st.floats(5.0, 8.0), st.floats(4.5, 6.0))
def test_both_circles_around_one_centre_are_found(seed, radius, apart):
    circles, _ = voted(*scattered(seed, [(70.4, 60.3, radius), (70.4, 60.3, radius + apart)]))
    for wanted in (radius, radius + apart):
        assert np.abs(circles[:, :3] - [70.4, 60.3, wanted]).max(axis=1).min() < 0.6


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6))
def test_points_anywhere_make_no_circle(seed):
    circles, _ = voted(*scattered(seed, [], clutter=1500))
    assert len(circles) == 0


def test_points_outside_the_image_vote_for_nothing():
    points, normals = scattered(5, [(60.0, 60.0, 8.0)])
    far = np.array([[1e7, 5.0], [-1e7, 5.0], [5.0, 1e7], [5.0, -1e7], [1e300, 0.0]])
    outside = np.repeat([[0.6, 0.8]], len(far), axis=0)
    alone, _ = voted(points, normals)
    more, _ = voted(np.concatenate((points, far)), np.concatenate((normals, outside)))
    assert len(alone) > 0
    assert np.allclose(more, alone)


@pytest.mark.parametrize("turn", ["quarter", "mirror", "flip"])
def test_votes_turn_and_mirror_with_the_image(turn):
    points, normals = scattered(3, [(50.3, 41.2, 6.0), (100.7, 77.9, 11.5), (30.0, 90.0, 9.0)])
    width, height = WIDTH, HEIGHT
    change = np.array({"quarter": [[0, 1], [-1, 0]], "mirror": [[-1, 0], [0, 1]]}.get(
        turn, [[-1, 0], [0, -1]]
    ), float)  # fmt: skip
    middle = np.array([0.5 * (width - 1), 0.5 * (height - 1)])
    if turn == "quarter":
        width, height = height, width
    other = np.array([0.5 * (width - 1), 0.5 * (height - 1)])
    before, _ = voted(points, normals)
    after, _ = voted((points - middle) @ change.T + other, normals @ change.T, width, height)
    expected = np.column_stack(((before[:, :2] - middle) @ change.T + other, before[:, 2]))
    assert len(before) >= 3
    assert np.allclose(sorted_rows(after[:, :3]), sorted_rows(expected), atol=1e-6)


def sorted_rows(rows):
    return rows[np.lexsort(np.round(rows, 3).T)]


def test_faint_small_circles_in_noise_are_found_by_votes():
    """Contours of most of these are in pieces."""
    found = {0.0: 0, 16.0: 0}
    for seed in range(4):
        scene = circles_image(12, seed, noise=27.0)
        for radius in found:
            params = DetectorParams().updated({"ecc.refined.vote_radius": radius})
            found[radius] += int(match_ellipses(
                detect_ellipses(scene.image, params).ellipses, scene.ellipses, overlap=0.8
            ).hit.sum())  # fmt: skip
    assert found[16.0] > found[0.0]


@pytest.mark.parametrize("seed", range(3))
def test_noise_alone_gives_no_ellipse(seed):
    image = np.random.default_rng(seed).normal(128, 30, (300, 400))
    found = detect_ellipses(np.clip(image, 0, 255).astype(np.uint8))
    assert len(found) == 0


def test_an_image_counts_as_noisy_by_what_it_was_blurred():
    clean, noisy = circles_image(5, 1), circles_image(5, 1, noise=25.0)
    assert gather(extract_contours(clean.image)).noisiness == 0.0
    assert gather(extract_contours(noisy.image)).noisiness == 1.0
    unknown = Contours(np.zeros((0, 2)), [0], [], (40, 30))
    assert gather(unknown).noisiness == 0.0


def gather(contours):
    return gather_edges(contours, DetectorParams().ecc.refined)
