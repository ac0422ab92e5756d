"""Truths about the grey image, the gradient, the thresholds and the edge map."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from skimage import data

from geoprim_core.edges import EdgeParams, extract_contours, trace_edges
from geoprim_core.edges.canny import (
    gaussian_weights,
    gradient,
    pixel_noise,
    steady_gradient,
    to_gray,
)
from geoprim_core.errors import ImageError, ParameterError
from geoprim_core.synthetic import disc_image


def textured(seed: int, height: int = 40, width: int = 50) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, (height, width), dtype=np.uint8)


def framed(image: np.ndarray, left: int, top: int, border: int = 16) -> np.ndarray:
    full = np.full((image.shape[0] + 2 * border, image.shape[1] + 2 * border), 90, np.uint8)
    y, x = border + top, border + left
    full[y : y + image.shape[0], x : x + image.shape[1]] = image
    return full


PICTURES = [textured(1), (textured(2) > 128).astype(np.uint8) * 200, data.coins()]


@pytest.mark.parametrize("image", PICTURES, ids=["noise", "two levels", "coins"])
@pytest.mark.parametrize("rule", ["auto", "absolute", "fraction"])
@pytest.mark.parametrize("turn", [np.rot90, np.fliplr, np.flipud, np.transpose])
def test_the_edge_map_turns_and_mirrors_with_the_image(image, rule, turn):
    params = EdgeParams(threshold_rule=rule)
    before, after = trace_edges(image, params), trace_edges(turn(image), params)
    assert before.edges.any()
    np.testing.assert_array_equal(turn(before.edges), after.edges)


@pytest.mark.parametrize("image", PICTURES, ids=["noise", "two levels", "coins"])
@pytest.mark.parametrize("sigma", [0.0, 0.5, 1.0, 2.3])
def test_the_edge_map_shifts_with_the_image(image, sigma):
    params = EdgeParams(sigma=sigma)
    before = trace_edges(framed(image, 0, 0), params)
    after = trace_edges(framed(image, 1, -1), params)
    np.testing.assert_array_equal(before.edges[1:, :-1], after.edges[:-1, 1:])


def test_an_ideal_step_gives_one_edge_pixel_a_row_on_its_bright_side():
    image = np.zeros((9, 12), np.uint8)
    image[:, 6:] = 100
    assert np.argwhere(trace_edges(image).edges)[:, 1].tolist() == [6] * 7
    assert np.argwhere(trace_edges(image[:, ::-1]).edges)[:, 1].tolist() == [5] * 7


@pytest.mark.parametrize("slope", [(3, 0), (0, 3), (2, 1), (-1, 2)])
def test_the_gradient_of_a_plane_is_its_slope(slope):
    y, x = np.mgrid[:20, :24]
    plane = (100 + slope[0] * x + slope[1] * y).astype(np.uint8)
    trace = trace_edges(plane)
    np.testing.assert_array_equal(trace.dx[6:-6, 6:-6], slope[0])
    np.testing.assert_array_equal(trace.dy[6:-6, 6:-6], slope[1])


@given(st.floats(0.0, 5.0))
def test_gaussian_weights_are_whole_symmetric_and_sum_to_128(sigma):
    weights = gaussian_weights(sigma)
    assert weights.sum() == 128 and (weights >= 0).all()
    np.testing.assert_array_equal(weights, np.rint(weights))
    np.testing.assert_array_equal(weights, weights[::-1])


@pytest.mark.parametrize("sigma", [0.8, 1.0, 1.5, 2.0, 3.0])
def test_gaussian_weights_have_the_variance_asked_for(sigma):
    weights = gaussian_weights(sigma) / 128.0
    places = np.arange(len(weights)) - len(weights) // 2
    assert np.sqrt((weights * places**2).sum()) == pytest.approx(sigma, rel=0.05)


def test_thresholds_of_the_rules():
    image = framed(np.full((20, 20), 250, np.uint8), 0, 0)
    trace = trace_edges(image, EdgeParams(threshold_rule="fraction"))
    largest = np.hypot(trace.dx, trace.dy).max()
    assert (trace.low, trace.high) == pytest.approx((0.1 * largest, 0.2 * largest))
    params = EdgeParams(threshold_rule="absolute", low_gradient=2.0, high_gradient=9.0)
    trace = trace_edges(image, params)
    assert (trace.low, trace.high) == (2.0, 9.0)


@pytest.mark.parametrize("rule", ["auto", "fraction"])
def test_thresholds_follow_the_contrast(rule):
    image = data.coins() // 4
    params = EdgeParams(threshold_rule=rule)
    once, thrice = trace_edges(image, params), trace_edges(3 * image, params)
    assert (thrice.low, thrice.high) == pytest.approx((3 * once.low, 3 * once.high), rel=1e-5)
    assert (once.edges != thrice.edges).mean() < 1e-4


def test_a_gain_of_one_percent_moves_few_edges():
    image = data.coins()
    louder = np.clip(np.rint(image * 1.01), 0, 255).astype(np.uint8)
    before, after = trace_edges(image).edges, trace_edges(louder).edges
    assert (before != after).sum() < 0.06 * before.sum()


def test_flat_ground_does_not_change_the_automatic_thresholds():
    patch = np.kron(textured(3, 6, 6), np.ones((8, 8), np.uint8))
    small, large = framed(patch, 0, 0, 16), framed(patch, 0, 0, 160)
    assert trace_edges(small).high == pytest.approx(trace_edges(large).high, rel=1e-5)


def test_the_noise_factor_lifts_both_thresholds_to_the_noise():
    rng = np.random.default_rng(4)
    noise = np.clip(rng.normal(128, 10, (200, 200)), 0, 255).astype(np.uint8)
    plain, lifted = trace_edges(noise), trace_edges(noise, EdgeParams(noise_factor=5.0))
    scale = np.hypot(lifted.dx, lifted.dy).std() / np.sqrt(2 - np.pi / 2)  # Rayleigh
    assert lifted.high == pytest.approx(5.0 * scale, rel=0.05)
    assert lifted.low / lifted.high == pytest.approx(plain.low / plain.high)
    assert lifted.edges.sum() < 0.01 * plain.edges.sum()


def test_weak_edges_survive_only_where_they_touch_a_strong_one():
    image = np.zeros((30, 40), np.uint8)
    image[:, 10:] = 12  # weak all along
    image[:, 25:] = np.linspace(30, 110, 30).astype(np.uint8)[:, None]  # weak to strong
    params = EdgeParams(threshold_rule="absolute", low_gradient=2.0, high_gradient=20.0)
    expected = np.zeros(image.shape, bool)
    expected[1:-1, 25] = True
    np.testing.assert_array_equal(trace_edges(image, params).edges, expected)


def test_gray_is_weighted_in_bgr_order():
    blue, green, red = np.eye(3, dtype=np.uint8)[:, None, None, :] * np.uint8(255)
    assert [int(to_gray(c)[0, 0]) for c in (blue, green, red)] == [29, 150, 76]


def test_alpha_is_left_out():
    image = np.random.default_rng(5).integers(0, 256, (20, 20, 4), dtype=np.uint8)
    np.testing.assert_array_equal(to_gray(image), to_gray(image[:, :, :3]))


@pytest.mark.parametrize("kind", [np.uint16, np.float32, np.float64])
def test_other_types_are_stretched_to_0_255(kind):
    coins = data.coins()
    spread = (coins.astype(np.float64) * 201 + 300).astype(kind)
    gray = to_gray(spread)
    assert (float(gray.min()), float(gray.max())) == (0.0, 255.0)
    low, high = float(coins.min()), float(coins.max())
    np.testing.assert_allclose(gray, (coins - low) / (high - low) * 255, atol=1e-3)


@pytest.mark.parametrize("scale", [1e-300, 1.0, 1.7e308])
def test_float_images_of_any_scale_are_stretched(scale):
    image = np.array([[-1.0, 0.0], [0.5, 1.0]]) * scale
    np.testing.assert_allclose(to_gray(image), [[0.0, 127.5], [191.25, 255.0]], rtol=1e-6)


@pytest.mark.parametrize("kind", [np.uint16, np.float32, np.float64])
def test_a_constant_image_of_another_type_becomes_black(kind):
    assert not to_gray(np.full((4, 5), 7, kind)).any()


def test_equalising_spreads_the_grey_levels():
    dull = np.clip(data.coins() // 8 + 100, 0, 255).astype(np.uint8)
    gray = trace_edges(dull, EdgeParams(equalise=True)).gray
    assert gray.dtype == np.uint8 and gray.min() == 0 and gray.max() == 255


@settings(max_examples=30, deadline=None)
@given(arrays(np.uint8, st.tuples(st.integers(1, 12), st.integers(1, 12))))
def test_edges_are_maxima_above_the_low_threshold_and_off_the_border(image):
    trace = trace_edges(image)
    assert (np.hypot(trace.dx, trace.dy)[trace.edges] > trace.low).all()
    inner = np.zeros(image.shape, bool)
    inner[1:-1, 1:-1] = True
    assert not trace.edges[~inner].any()


@pytest.mark.parametrize("kind", ["fraction", "gradient", "auto"])
def test_a_high_threshold_below_the_low_one_is_refused(kind):
    with pytest.raises(ParameterError, match=f"high_{kind}: expected at least low_{kind} = 0.6"):
        EdgeParams(**{f"low_{kind}": 0.6, f"high_{kind}": 0.5})


@pytest.mark.parametrize(
    "image",
    [[[1, 2], [3, 4]], np.zeros((0, 5), np.uint8), np.zeros((5, 5, 2), np.uint8),
     np.zeros((4, 4), np.int32), np.full((4, 4), np.nan)],
    ids=["list", "empty", "two channels", "int32", "nan"],
)  # fmt: skip
def test_what_is_no_image_is_refused(image):
    with pytest.raises(ImageError, match="image: expected"):
        trace_edges(image)


def test_params_of_another_class_are_refused():
    with pytest.raises(ParameterError, match="EdgeParams"):
        trace_edges(np.zeros((4, 4), np.uint8), {"sigma": 1.0})


def test_a_grey_image_stored_in_three_channels_has_the_same_contours():
    gray = np.random.default_rng(3).integers(0, 256, (60, 80), dtype=np.uint8)
    plain = extract_contours(gray)
    triple = extract_contours(np.repeat(gray[:, :, None], 3, axis=2))
    np.testing.assert_array_equal(plain.points, triple.points)
    np.testing.assert_array_equal(plain.subpixel, triple.subpixel)


def test_a_colour_edge_of_equal_grey_is_found_by_the_strongest_channel_only():
    image = np.zeros((60, 80, 3), np.uint8)
    image[:, :40] = 105, 100, 90  # blue, green, red: a belt
    image[:, 40:] = 20, 90, 141  # a fruit of the same luma, 97.6 and 97.3
    assert len(extract_contours(image, EdgeParams(colour="gray", threshold_rule="absolute"))) == 0
    (edge,) = extract_contours(image, EdgeParams(threshold_rule="absolute"))
    assert set(edge[:, 0]) <= {39.0, 40.0}
    assert len(edge) >= 50


@pytest.mark.parametrize("deviation", [2.0, 10.0, 30.0])
def test_the_noise_of_pixels_is_measured_beside_edges_and_shading(deviation):
    y, x = np.mgrid[:300, :400]
    scene = 60.0 + 0.2 * x + 60.0 * (np.hypot(x - 200, y - 150) < 90)
    noisy = scene + np.random.default_rng(3).normal(0, deviation, scene.shape)
    assert pixel_noise(noisy) == pytest.approx(deviation, rel=0.03)
    assert pixel_noise(scene) < 0.01


def noisy_disc(deviation: float) -> np.ndarray:
    image = disc_image(160, 120, centre=(80.0, 60.0), radius=40.0, inside=150, outside=90)
    noise = np.random.default_rng(5).normal(0, deviation, image.shape)
    return np.clip(image + noise, 0, 255).astype(np.uint8)


def assert_same(one, other):
    """Compare two gradients to the bit."""
    for name in ("dx", "dy", "magnitude"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert one.blur == other.blur


def test_an_image_without_noise_keeps_its_blur_to_the_bit():
    for image in (noisy_disc(0.0), data.coins(), data.astronaut()):
        assert_same(gradient(image, EdgeParams().sigma), steady_gradient(image, EdgeParams()))


def test_the_blur_grows_in_noise_up_to_its_limit():
    image = noisy_disc(16.0)
    assert_same(gradient(image, 1.2), steady_gradient(image, EdgeParams()))
    plain = gradient(image, EdgeParams().sigma)
    assert_same(plain, steady_gradient(image, EdgeParams(noise_sigma=0.0)))
    assert extract_contours(image).blur == 1.2
    assert extract_contours(noisy_disc(30.0)).blur > 1.2  # noise drowns the edges
    assert extract_contours(noisy_disc(0.0)).blur == EdgeParams().sigma


@pytest.mark.parametrize("turn", [np.rot90, np.fliplr, np.transpose])
def test_the_blurred_edges_of_a_noisy_image_turn_with_it(turn):
    image = noisy_disc(12.0)
    before, after = trace_edges(image), trace_edges(turn(image))
    np.testing.assert_array_equal(turn(before.edges), after.edges)
