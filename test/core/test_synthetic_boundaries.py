"""Silhouettes, tracing, filling, scaling, Kanungo's noise and the curves by formula."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError
from geoprim_core.synthetic import (
    FORMULA_CURVES,
    SILHOUETTES,
    KanungoParams,
    degrade_curve,
    degrade_mask,
    fill_boundary,
    formula_curve,
    scaled_curve,
    silhouette,
    trace_boundary,
)


def largest_step(curve, closed=True):
    ahead = np.roll(curve, -1, axis=0) if closed else curve[1:]
    return np.abs(ahead - (curve if closed else curve[:-1])).max(axis=1)


@pytest.mark.parametrize("name", SILHOUETTES)
def test_silhouettes_are_closed_digital_curves_of_a_useful_length(name):
    border = silhouette(name)
    assert (largest_step(border) == 1).all()
    assert 200 <= len(border) <= 900
    assert len(np.unique(border, axis=0)) >= 0.99 * len(border)
    doubled = silhouette(name, scale=3.0)
    assert len(doubled) == pytest.approx(2 * len(border), rel=0.06)


@given(cells=st.lists(st.tuples(st.integers(1, 10), st.integers(1, 8)), min_size=1, max_size=50))
@settings(max_examples=100, deadline=None)
def test_the_border_encloses_exactly_the_largest_part(cells):
    from scipy import ndimage

    mask = np.zeros((10, 12), bool)
    for x, y in cells:
        mask[y, x] = True
    labels, _ = ndimage.label(mask, np.ones((3, 3)))
    border = trace_boundary(mask)
    pixels = border.astype(int)
    part = labels == labels[pixels[0, 1], pixels[0, 0]]
    assert part.sum() == max(np.bincount(labels.ravel())[1:])
    filled = np.zeros_like(mask)
    x, y = pixels.min(axis=0)
    around = fill_boundary(border, margin=1)[1:-1, 1:-1]
    filled[y : y + around.shape[0], x : x + around.shape[1]] = around
    assert np.array_equal(filled, ndimage.binary_fill_holes(part))
    assert len(border) == 1 or (largest_step(border) == 1).all()


def test_a_thin_line_is_walked_along_both_sides():
    mask = np.zeros((3, 7), bool)
    mask[1, 1:6] = True
    assert len(trace_boundary(mask)) == 8
    assert len(trace_boundary(np.zeros((4, 4)))) == 0


def test_flips_have_the_probabilities_of_the_model():
    mask = np.zeros((60, 4000), bool)
    mask[:30] = True
    params = KanungoParams(0.8, 0.3, 0.6, 0.5, 0.01, 0.02, closing=1)
    flipped = (degrade_mask(mask, 5, params) != mask).mean(axis=1)
    for distance in (1, 2, 3):
        fore = 0.8 * np.exp(-0.3 * distance**2) + 0.01
        back = 0.6 * np.exp(-0.5 * distance**2) + 0.02
        assert flipped[30 - distance] == pytest.approx(fore, abs=0.03)
        assert flipped[29 + distance] == pytest.approx(back, abs=0.03)
    assert flipped[5] == pytest.approx(0.01, abs=0.01)


def test_a_closing_only_adds_and_fills_single_holes():
    mask = np.ones((9, 9), bool)
    mask[4, 4] = False
    silent = KanungoParams(alpha_0=0.0, beta_0=0.0)
    assert degrade_mask(mask, 0, silent).all()
    rough = KanungoParams(closing=1)
    assert (degrade_mask(mask, 3, KanungoParams()) >= degrade_mask(mask, 3, rough)).all()


def test_noise_is_repeatable_and_stays_near_the_curve():
    border = silhouette("rabbit")
    noisy = degrade_curve(border, seed=4)
    assert np.array_equal(noisy, degrade_curve(border, seed=4))
    assert not np.array_equal(noisy, degrade_curve(border, seed=5))
    far = np.abs(noisy[:, None] - border[None]).max(axis=2).min(axis=1)
    assert 1 <= far.max() <= 3
    assert (largest_step(noisy) == 1).all()


@pytest.mark.parametrize("divisor", [2, 3, 4, 5])
def test_a_scaled_curve_stays_connected_and_shrinks_in_proportion(divisor):
    border = silhouette("fish")
    small = scaled_curve(border, divisor)
    assert (largest_step(small) == 1).all()
    assert np.ptp(small, axis=0) == pytest.approx(np.ptp(border, axis=0) / divisor, abs=1)


@pytest.mark.parametrize("name", FORMULA_CURVES)
def test_the_kinds_of_a_formula_curve_are_one_curve(name):
    real, semi, digital = (formula_curve(name, k) for k in ("real", "semi_digital", "digital"))
    assert np.abs(semi - real).max() <= 0.5 and (semi[:, 0] == np.rint(semi[:, 0])).all()
    assert (largest_step(digital, closed=False) == 1).all()
    near = np.abs(real[:, None] - digital[None]).max(axis=2).min(axis=1)
    assert near.max() <= 0.5 + 1e-9


def test_formulas_give_what_the_thesis_prints():
    assert formula_curve("sinc")[4] == pytest.approx([5, 100 * np.sin(1.0)])
    # theta = 0: r = a, turned by theta_0 and shifted
    assert formula_curve("curve_2")[0] == pytest.approx([-70, 60])


def test_wrong_arguments_are_named():
    with pytest.raises(InputError, match="hammer"):
        silhouette("teapot")
    with pytest.raises(InputError, match="divisor"):
        scaled_curve([(0, 0)], 0.5)
    with pytest.raises(InputError, match="kind"):
        formula_curve("sinc", "rough")
    with pytest.raises(InputError, match="mask"):
        degrade_mask(np.zeros(4), 0)
