"""Truths about the kernels of the edge stage: each does what a plain slow way does."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from skimage import data
from skimage.measure import label

from geoprim_core.edges import EdgeParams, _kernels, _kernels_linking, _kernels_pixels, trace_edges
from geoprim_core.edges.canny import find_edges, gaussian_weights, gradient, steady_gradient
from geoprim_core.edges.linking import locate_pixels

SHAPES = st.tuples(st.integers(1, 9), st.integers(1, 9))


def plain_gradient(channel: np.ndarray, sigma: float) -> tuple[np.ndarray, np.ndarray]:
    """Blur and Sobel as sums of shifted whole images, the border repeated before each."""

    def along(image, weights, axis):
        reach = len(weights) // 2
        pad = [(reach, reach) if k == axis else (0, 0) for k in (0, 1)]
        wide = np.pad(image, pad, mode="edge")
        size = image.shape[axis]
        return sum(w * np.take(wide, range(t, t + size), axis) for t, w in enumerate(weights))

    weights = gaussian_weights(sigma).astype(np.float64)
    smooth = along(along(channel.astype(np.float64), weights, 1), weights, 0)
    dx = along(along(smooth, [-1, 0, 1], 1), [1, 2, 1], 0)
    dy = along(along(smooth, [1, 2, 1], 1), [-1, 0, 1], 0)
    return dx / (8 * 128**2), dy / (8 * 128**2)


@settings(max_examples=60, deadline=None)
@given(arrays(np.uint8, SHAPES), st.sampled_from([0.0, 0.5, 0.7, 1.3, 3.0]))
def test_the_gradient_of_an_8_bit_image_is_exact(image, sigma):
    found = gradient(image, sigma)
    values = found.magnitude
    expected = plain_gradient(image, sigma)
    np.testing.assert_array_equal((found.dx, found.dy), expected)
    np.testing.assert_allclose(values, np.hypot(*expected), rtol=1e-6)
    assert found.largest == values.max()
    assert found.typical * values.sum(dtype=float) == pytest.approx(
        (values.astype(float) ** 2).sum(), 5e-4
    )


@settings(max_examples=40, deadline=None)
@given(SHAPES, st.sampled_from([3, 4]), st.integers(0, 99))
def test_the_gradient_of_colours_is_that_of_the_strongest_channel(shape, channels, seed):
    image = np.random.default_rng(seed).integers(0, 256, (*shape, channels), dtype=np.uint8)
    found = gradient(image, 0.7)
    dx, dy = found.dx, found.dy
    each = np.array([plain_gradient(image[:, :, c], 0.7) for c in range(3)])
    strongest = (each**2).sum(axis=1).max(axis=0)
    np.testing.assert_allclose(dx**2 + dy**2, strongest, rtol=1e-6)
    from_one = ((each == np.array([dx, dy])).all(axis=1)).any(axis=0)
    assert from_one.all()


def test_the_gradient_of_a_float_image_is_that_of_the_same_bytes():
    image = data.coins()
    octets, levels = gradient(image, 1.0), gradient(image.astype(np.float32), 1.0)
    for name in ("dx", "dy", "magnitude", "largest", "typical"):
        np.testing.assert_array_equal(getattr(octets, name), getattr(levels, name))


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 9999), st.floats(0.0, 1.5))
def test_the_median_is_given_where_it_matters(seed, share):
    """The short cut answers 0 only where the middle of the median's bin is below the limit."""
    values = np.random.default_rng(seed).rayleigh(3.0, (17, 23)).astype(np.float32)
    largest = float(values.max())
    full = _kernels.median_magnitude(values, largest, 0.0)
    assert full == pytest.approx(np.median(values), rel=5e-3)
    short = _kernels.median_magnitude(values, largest, share * full)
    assert short == full or (short == 0.0 and full <= share * full)


@settings(max_examples=60, deadline=None)
@given(arrays(np.uint8, st.tuples(st.integers(3, 30), st.integers(3, 30)),
              elements=st.sampled_from([0, 0, 1, 1, 1, 2])))  # fmt: skip
def test_hysteresis_keeps_the_regions_that_hold_a_strong_peak(state):
    state[[0, -1]] = 0
    state[:, [0, -1]] = 0
    regions = label(state > 0, connectivity=2)
    kept = np.isin(regions, np.unique(regions[state == 2])) & (state > 0)
    peaks = np.flatnonzero(state).astype(np.uint32)
    edges = _kernels.hysteresis(state.copy(), peaks)
    np.testing.assert_array_equal(edges, np.flatnonzero(kept))


