"""Truths about the contours and both ways of linking them."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from skimage import data

from geoprim_core.edges import TABLE, EdgeParams, extract_contours, trace_edges
from geoprim_core.edges.linking import (
    link_by_direction,
    link_without_junctions,
    locate_pixels,
)
from geoprim_core.types import Contours

CENTRE = (70.3, 60.8)
LINKINGS = TABLE.names


def disc(radius: float, width: int = 140, height: int = 120) -> np.ndarray:
    y, x = np.mgrid[:height, :width]
    inside = np.clip(radius + 0.5 - np.hypot(x - CENTRE[0], y - CENTRE[1]), 0, 1)
    return np.rint(40 + 170 * inside).astype(np.uint8)


def circle(radius: float, stroke: float) -> np.ndarray:
    y, x = np.mgrid[:120, :140]
    away = np.abs(np.hypot(x - CENTRE[0], y - CENTRE[1]) - radius) - 0.5 * stroke
    return np.rint(200 - 150 * np.clip(0.5 - away, 0, 1)).astype(np.uint8)


def radii(points: np.ndarray) -> np.ndarray:
    return np.hypot(points[:, 0] - CENTRE[0], points[:, 1] - CENTRE[1])


def pixels_of(edges, dx, dy):
    return locate_pixels(np.flatnonzero(edges).astype(np.uint32), dx, dy)


def slices(contours):
    return [slice(a, b) for a, b in zip(contours.offsets[:-1], contours.offsets[1:], strict=True)]


def check_form(contours):
    """They were built unchecked: the checks would not have changed a thing."""
    names = [field.name for field in fields(contours)]
    checked = Contours(*(getattr(contours, name) for name in names))
    for name in names:
        value, wanted = getattr(contours, name), getattr(checked, name)
        assert type(value) is type(wanted)
        assert value is wanted or np.array_equal(value, wanted, equal_nan=name == "blur")
        assert getattr(value, "dtype", None) == getattr(wanted, "dtype", None)


def check_laws(contours, shape, params):
    """What holds for the contours of every image."""
    height, width = shape
    points = contours.points
    assert contours.image_size == (width, height)
    np.testing.assert_array_equal(points, np.rint(points))
    assert ((points >= 0) & (points <= (width - 1, height - 1))).all()
    assert (np.abs(contours.subpixel - points) <= 0.5).all()
    np.testing.assert_array_equal(contours.subpixel * 256, np.rint(contours.subpixel * 256))
    np.testing.assert_array_equal(contours.gradient_angle, np.float32(contours.gradient_angle))
    check_form(contours)
    for curve, closed in zip(contours, contours.closed, strict=True):
        assert len(curve) >= params.min_length
        steps = np.abs(np.diff(curve, axis=0)).max(axis=1)
        assert (steps == 1).all()
        assert closed == (np.abs(curve[-1] - curve[0]).max() <= 1)


@pytest.mark.parametrize("linking", LINKINGS)
@settings(max_examples=40, deadline=None)
@given(
    arrays(np.uint8, st.tuples(st.integers(1, 24), st.integers(1, 24))),
    st.integers(2, 8),
    st.sampled_from([0.0, 0.5, 1.0]),
)
def test_laws_on_any_image(linking, image, min_length, sigma):
    params = EdgeParams(linking=linking, min_length=min_length, sigma=sigma)
    check_laws(extract_contours(image, params), image.shape, params)


@pytest.mark.parametrize("linking", LINKINGS)
@pytest.mark.parametrize("name", ["coins", "camera"])
def test_laws_on_photographs(linking, name):
    image = getattr(data, name)()
    params = EdgeParams(linking=linking)
    check_laws(extract_contours(image, params), image.shape, params)


@pytest.mark.parametrize("linking", LINKINGS)
@pytest.mark.parametrize("radius", [5.0, 6.0, 8.0, 10.0, 14.7, 20.0, 33.3, 50.0])
def test_a_disc_gives_one_closed_contour_round_it(linking, radius):
    contours = extract_contours(disc(radius), EdgeParams(linking=linking))
    assert contours.closed.tolist() == [True]
    turns = np.unwrap(np.arctan2(*(contours.points - CENTRE).T[::-1]))
    assert abs(turns[-1] - turns[0]) == pytest.approx(2 * np.pi, abs=0.3)


@pytest.mark.parametrize("radius", [30.0, 41.6, 50.0])
def test_subpixel_positions_lie_on_the_edge_of_a_disc(radius):
    away = radii(extract_contours(disc(radius)).subpixel) - radius
    assert abs(away.mean()) < 0.03
    assert away.std() < 0.03


def test_the_bias_is_the_shrinkage_of_the_blur():
    """A blurred disc's steepest circle moves inwards by about variance / (2 radius)."""
    variance = EdgeParams().sigma ** 2 + 0.5  # Gaussian and Sobel, in pixels squared
    for radius in (12.0, 20.0, 30.0):
        away = radii(extract_contours(disc(radius)).subpixel) - radius
        assert away.mean() == pytest.approx(-variance / (2 * radius), abs=0.012)


