"""Metrics of polygons: worked examples, definitions, pooling, and the optimum as the measure."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError
from geoprim_core.evaluation.polygon import (
    RelativeMetrics,
    image_metrics,
    mean_relative,
    measure_image,
    measure_polygon,
    relative_metrics,
    set_metrics,
)
from geoprim_core.polygon import OptimalParams, approximate, optimal, rdp_mod
from geoprim_core.types import Contours, Polygons

STEPS = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])


def test_a_tent_worked_by_hand():
    tent = [(0, 0), (1, 1), (2, 2), (3, 1), (4, 0)]
    m = measure_polygon(tent, [0, 4])
    assert (m.pixels, m.vertices, m.max_deviation, m.ise) == (5, 2, 2.0, 6.0)
    assert m.precision == pytest.approx(np.sqrt(6 / 5))
    assert m.reliability == pytest.approx(4 / 4)
    assert m.compression_ratio == 2.5 and m.reduction_ratio == 0.4
    assert m.figure_of_merit == pytest.approx(2.5 / 6) and m.weighted_error == pytest.approx(2.4)


def test_the_two_meanings_of_s_max_differ_where_the_curve_turns_back():
    hook = [(0, 0), (1, 1), (0, 2), (-1, 3), (-2, 2), (-3, 1)]
    text = measure_polygon(hook, [0, 5])
    tables = measure_polygon(hook, [0, 5], span="first_pixel")
    assert text.span_sum == pytest.approx(np.hypot(4, 0))
    assert tables.span_sum == pytest.approx(np.sqrt(10))
    assert text.deviation_sum == tables.deviation_sum
    assert text.reliability < tables.reliability


def test_a_polygon_through_all_pixels_is_perfect():
    curve = STEPS[[0, 1, 0, 2, 3]].cumsum(axis=0)
    m = measure_polygon(curve, np.arange(5))
    assert (m.max_deviation, m.ise, m.precision, m.reliability) == (0, 0, 0, 0)
    assert m.figure_of_merit == np.inf and m.weighted_error == 0


@given(codes=st.lists(st.integers(0, 7), min_size=3, max_size=40), closed=st.booleans())
@settings(max_examples=60, deadline=None)
def test_metrics_obey_their_definitions(codes, closed):
    curve = np.vstack([np.zeros((1, 2)), STEPS[codes].cumsum(axis=0)])
    m = measure_polygon(curve, rdp_mod(curve, closed=closed), closed=closed)
    assert m.max_deviation**2 <= m.ise + 1e-9 <= len(curve) * m.max_deviation**2 + 1e-8
    assert m.precision <= m.max_deviation + 1e-12
    assert m.compression_ratio * m.reduction_ratio == pytest.approx(1.0)
    moved = measure_polygon(3 * curve + 7, rdp_mod(curve, closed=closed), closed=closed)
    assert moved.ise == pytest.approx(9 * m.ise) and moved.reliability == (
        pytest.approx(m.reliability)
    )


def test_images_take_the_worst_precision_and_sets_the_mean():
    tent = measure_polygon([(0, 0), (1, 1), (2, 0)], [0, 2])
    line = measure_polygon([(0, 0), (1, 0), (2, 0)], [0, 2])
    image = image_metrics([tent, line])
    assert image.precision == tent.precision and image.ise == 0.5
    assert image.reliability == pytest.approx(1 / 4)
    assert image.figure_of_merit == tent.figure_of_merit  # that of the line is infinite
    both = set_metrics([image, image_metrics([line])])
    assert both.precision == pytest.approx(tent.precision / 2)
    assert both.compression_ratio == pytest.approx(1.5)


def test_an_image_is_measured_curve_by_curve():
    curves = [STEPS[[0, 0, 1, 2, 2, 2]].cumsum(axis=0), STEPS[[4, 5, 4, 5, 6, 7]].cumsum(axis=0)]
    contours = Contours(np.concatenate(curves), [0, 6, 6, 12], [False, False, False])
    polygons = approximate(contours)
    alone = [measure_polygon(c, rdp_mod(c)) for c in curves]
    assert measure_image(contours, polygons) == image_metrics(alone)


def test_only_the_optimum_has_merit_one():
    t = np.linspace(0, 2 * np.pi, 900, endpoint=False)
    curve = np.rint(np.stack([20 * np.cos(t), 12 * np.sin(t) + 3 * np.sin(3 * t)], axis=1))
    curve = curve[(curve != np.roll(curve, 1, axis=0)).any(axis=1)]
    best = optimal(curve, closed=True, params=OptimalParams(9, measure="ise"))
    assert relative_metrics(curve, best, closed=True).merit == pytest.approx(1.0)
    rival = relative_metrics(curve, rdp_mod(curve, closed=True), closed=True)
    assert rival.fidelity < 1 and rival.efficiency <= 1 and 0 < rival.merit < 1


def test_an_image_has_the_mean_merit_of_its_curves_and_a_set_that_of_its_images():
    image = mean_relative([RelativeMetrics(0.25, 1.0), RelativeMetrics(1.0, 1.0)])
    assert (image.count, image.fidelity, image.efficiency, image.merit) == (2, 0.625, 1.0, 0.75)
    lone = mean_relative([RelativeMetrics(0.25, 0.25)])
    assert mean_relative([image, lone]).merit == 0.5  # each image counts once


def test_wrong_arguments_are_named():
    with pytest.raises(InputError, match="indices"):
        measure_polygon([(0, 0), (1, 0), (2, 0)], [0, 1])
    with pytest.raises(InputError, match="span"):
        measure_polygon([(0, 0), (1, 0)], [0, 1], span="longest")
    with pytest.raises(InputError, match="at least one"):
        image_metrics([])
    with pytest.raises(InputError, match="at least one"):
        mean_relative([])
    with pytest.raises(InputError, match="polygons"):
        measure_image(Contours([(0, 0)], [0, 1], [False]), Polygons([], [0], []))