def test_hysteresis_follows_a_spiral_to_its_end():
    """Weak all the way, and against the order of the pixels half of the time."""
    state = np.zeros((63, 63), np.uint8)
    y, x, low, high = 1, 1, 1, 61
    while low < high:
        state[low, low : high + 1] = 1
        state[low : high + 1, high] = 1
        state[high, low : high + 1] = 1
        state[low + 2 : high + 1, low] = 1
        state[low + 2, low : low + 2] = 1
        low, high = low + 2, high - 2
    state[y, x] = 2
    regions = label(state > 0, connectivity=2)
    edges = _kernels.hysteresis(state, np.flatnonzero(state).astype(np.uint32))
    np.testing.assert_array_equal(edges, np.flatnonzero(regions == regions[1, 1]))
    assert len(edges) > 1000


@given(st.floats(-0.5, 0.5))
def test_offsets_are_rounded_to_the_nearest_step(value):
    assert _kernels_pixels.rounded(value) == np.rint(value * 256.0) / 256.0


@given(st.floats(-1.0, 1.0, width=32), st.floats(-1.0, 1.0, width=32))
def test_the_direction_is_the_angle_of_the_vector(x, y):
    if x == 0.0 and y == 0.0:
        return
    vector = np.float32(x), np.float32(y)
    angle = _kernels_pixels.direction(*vector)
    assert angle == pytest.approx(np.arctan2(y, x), abs=2e-11) or abs(angle) == np.pi
    # Mirrored at the axis, it is exactly the opposite one.
    if y != 0.0:
        assert _kernels_pixels.direction(vector[0], -vector[1]) == -angle


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 9999), st.integers(1, 40))
def test_chains_take_the_cheapest_open_step_first(seed, count):
    random = np.random.default_rng(seed)
    steps = 3 * count
    source, target = random.integers(0, count, (2, steps)).astype(np.uint32)
    cost = np.append(random.integers(1, 9, steps), np.inf).astype(np.float32)  # with ties
    cosine = random.choice(np.float32([0.5, 0.9]), steps)
    double = random.random(count) < 0.2
    limits = np.array([0.8, 0.1])
    before, after = _kernels_linking.chain(source, target, cost, cosine, double, limits)
    expected = {}
    for limit in limits:
        for p in np.argsort(cost[:-1], kind="stable"):
            here, there = int(source[p]), int(target[p])
            taken = here in expected or there in expected.values()
            if cosine[p] >= limit and not (taken or double[here] or double[there]):
                expected[here] = there
    linked = np.flatnonzero(after < _kernels_linking.APART)
    assert {int(k): int(after[k]) for k in linked} == expected
    reached = np.flatnonzero(before < _kernels_linking.APART)
    assert {int(before[m]): int(m) for m in reached} == expected


def test_every_link_stays_within_reach_and_turns_little():
    image = data.camera()
    params = EdgeParams(reach=1.5)
    edges = find_edges(steady_gradient(image, params), params)
    pixels = locate_pixels(edges.flat, edges.gradient.dx, edges.gradient.dy)
    source, target, cost, cosine, double = _kernels_linking.find_steps(
        pixels.x, pixels.y, pixels.index, pixels.table, 0.9, params.reach, 0.7
    )
    assert len(source) > 10_000 and double.any() and cost[-1] == np.inf
    away = np.hypot(pixels.x[target] - pixels.x[source], pixels.y[target] - pixels.y[source])
    assert away.max() <= params.reach
    normals = pixels.table[:, 2:]
    np.testing.assert_allclose((normals[source] * normals[target]).sum(axis=1), cosine, atol=1e-6)
    assert cosine.min() >= 0.9


def test_edge_pixels_come_in_raster_order_with_their_place_in_the_index():
    trace = trace_edges(data.coins())
    flat = np.flatnonzero(trace.edges).astype(np.uint32)
    pixels = locate_pixels(flat, trace.dx, trace.dy)
    height, width = trace.edges.shape
    np.testing.assert_array_equal(pixels.y * width + pixels.x, flat)
    np.testing.assert_array_equal(pixels.index[pixels.y, pixels.x], np.arange(len(flat)))
    assert (pixels.index != _kernels_pixels.NONE).sum() == len(flat)
    assert pixels.image_size == (width, height)
