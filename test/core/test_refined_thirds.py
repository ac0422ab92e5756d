"""What parts of the support of an ellipse say about the others."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.ecc.refined import _kernels_thirds as thirds
from geoprim_core.ecc.refined._kernels_support import Supported

TURNS = (
    np.array([[0.0, -1.0], [1.0, 0.0]]),
    np.array([[-1.0, 0.0], [0.0, 1.0]]),
    np.array([[0.0, 1.0], [1.0, 0.0]]),
)


def arc(row, start, end, count=90):
    t = np.linspace(start, end, count)
    x, y = row[2] * np.cos(t), row[3] * np.sin(t)
    cos, sin = np.cos(row[4]), np.sin(row[4])
    return np.stack([row[0] + x * cos - y * sin, row[1] + x * sin + y * cos], axis=1)


def error(points, row):
    return thirds.prediction_error(points, np.arange(len(points)), np.asarray(row, float))


@settings(max_examples=60, deadline=None)
@given(st.floats(20, 90), st.floats(0.3, 1), st.floats(0, 3.1), st.floats(2.5, 6.2))
def test_an_exact_arc_predicts_its_own_thirds(a, ratio, angle, end):
    row = np.array([100.0, 90.0, a, a * ratio, angle])
    assert error(arc(row, 0.0, end), row) < 1e-6


def test_noise_of_the_edges_is_no_contradiction():
    row = np.array([100.0, 90.0, 60.0, 40.0, 0.5])
    points = arc(row, 0.0, 4.2, 250)
    noise = np.random.default_rng(2).normal(0, 0.3, points.shape)
    assert error(points + noise, row) < 1.0


def test_stretches_of_different_circles_contradict_each_other():
    upper = arc(np.array([100.0, 100.0, 50.0, 50.0, 0.0]), 3.4, 6.0)
    lower = arc(np.array([100.0, 112.0, 62.0, 50.0, 0.0]), 0.6, 1.2)
    fitted = np.array([100.0, 106.0, 56.0, 55.0, 0.0])
    assert error(np.concatenate([upper, lower]), fitted) > 2.0


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(31, 33))
def test_the_error_does_not_depend_on_how_the_image_is_turned(seed, count):
    row = np.array([0.0, 0.0, 60.0, 40.0, 0.4])
    points = arc(row, 0.3, 4.4, count)
    points += np.random.default_rng(seed).normal(0, 0.4, points.shape)
    first = error(points, row)
    for turn in TURNS:
        axis = turn @ [np.cos(row[4]), np.sin(row[4])]
        moved = np.array([0.0, 0.0, 60.0, 40.0, np.arctan2(axis[1], axis[0])])
        assert error(points @ turn.T, moved) == pytest.approx(first, rel=1e-6)


def test_evidence_falls_with_the_rest_that_is_extrapolated():
    upper = arc(np.array([100.0, 100.0, 50.0, 50.0, 0.0]), 3.4, 6.0)
    lower = arc(np.array([100.0, 112.0, 62.0, 50.0, 0.0]), 0.6, 1.2)
    points = np.concatenate([upper, lower])
    ellipses = np.array([[100.0, 106.0, 56.0, 55.0, 0.0]] * 4)
    figures = np.zeros((4, 8))
    figures[:, 0] = 3.0, 3.0, 3.0, -3.0
    figures[:, 1:3] = np.array([[0.4], [0.8], [1.0], [0.4]])
    members = np.tile(np.arange(len(points)), 4)
    offsets = np.arange(5) * len(points)
    found = Supported(ellipses, figures, offsets, members)
    told = thirds.doubt_predictions(points, found, 0.005, 8.0, 0.0)[:, 0]
    assert told[0] < told[1] < told[2] == 3.0
    assert told[3] == -3.0
