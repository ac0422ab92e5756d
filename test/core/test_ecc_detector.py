"""The detector from image to ellipses, in all its schemes."""

from __future__ import annotations

import numpy as np
import pytest

from geoprim_core.ecc import (
    TABLE,
    DetectorParams,
    detect_ellipses,
    detect_from_contours,
    trace_detection,
)
from geoprim_core.ecc.params import SCHEMES, EccParams
from geoprim_core.edges import extract_contours
from geoprim_core.errors import ImageError, ParameterError
from geoprim_core.fitting import overlap_matrix
from geoprim_core.polygon import approximate
from geoprim_core.synthetic import ellipse_image, render_ellipses, thesis_image
from geoprim_core.types import Ellipse, Ellipses

THESIS = ("1", "2", "3")
COLUMNS = ("score", "coverage", "alignment", "continuity")


@pytest.mark.parametrize("scheme", THESIS)
@pytest.mark.parametrize(
    "truth",
    [
        Ellipse(80.3, 61.7, 40.0, 40.0, 0.0),
        Ellipse(90.0, 70.5, 60.0, 30.0, 0.5),
        Ellipse(70.2, 70.0, 55.0, 35.0, 2.4),
        Ellipse(80.0, 60.0, 14.0, 12.0, 1.0),
    ],
)
def test_one_ellipse_is_found_within_half_a_pixel(scheme, truth):
    found = detect_ellipses(ellipse_image(180, 140, truth), DetectorParams.for_scheme(scheme))
    assert len(found) == 1
    row, wanted = found.ellipses.array()[0], np.array([*(getattr(truth, n) for n in NAMES)])
    assert np.abs(row - wanted)[:4].max() < 0.5
    if truth.semi_major > truth.semi_minor:
        turn = (row[4] - wanted[4] + np.pi / 2) % np.pi - np.pi / 2
        assert abs(turn) * (truth.semi_major - truth.semi_minor) < 0.5
    assert found.alignment[0] == 1
    assert np.isnan(found.covariance).all()
    assert found.image_size == (180, 140)


NAMES = ("x", "y", "semi_major", "semi_minor", "angle")
DISCS = Ellipses.from_array(
    [[70, 70, 50, 40, 0.4], [130, 90, 45, 40, 1.5], [60, 150, 40, 30, 2.5], [190, 160, 35, 35, 0]]
)


def busy_image():
    rng = np.random.default_rng(7)
    clean = render_ellipses(DISCS, (260, 220), levels=np.array([120.0, 220.0, 170.0, 200.0]))
    return np.clip(clean + rng.normal(0, 8, clean.shape), 0, 255).astype(np.uint8)


@pytest.mark.parametrize("scheme", THESIS)
def test_two_runs_give_the_same_bytes(scheme):
    first, second = (
        detect_ellipses(busy_image(), DetectorParams.for_scheme(scheme)) for _ in range(2)
    )
    assert first.ellipses.array().tobytes() == second.ellipses.array().tobytes()
    for name in COLUMNS:
        assert getattr(first, name).tobytes() == getattr(second, name).tobytes()


@pytest.mark.parametrize("scheme", THESIS)
def test_every_distinct_disc_of_a_noisy_pile_has_a_hypothesis(scheme):
    trace = trace_detection(busy_image(), DetectorParams.for_scheme(scheme))
    overlap = overlap_matrix(DISCS, Ellipses.from_array(trace.ecc.distinct.ellipses))
    assert (overlap.max(axis=1) > 0.9).all()
    assert trace.ecc.selected.sum() == len(trace.detections) >= 1
    assert (np.diff(trace.detections.score) <= 0).all()


def test_schemes_are_more_and_more_selective():
    """Thesis 5.4.4 and 5.6.3.4: the score leaves fewer bins, region and convexity fewer pairs."""
    image = thesis_image(8, 0, kind="overlapping").image
    traces = {s: trace_detection(image, DetectorParams.for_scheme(s)).ecc for s in THESIS}
    bins = {s: traces[s].votes.strong_bins(0.01).sum() for s in THESIS}
    assert bins["1"] > bins["2"] == bins["3"]
    assert traces["1"].eligible is None
    assert traces["2"].eligible is None
    three = traces["3"]
    assert three.inside.sum() > three.eligible.sum() > 0
    assert not (three.eligible & ~three.inside).any()


@pytest.mark.parametrize("scheme", SCHEMES)
def test_detections_come_from_contours_and_polygons_alone(scheme):
    params = DetectorParams.for_scheme(scheme)
    image = busy_image()
    contours = extract_contours(image, params.edges)
    polygons = approximate(contours, params=params.polygon.rdp_mod)
    found = detect_from_contours(contours, polygons, params.ecc)
    whole = detect_ellipses(image, params)
    assert np.array_equal(found.ellipses.array(), whole.ellipses.array())
    assert np.array_equal(
        whole.ellipses.array(), trace_detection(image, params).detections.ellipses.array()
    )


@pytest.mark.parametrize("scheme", THESIS)
@pytest.mark.parametrize("kind", ["black", "white", "pixel", "line", "noise"])
def test_images_without_ellipses_do_no_harm(scheme, kind):
    rng = np.random.default_rng(1)
    image = {
        "black": np.zeros((60, 80), np.uint8),
        "white": np.full((60, 80, 3), 255, np.uint8),
        "pixel": np.zeros((1, 1), np.uint8),
        "line": np.uint8(200) * np.eye(70, dtype=np.uint8),
        "noise": rng.integers(0, 256, (120, 160)).astype(np.uint8),
    }[kind]
    found = detect_ellipses(image, DetectorParams.for_scheme(scheme))
    assert ((found.score >= 0) & (found.score <= 1)).all()
    if kind != "noise":
        assert len(found) == 0


def test_the_cap_on_arcs_keeps_the_longest():
    params = DetectorParams.for_scheme("3").updated({"ecc.grouping.max_arcs": 3})
    whole = trace_detection(busy_image(), DetectorParams.for_scheme("3"))
    kept = trace_detection(busy_image(), params)
    assert sorted(np.diff(kept.ecc.arcs.offsets)) == sorted(np.diff(whole.ecc.arcs.offsets))[-3:]
    assert whole.detections.complete
    assert not kept.detections.complete
    count = len(whole.ecc.arcs)
    expected = f"max_arcs = 3: the {count - 3} shortest of {count} arcs were left out"
    assert kept.detections.reason == expected


def test_settings_of_the_schemes():
    assert tuple(row.name for row in TABLE) == SCHEMES
    for name in THESIS:
        params = DetectorParams.for_scheme(name)
        edges = params.edges
        assert (params.ecc.scheme, edges.linking, edges.subpixel) == (name, "junctions", False)
        assert (edges.sigma, edges.low_fraction, edges.high_fraction) == (1.0, 0.1, 0.2)
    assert DetectorParams.for_scheme("refined").to_dict() == DetectorParams().to_dict()
    with pytest.raises(ParameterError, match="scheme: expected one of refined, 1, 2, 3"):
        DetectorParams.for_scheme("4")


def test_wrong_input_is_refused():
    with pytest.raises(ImageError, match="image"):
        detect_ellipses(np.zeros((0, 5), np.uint8))
    with pytest.raises(ParameterError, match="a DetectorParams or None"):
        detect_ellipses(np.zeros((9, 9), np.uint8), EccParams())
