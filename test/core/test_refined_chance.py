"""Evidence counts less where most arcs are on no ellipse, and more in noise where most are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from geoprim_core.ecc.refined import trace_refined
from geoprim_core.ecc.refined.candidates import (
    EXPLAINED_SHARE,
    LONG,
    SOUND,
    USUAL_SHARE,
    allow_for_chance,
)
from geoprim_core.ecc.refined.params import RefinedParams
from geoprim_core.edges import extract_contours
from geoprim_core.synthetic import render_ellipses, thesis_image
from geoprim_core.types import Ellipses

FLAT = Ellipses.from_array([[60, 50, 40, 15, 0.3]])
ROUND = Ellipses.from_array([[60, 50, 30, 28, 0.3]])


def lost(ellipses, explained, params=None, noisy=False, **changes):
    """Return the evidence that whole ellipses lose when a share of the arcs is explained."""
    picture = render_ellipses(ellipses, (130, 100))
    trace = trace_refined(extract_contours(picture))
    edges = replace(trace.edges, **changes, **({"spread": 100.0} if noisy else {}))
    points = np.zeros(len(trace.edges.points), bool)
    on_arcs = trace.arcs.indices
    points[on_arcs[: round(explained * len(on_arcs))]] = True
    settings = params or RefinedParams()
    after = allow_for_chance(edges, trace.arcs, trace.verified, points, settings)
    return trace.verified.figures[:, 0] - after.figures[:, 0]


@pytest.mark.parametrize("explained", [0.0, 0.25, 0.5])
def test_evidence_falls_in_proportion_to_the_unexplained_arcs(explained):
    expected = 2.0 * (1.0 - explained - USUAL_SHARE)
    assert lost(FLAT, explained, RefinedParams(chance_weight=2.0)) == pytest.approx(
        expected, abs=0.02
    )


@pytest.mark.parametrize("explained", [1.0 - USUAL_SHARE + 0.01, 1.0])
def test_nothing_is_lost_where_most_arcs_are_explained(explained):
    assert not lost(FLAT, explained).any()


def test_what_is_whole_and_round_loses_nothing_but_in_noise():
    assert not lost(ROUND, 0.0).any()
    assert lost(ROUND, 0.0, noisy=True) == pytest.approx(lost(FLAT, 0.0)[0])


def test_no_weight_changes_nothing():
    assert not lost(FLAT, 0.0, RefinedParams(chance_weight=0.0)).any()


def test_the_shift_is_the_same_for_all_that_is_made_of_pieces():
    picture = thesis_image(8, 7).image
    trace = trace_refined(extract_contours(picture))
    figures = trace.verified.figures.copy()
    figures[:, 1] = SOUND[0]
    pieces = trace.verified.weighed(figures)
    none = np.zeros(len(trace.edges.points), bool)
    after = allow_for_chance(trace.edges, trace.arcs, pieces, none, RefinedParams())
    shift = figures[:, 0] - after.figures[:, 0]
    assert shift == pytest.approx(RefinedParams().chance_weight * (1.0 - USUAL_SHARE))
    assert (after.figures[:, 1:] == figures[:, 1:]).all()


@pytest.mark.parametrize("explained", [1.0, 0.8, 0.6])
def test_a_long_outline_in_noise_gains_in_proportion_to_the_explained_arcs(explained):
    weight = 3.0
    params = RefinedParams(chance_weight=0.0, explained_weight=weight)
    expected = weight * (1.0 - (1.0 - explained) / EXPLAINED_SHARE)
    assert -lost(FLAT, explained, params, noisy=True) == pytest.approx(expected, abs=0.1)


def test_nothing_is_gained_without_noise_nor_where_half_of_the_arcs_are_on_no_ellipse():
    params = RefinedParams(chance_weight=0.0)
    assert not lost(FLAT, 1.0, params).any()
    assert not lost(FLAT, 1.0 - EXPLAINED_SHARE - 0.02, params, noisy=True).any()


def test_blur_hides_parts_of_outlines_but_not_of_drawn_lines():
    params = RefinedParams(chance_weight=0.0)
    in_noise = -lost(FLAT, 1.0, params, noisy=True)[0]
    assert 0.0 < -lost(FLAT, 1.0, params, softness=2.0)[0] < in_noise
    assert not lost(FLAT, 1.0, params, softness=2.0, signed=False).any()
    assert not lost(FLAT, 1.0, params, softness=1.1).any()


def test_a_short_outline_in_noise_gains_nothing():
    small = Ellipses.from_array([[60, 50, 0.14 * LONG[0], 0.12 * LONG[0], 0.3]])
    assert not lost(small, 1.0, noisy=True).any()
