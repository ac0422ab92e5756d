"""The optimal polygon: never beaten, whatever the measure, the curve or the start."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import InputError, ParameterError
from geoprim_core.polygon import OptimalParams, optimal, rdp_mod

STEPS = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])
MEASURES = ("ise", "absolute", "max_deviation")


def errors(curve, indices, closed):
    """Return the three errors of a polygon, straight from their definition."""
    distances = []
    ends = list(itertools.pairwise(indices))
    if closed:
        ends.append((indices[-1], indices[0] + len(curve)))
    for i, j in ends:
        piece = curve[np.arange(i, j + 1) % len(curve)] - curve[i]
        length = np.hypot(*piece[-1])
        cross = piece[-1, 0] * piece[:, 1] - piece[-1, 1] * piece[:, 0]
        distances.append(np.abs(cross) / length if length > 0 else np.hypot(*piece.T))
    d = np.concatenate(distances)
    return {"ise": (d**2).sum(), "absolute": d.sum(), "max_deviation": d.max()}


def polygons(count, vertices, closed):
    if closed:
        return itertools.combinations(range(count), vertices)
    inner = itertools.combinations(range(1, count - 1), vertices - 2)
    return ((0, *chosen, count - 1) for chosen in inner)


@st.composite
def short_curves(draw):
    """Draw digital curves that may cross themselves, and curves of real-valued points.

    Their positions are multiples of a thousandth of a pixel: errors come from sums of squares,
    in which points much closer together than that are one.
    """
    if draw(st.booleans()):
        codes = draw(st.lists(st.integers(0, 7), min_size=2, max_size=7))
        return np.vstack([np.zeros((1, 2)), STEPS[codes].cumsum(axis=0)])
    count = draw(st.integers(3, 8))
    numbers = st.integers(-4096, 4096).map(lambda k: k / 1024)
    return np.array(draw(st.lists(st.tuples(numbers, numbers), min_size=count, max_size=count)))


@given(curve=short_curves(), closed=st.booleans(), measure=st.sampled_from(MEASURES))
@settings(max_examples=80, deadline=None)
def test_no_polygon_of_n_vertices_is_better(curve, closed, measure):
    least = np.inf
    for vertices in range(2, len(curve) + 1):
        found = optimal(curve, closed=closed, params=OptimalParams(vertices, measure=measure))
        best = min(
            errors(curve, p, closed)[measure] for p in polygons(len(curve), vertices, closed)
        )
        least = min(least, best)
        reached = errors(curve, found, closed)[measure]
        if measure == "max_deviation":  # at most so many vertices
            assert len(found) <= vertices and reached <= least + 1e-6
        else:
            assert len(found) == vertices and reached <= best + 1e-6


@given(
    curve=short_curves(),
    closed=st.booleans(),
    measure=st.sampled_from(MEASURES),
    tolerance=st.sampled_from([0.0, 0.4, 1.0, 3.0]),
)
@settings(max_examples=80, deadline=None)
def test_no_polygon_of_fewer_vertices_keeps_the_tolerance(curve, closed, measure, tolerance):
    settings_ = OptimalParams(tolerance=tolerance, measure=measure)
    found = optimal(curve, closed=closed, params=settings_)
    assert errors(curve, found, closed)[measure] <= tolerance + 1e-6
    for vertices in range(2, len(found)):
        for polygon in polygons(len(curve), vertices, closed):
            assert errors(curve, polygon, closed)[measure] > tolerance - 1e-6
    if measure == "max_deviation":
        for polygon in polygons(len(curve), len(found), closed):
            other = errors(curve, polygon, closed)
            if other["max_deviation"] <= tolerance:
                assert other["ise"] >= errors(curve, found, closed)["ise"] - 1e-6


def blob(size, seed):
    random = np.random.default_rng(seed)
    t = np.linspace(0, 2 * np.pi, 60 * size, endpoint=False)
    waves = [random.normal() / k * np.cos(k * t + random.uniform(0, 6)) for k in range(2, 9)]
    pixels = np.rint(size * (1 + 0.3 * sum(waves)) * np.stack([np.cos(t), np.sin(t)]))
    pixels = pixels.T
    return pixels[(pixels != np.roll(pixels, 1, axis=0)).any(axis=1)]


def full_search(curve, vertices):
    """Return the least ISE by a plain dynamic programme from every start."""
    count = len(curve)
    segment = np.full((count, count + 1), np.inf)
    for i in range(count):
        for k in range(1, count):
            piece = curve[np.arange(i, i + k + 1) % count] - curve[i]
            length = np.hypot(*piece[-1])
            cross = piece[-1, 0] * piece[:, 1] - piece[-1, 1] * piece[:, 0]
            d = np.abs(cross) / length if length > 0 else np.hypot(*piece.T)
            segment[i, k] = (d**2).sum()
    best = np.inf
    for start in range(count):
        table = np.full((count + 1, count + 1), np.inf)
        for i in range(count):
            table[i, i + 1 :] = segment[(start + i) % count, 1 : count + 1 - i]
        reach = np.full(count + 1, np.inf)
        reach[0] = 0.0
        for _ in range(vertices):
            reach = (reach[:, None] + table).min(axis=0)
        best = min(best, reach[-1])
    return best


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("vertices", [3, 8, 15])
def test_a_closed_curve_reaches_the_optimum_of_every_start(seed, vertices):
    curve = blob(12, seed)
    found = optimal(curve, closed=True, params=OptimalParams(vertices, measure="ise"))
    assert errors(curve, found, True)["ise"] == pytest.approx(
        full_search(curve, vertices), abs=1e-6
    )


@pytest.mark.parametrize("measure", MEASURES)
def test_the_error_of_a_closed_curve_does_not_depend_on_its_start(measure):
    curve = blob(30, 4)
    values = []
    for start in (0, 5, 61, 140):
        turned = np.roll(curve, start, axis=0)
        found = optimal(turned, closed=True, params=OptimalParams(12, measure=measure))
        values.append(errors(turned, found, True)[measure])
    assert np.ptp(values) < 1e-6


def test_no_method_beats_it():
    curve = blob(40, 5)
    rival = rdp_mod(curve, closed=True)
    best = optimal(curve, closed=True, params=OptimalParams(len(rival), measure="ise"))
    assert errors(curve, best, True)["ise"] < errors(curve, rival, True)["ise"]
    deviation = errors(curve, rival, True)["max_deviation"]
    fewest = optimal(curve, closed=True, params=OptimalParams(tolerance=deviation))
    assert len(fewest) <= len(rival)


def test_more_vertices_than_pixels_give_all_pixels():
    curve = blob(12, 6)
    found = optimal(curve, closed=True, params=OptimalParams(len(curve) + 5))
    assert np.array_equal(found, np.arange(len(curve)))


def test_a_curve_whose_table_would_not_fit_is_refused(monkeypatch):
    monkeypatch.setattr("geoprim_core.polygon._optimal_search.MOST_SEGMENTS", 20_000)
    wave = np.stack([np.arange(2_000.0), 100 * np.sin(np.arange(2_000) / 300)], axis=1)
    with pytest.raises(InputError, match="segments in reach"):
        optimal(wave, params=OptimalParams(3, measure="ise"))


def test_unknown_measures_are_refused():
    with pytest.raises(ParameterError, match="max_deviation"):
        OptimalParams(measure="area")