@pytest.mark.parametrize("linking", LINKINGS)
def test_magnitudes_are_those_of_the_gradient_at_the_pixels(linking):
    trace = trace_edges(disc(40.0), EdgeParams(linking=linking))
    x, y = trace.contours.points.astype(int).T
    there = np.hypot(trace.dx[y, x], trace.dy[y, x])
    own = trace.edges[y, x]  # others were put in between
    magnitude = trace.contours.gradient_magnitude
    np.testing.assert_allclose(magnitude[own], there[own], rtol=1e-6)
    assert (magnitude > 0.0).all()


@pytest.mark.parametrize("linking", LINKINGS)
def test_gradient_angles_point_from_dark_to_bright(linking):
    contours = extract_contours(disc(40.0), EdgeParams(linking=linking))
    inward = np.array(CENTRE) - contours.subpixel
    error = contours.gradient_angle - np.arctan2(inward[:, 1], inward[:, 0])
    assert (np.abs((error + np.pi) % (2 * np.pi) - np.pi) < np.radians(4.0)).all()


def test_direction_linking_keeps_the_bright_side_on_the_right():
    contours = extract_contours(data.coins())
    for part in slices(contours):
        step = np.diff(contours.points[part], axis=0)
        angle = contours.gradient_angle[part][:-1]
        along = np.cos(angle) * step[:, 1] - np.sin(angle) * step[:, 0]
        assert along.mean() < 0


@pytest.mark.parametrize("stroke", [1.5, 2.0, 3.0])
def test_direction_linking_keeps_the_two_edges_of_a_stroke_apart(stroke):
    contours = extract_contours(circle(40.0, stroke), EdgeParams(sigma=0.5))
    for part in slices(contours):
        side = np.sign(radii(contours.subpixel[part]) - 40.0)
        assert len(np.unique(side)) == 1
        assert np.abs(radii(contours.subpixel[part]).std()) < 0.2


def test_direction_linking_passes_through_a_junction():
    """A faint half-plane meets the rim of a disc: one contour follows the rim all round."""
    y, _ = np.mgrid[:120, :140]
    image = disc(40.0)
    image[(image < 125) & (y > 60)] += 12
    params = EdgeParams(threshold_rule="absolute", low_gradient=1.0, high_gradient=2.0)
    contours = extract_contours(image, params)
    rim = [len(c) for c in contours if (np.abs(radii(c) - 40.0) < 2.0).all()]
    assert max(rim) > 220
    assert max(len(c) for c in contours) == max(rim)


def test_direction_linking_goes_straight_on_where_two_edges_cross():
    y, x = np.mgrid[:80, :80]
    image = (60 + 60 * (x > 40) + 60 * (x + y > 90)).astype(np.uint8)
    contours = extract_contours(image, EdgeParams(sigma=0.5))
    for part in slices(contours):
        angle = np.unwrap(contours.gradient_angle[part])
        assert np.ptp(angle) < np.radians(30)


def test_junction_linking_cuts_a_cross_into_its_four_arms():
    edges = np.zeros((31, 41), bool)
    edges[15, 5:36] = True
    edges[3:28, 20] = True
    flat = np.ones(edges.shape, np.float32)
    pixels = pixels_of(edges, flat, flat)
    contours = link_without_junctions(pixels, params=EdgeParams())
    assert not contours.closed.any()
    arms = sorted(sorted(map(tuple, c.astype(int).tolist())) for c in contours)
    whole = [[(x, 15) for x in range(5, 20)], [(x, 15) for x in range(21, 36)],
             [(20, y) for y in range(3, 15)], [(20, y) for y in range(16, 28)]]  # fmt: skip
    assert len(arms) == 4
    for arm in arms:
        line = next(w for w in whole if set(arm) <= set(w))
        assert len(arm) >= len(line) - 1


def test_junction_linking_drops_a_short_branch():
    edges = np.zeros((31, 41), bool)
    edges[15, 5:36] = True
    edges[12:15, 20] = True
    flat = np.ones(edges.shape, np.float32)
    contours = link_without_junctions(pixels_of(edges, flat, flat), params=EdgeParams())
    assert len(contours) == 2
    assert (contours.points[:, 1] == 15).all()


