"""Rough outlines: ellipses but for a few per cent, and what is none."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.ecc.refined import detect_refined, trace_refined
from geoprim_core.ecc.refined.params import RefinedParams
from geoprim_core.ecc.refined.rough import ROUGH_MAP
from geoprim_core.edges import extract_contours
from geoprim_core.fitting.overlap import overlap_matrix
from geoprim_core.io.explain import explain_detection
from geoprim_core.synthetic import render_ellipses, thesis_image
from geoprim_core.types import Ellipses

OFF = RefinedParams(rough_scatter=0.0)
SIZE = 300
CENTRE = (148.3, 151.6)


def plane():
    """Return x and y of every pixel about the centre."""
    y, x = np.mgrid[:SIZE, :SIZE].astype(float)
    return x - CENTRE[0], y - CENTRE[1]


def filled(outside, ground=200.0):
    """Return the picture of what is inside an outline, by the distance from it."""
    cover = np.clip(0.5 - outside, 0.0, 1.0)
    return np.clip(ground + (90.0 - ground) * cover, 0, 255).astype(np.uint8)


def picture(radius, *, ratio=1.0, ground=200.0):
    """Return a filled outline of radius(angle) pixels about the centre, squeezed along y."""
    x, y = plane()
    return filled(np.hypot(x, y / ratio) - radius(np.arctan2(y / ratio, x)), ground)


def dented(size, waves, share, phase=0.4):
    """Return the radius of a disc with so many dents, a share of its radius high."""
    return lambda angle: size * (1.0 + share * np.cos(waves * (angle - phase)))


def polygon(corners, size, rounding, phase):
    """Return the picture of a regular polygon about a circle, its corners rounded by a share."""
    x, y = plane()
    side = 2.0 * np.pi / corners
    aside = (np.arctan2(y, x) - phase) % side - 0.5 * side
    along, across = np.hypot(x, y) * np.cos(aside), np.hypot(x, y) * np.abs(np.sin(aside))
    flat = (1.0 - rounding) * size  # distance of the sides of the polygon that is then widened
    beyond = np.maximum(across - flat * np.tan(0.5 * side), 0.0)
    outside = np.where(along > flat, np.hypot(along - flat, beyond), along - flat)
    return filled(outside - rounding * size)


def detect(image, params=None):
    """Return the ellipses of an image and how many came from rough outlines."""
    trace = trace_refined(extract_contours(image), None, params)
    chosen = trace.selection.chosen
    return trace.detections, int(np.count_nonzero(trace.verified.source[chosen] < 0))


def same(first, second):
    """Tell whether two detections are the same to the last bit."""
    pairs = [
        (first.ellipses.array(), second.ellipses.array()),
        (first.score, second.score),
        (first.covariance, second.covariance),
    ]
    return all(a.tobytes() == b.tobytes() for a, b in pairs)


@settings(deadline=None, max_examples=15)
@given(
    waves=st.integers(3, 5),
    share=st.floats(0.025, 0.031),
    size=st.floats(70.0, 120.0),
    phase=st.floats(0.0, 2.0),
)
def test_a_disc_with_dents_of_three_per_cent_is_found(waves, share, size, phase):
    found, rough = detect(picture(dented(size, waves, share, phase)))
    truth = Ellipses.from_array([[*CENTRE, size, size, 0.0]])
    assert (len(found), rough) == (1, 1)
    assert overlap_matrix(found.ellipses, truth)[0, 0] >= 0.9
    assert detect(picture(dented(size, waves, share, phase)), OFF)[1] == 0


@pytest.mark.parametrize("ratio", [0.6, 0.8])
def test_a_dented_ellipse_is_found(ratio):
    found, rough = detect(picture(dented(110.0, 5, 0.025), ratio=ratio))
    truth = Ellipses.from_array([[*CENTRE, 110.0, 110.0 * ratio, 0.0]])
    assert rough == 1
    assert overlap_matrix(found.ellipses, truth).max() >= 0.9


@pytest.mark.parametrize("phase", [0.0, 0.3, 0.8])
@pytest.mark.parametrize("corners", [3, 4, 5, 6])
@pytest.mark.parametrize("rounding", [0.0, 0.2, 0.4])
def test_polygons_are_none(corners, rounding, phase):
    found, rough = detect(polygon(corners, 80.0, rounding, phase))
    assert (len(found), rough) == (0, 0)


@pytest.mark.parametrize("power", [3.0, 4.0, 6.0])
def test_rounded_squares_are_none(power):
    def radius(angle):
        cos, sin = np.abs(np.cos(angle - 0.2)), np.abs(np.sin(angle - 0.2))
        return 80.0 * (cos**power + sin**power) ** (-1.0 / power)

    assert detect(picture(radius))[1] == 0


def test_an_outline_with_one_wide_gap_is_none():
    whole = dented(90.0, 5, 0.025)
    assert detect(picture(whole))[1] == 1
    assert detect(picture(lambda a: np.where(np.abs(a) < 0.9, 60.0, whole(a))))[1] == 0


def test_an_outline_of_two_polarities_is_none():
    shape = dented(90.0, 5, 0.025)
    ground = np.where(np.arange(SIZE) < 0.5 * SIZE, 20.0, 200.0)
    assert detect(picture(shape, ground=ground))[1] == 0


@pytest.mark.parametrize("seed", range(3))
def test_pictures_of_ellipses_gain_nothing(seed):
    for kind in ("occluded", "overlapping"):
        contours = extract_contours(thesis_image(12, seed, kind=kind).image)
        assert same(detect_refined(contours), detect_refined(contours, None, OFF))


def test_what_is_found_without_stays_as_it_is():
    exact = Ellipses.from_array([[60.0, 70.0, 40.0, 25.0, 0.5], [200.0, 80.0, 30.0, 30.0, 0.0]])
    both = np.concatenate((render_ellipses(exact, (SIZE, 150)), picture(dented(90.0, 5, 0.028))))
    contours = extract_contours(both)
    without, found = detect_refined(contours, None, OFF), detect_refined(contours)
    rows = {row.tobytes() for row in found.ellipses.array()}
    assert (len(without), len(found)) == (2, 3)
    assert {row.tobytes() for row in without.ellipses.array()} < rows
    assert same(found, detect_refined(contours))


def test_its_score_and_covariance_say_that_it_is_rough():
    rough, _ = detect(picture(dented(90.0, 3, 0.028)))
    exact, _ = detect(picture(dented(90.0, 3, 0.0)))
    assert 0.8 <= rough.score[0] < exact.score[0]
    deviations = [np.sqrt(np.diag(found.covariance[0]))[:4] for found in (rough, exact)]
    assert (deviations[0] > 3.0 * deviations[1]).all()


def test_more_of_the_outline_explained_is_more_probable():
    assert np.all(np.diff(ROUGH_MAP.probability(np.linspace(-1.0, 1.0, 21))) > 0.0)


def test_it_is_explained():
    explained = explain_detection(picture(dented(90.0, 5, 0.028)))
    assert [h.reason for h in explained.hypotheses if h.coverage > 0.9][:1] == [""]
    assert len(explained.detections) == 1


def test_the_longest_parts_suffice():
    contours = extract_contours(picture(dented(90.0, 4, 0.028)))
    few = RefinedParams(max_rough_parts=4)
    assert len(detect_refined(contours, None, few)) == 1
    none = RefinedParams(min_rough=10_000)
    assert same(detect_refined(contours, None, none), detect_refined(contours, None, OFF))