def test_a_missing_pixel_is_put_in():
    trace = trace_edges(disc(40.0))
    edges = trace.edges.copy()
    row = np.flatnonzero(edges[:, 70])[0]
    edges[row - 1 : row + 2, 70] = False
    contours = link_by_direction(pixels_of(edges, trace.dx, trace.dy), params=EdgeParams())
    assert contours.closed.tolist() == [True]
    assert (contours.points == (70, row)).all(axis=1).any()


def test_min_length_is_the_least_number_of_pixels():
    image = data.coins()
    every = np.diff(extract_contours(image, EdgeParams(min_length=2)).offsets)
    some = np.diff(extract_contours(image, EdgeParams(min_length=20)).offsets)
    np.testing.assert_array_equal(np.sort(every[every >= 20]), np.sort(some))


@pytest.mark.parametrize("name", ["coins", "camera"])
def test_junction_linking_uses_no_pixel_twice(name):
    points = extract_contours(getattr(data, name)(), EdgeParams(linking="junctions")).points
    assert len(np.unique(points, axis=0)) == len(points)


def test_direction_linking_shares_only_pixels_that_it_put_in():
    trace = trace_edges(data.camera())
    x, y = trace.contours.points.astype(int).T
    _, count = np.unique(np.stack((x, y)), axis=1, return_counts=True)
    assert (count > 1).sum() < 0.01 * len(count)
    own = trace.edges[y, x]
    assert own.mean() > 0.95


@pytest.mark.parametrize("turn", [np.rot90, np.fliplr, np.transpose])
def test_contours_without_junctions_nearly_turn_with_the_image(turn):
    """Pixels as far from the edge are thinned in their order, so a few pixels may differ."""
    image = data.coins()
    params = EdgeParams(linking="junctions", sigma=1.0, low_auto=0.2, high_auto=0.5)

    def marked(picture):
        mask = np.zeros(picture.shape, bool)
        x, y = extract_contours(picture, params).points.astype(int).T
        mask[y, x] = True
        return mask

    here, there = turn(marked(image)), marked(turn(image))
    assert (here != there).sum() < 0.03 * here.sum()


@pytest.mark.parametrize("linking", LINKINGS)
def test_memory_layout_does_not_matter_and_the_image_is_not_touched(linking):
    params = EdgeParams(linking=linking)
    image = data.coffee()[:200, :240]
    image.setflags(write=False)
    base = extract_contours(np.ascontiguousarray(image), params)
    wide = np.zeros((200, 480, 3), np.uint8)
    wide[:, ::2] = image
    for form in (image, np.asfortranarray(image), wide[:, ::2], image[::-1].copy()[::-1]):
        kept = form.copy()
        contours = extract_contours(form, params)
        np.testing.assert_array_equal(contours.points, base.points)
        np.testing.assert_array_equal(contours.subpixel, base.subpixel)
        np.testing.assert_array_equal(form, kept)


@pytest.mark.parametrize("linking", LINKINGS)
@pytest.mark.parametrize("value", [0, 255])
@pytest.mark.parametrize("shape", [(1, 1), (2, 2), (1, 50), (50, 1), (2, 50), (30, 40), (9, 9, 3)])
def test_plain_images_have_no_contours(linking, value, shape):
    image = np.full(shape, value, np.uint8)
    contours = extract_contours(image, EdgeParams(linking=linking))
    assert (len(contours), len(contours.points)) == (0, 0)
    assert contours.image_size == (shape[1], shape[0])


@pytest.mark.parametrize("kind", [np.uint16, np.float32, np.float64, bool])
def test_every_pixel_type_gives_the_same_disc(kind):
    image = disc(40.0)
    image = image > 125 if kind is bool else image.astype(kind)
    contours = extract_contours(image)
    assert contours.closed.tolist() == [True]
    assert abs((radii(contours.subpixel) - 40.0).mean()) < 0.1


def test_without_subpixel_the_pixels_are_the_same():
    image = data.coins()
    plain, fine = extract_contours(image, EdgeParams(subpixel=False)), extract_contours(image)
    assert plain.subpixel is None
    np.testing.assert_array_equal(plain.points, fine.points)


def test_extract_and_trace_agree():
    image = data.coins()
    trace, contours = trace_edges(image), extract_contours(image)
    for name in ("points", "offsets", "closed", "subpixel", "gradient_angle"):
        np.testing.assert_array_equal(getattr(trace.contours, name), getattr(contours, name))


def test_the_table_has_both_ways_of_linking():
    assert [row.name for row in TABLE] == ["direction", "junctions"]
    assert EdgeParams().linking == "direction"
