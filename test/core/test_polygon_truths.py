"""Analytic truths of the polygon methods, one by one."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import ParameterError
from geoprim_core.evaluation.polygon import measure_polygon
from geoprim_core.evaluation.polygon_speed import comb, long_wave, spiral
from geoprim_core.polygon import (
    BreakPointsParams,
    CarmonaModParams,
    CarmonaParams,
    LoweParams,
    MasoodParams,
    ProParams,
    RdpParams,
    TehChinParams,
    VisvalingamParams,
    break_points,
    carmona,
    carmona_mod,
    lowe,
    masood,
    pro,
    rdp,
    teh_chin,
    visvalingam,
)
from geoprim_core.polygon._kernels_reach import block_hulls, farthest_by_hulls, farthest_by_scan
from geoprim_core.synthetic import formula_curve

STEPS = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])


def digital(curve):
    pixels = np.rint(curve)
    return pixels[(pixels != np.roll(pixels, 1, axis=0)).any(axis=1)]


def flower(size=60.0, lobes=5):
    t = np.linspace(0, 2 * np.pi, 6000, endpoint=False)
    radius = size * (1 + 0.25 * np.cos(lobes * t))
    return digital(np.stack([radius * np.cos(t), radius * np.sin(t)], axis=1))


RIGHT = [(x, 0) for x in range(30)] + [(30, y) for y in range(20)]
RECTANGLE = np.array(
    RIGHT + [(x, 20) for x in range(30, 0, -1)] + [(0, y) for y in range(20, 0, -1)]
)
CORNERS = {(0, 0), (30, 0), (30, 20), (0, 20)}


def distances(piece):
    chord, away = piece[-1] - piece[0], piece - piece[0]
    length = np.hypot(*chord)
    if length == 0.0:
        return np.hypot(*away.T)
    return np.abs(chord[0] * away[:, 1] - chord[1] * away[:, 0]) / length


def edges(curve, indices):
    for i, j in zip(indices, np.roll(indices, -1), strict=True):
        yield curve[np.arange(i, j + 1 if j > i else j + 1 + len(curve)) % len(curve)]


def squared_error(curve, indices):
    return sum((distances(piece) ** 2).sum() for piece in edges(curve, indices))


def reference_rdp(curve, tolerance):
    kept, stack = {0, len(curve) - 1}, [(0, len(curve) - 1)]
    while stack:
        low, high = stack.pop()
        away = distances(curve[low : high + 1])
        if away.max(initial=0.0) > tolerance:
            place = low + int(away.argmax())
            kept.add(place)
            stack += [(low, place), (place, high)]
    return sorted(kept)


@given(codes=st.lists(st.integers(0, 7), min_size=1, max_size=70), tolerance=st.floats(0.01, 9.0))
@settings(max_examples=100, deadline=None)
def test_rdp_is_the_textbook_method(codes, tolerance):
    curve = np.vstack([np.zeros((1, 2)), STEPS[codes].cumsum(axis=0)])
    assert rdp(curve, params=RdpParams(tolerance)).tolist() == reference_rdp(curve, tolerance)


@pytest.mark.parametrize("curve", [comb(3000), spiral(3000), comb(2500, 40), long_wave(4000)])
def test_hulls_find_the_point_that_a_scan_finds(curve):
    x, y = curve[:, 0].copy(), curve[:, 1].copy()
    hulls = block_hulls(x, y, len(x))
    pairs = np.sort(np.random.default_rng(4).integers(0, len(x), (400, 2)), axis=1)
    for low, high in pairs:
        if high - low > 1:
            assert farthest_by_hulls(x, y, hulls, low, high) == farthest_by_scan(x, y, low, high)


def test_rdp_of_a_comb_with_hulls_is_the_textbook_method():
    curve = comb(6000)
    assert rdp(curve).tolist() == reference_rdp(curve, 1.0)


@pytest.mark.parametrize("method", [rdp, pro, lowe, teh_chin, visvalingam, break_points, masood])
def test_the_corners_of_a_rectangle_are_its_vertices(method):
    refuse = {"params": MasoodParams(refuse=True)} if method is masood else {}
    indices = method(RECTANGLE, closed=True, **refuse)
    assert {tuple(p) for p in RECTANGLE[indices]} == CORNERS


@pytest.mark.parametrize("span", ["any", "first"])
@pytest.mark.parametrize("tolerance", [0.4, 0.8, 1.5])
def test_pro_keeps_precision_and_reliability_of_every_edge(tolerance, span):
    curve = flower()
    for piece in edges(curve, pro(curve, closed=True, params=ProParams(tolerance, span))):
        away = distances(piece)
        spans = np.hypot(*(piece[:, None] - piece[None]).transpose(2, 0, 1))
        widest = spans.max() if span == "any" else spans[0].max()
        assert np.sqrt((away**2).mean()) <= tolerance + 1e-9
        assert away.sum() / widest <= tolerance + 1e-9


def test_pro_needs_fewer_vertices_the_larger_its_tolerance():
    counts = [len(pro(flower(), closed=True, params=ProParams(t))) for t in (0.2, 0.4, 0.8, 1.5)]
    assert counts == sorted(counts, reverse=True) and counts[0] > 3 * counts[-1]


def test_break_points_carry_every_pixel_exactly():
    curve = flower()
    indices = break_points(curve, closed=True)
    assert squared_error(curve, indices) == 0.0
    codes = np.roll(curve, -1, axis=0) - curve
    assert (
        indices.tolist()
        == np.flatnonzero((codes != np.roll(codes, 1, axis=0)).any(axis=1)).tolist()
    )


def test_break_points_of_a_real_valued_line_are_its_ends():
    line = np.linspace(0.1, 777.7, 500)[:, None] * [0.3, -1.7] + [12.3, 4.5]
    assert break_points(line).tolist() == [0, 499]
    assert len(break_points(line, params=BreakPointsParams(0.0))) > 2  # rounding bends it


def test_masood_ends_with_the_first_violation_and_refuses_it_when_asked():
    curve = flower()
    ended = masood(curve, closed=True)
    refused = masood(curve, closed=True, params=MasoodParams(refuse=True))
    assert max(distances(p).max() for p in edges(curve, ended)) ** 2 > 0.9
    assert max(distances(p).max() for p in edges(curve, refused)) ** 2 <= 0.9 + 1e-9


def test_masood_moves_vertices_to_a_lower_squared_error():
    curve = flower()
    fixed = masood(curve, closed=True, params=MasoodParams(tolerance=4.0, moves=0))
    moved = masood(curve, closed=True, params=MasoodParams(tolerance=4.0))
    per_vertex = [squared_error(curve, i) * len(i) ** 2 for i in (fixed, moved)]
    assert per_vertex[1] < per_vertex[0]


def test_carmona_keeps_no_more_vertices_for_a_higher_ratio():
    # Errata P9: in all rows of Table 2.5-3 the higher r_tol has as many vertices or fewer.
    curve = flower()
    counts = [
        len(carmona(curve, closed=True, params=CarmonaParams(r)))
        for r in (0.0, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0)
    ]
    assert counts == sorted(counts, reverse=True) and counts[0] > counts[-1]
    below = [
        len(carmona(curve, closed=True, params=CarmonaParams(r, "below"))) for r in (0.1, 0.3, 0.7)
    ]
    assert below == sorted(below)  # the printed rule runs the other way


def test_carmona_mod_refuses_what_its_sweeps_would_violate():
    curve = flower()
    swept = carmona_mod(curve, closed=True)
    refused = carmona_mod(curve, closed=True, params=CarmonaModParams("exact", refuse=True))
    assert 10 <= len(refused) < len(break_points(curve, closed=True)) / 2
    assert 10 <= len(swept) < len(break_points(curve, closed=True)) / 2


@pytest.mark.parametrize("count", [500, 2_000, 20_000])
def test_carmona_mod_follows_a_circle_however_many_points_a_pixel_it_has(count):
    t = np.linspace(0, 2 * np.pi, count, endpoint=False)
    circle = 80 * np.stack([np.cos(t), np.sin(t)], axis=1)
    metrics = measure_polygon(circle, carmona_mod(circle, closed=True), closed=True)
    assert metrics.vertices >= 12 and metrics.max_deviation < 8


def test_carmona_mod_gives_the_printed_row_of_the_sinc_curve():
    sinc = formula_curve("sinc", "real")
    metrics = measure_polygon(sinc, carmona_mod(sinc))
    assert (metrics.vertices, round(metrics.max_deviation, 2)) == (8, 3.38)  # Table 2.7-8
    assert metrics.ise == pytest.approx(160.59, abs=0.02)


def test_lowe_takes_the_longest_segments_for_their_deviation():
    # A shallow roof: split 40 / 1 each, whole 80 / 4.
    roof = np.array(
        [(x, -round(x / 10)) for x in range(41)]
        + [(x, -round((80 - x) / 10)) for x in range(41, 81)]
    )
    indices = lowe(roof).tolist()
    assert indices[0] == 0 and indices[-1] == 80 and any(abs(i - 40) <= 5 for i in indices[1:-1])
    assert lowe(roof, params=LoweParams(floor=5.0)).tolist() == [0, 80]


def test_teh_chin_finds_the_tips_of_a_star():
    tips = [(0, 40), (10, 10), (40, 0), (10, -10), (0, -40), (-10, -10), (-40, 0), (-10, 10)]
    outline = []
    for (ax, ay), (bx, by) in itertools.pairwise([*tips, tips[0]]):
        t = np.linspace(0, 1, 200, endpoint=False)
        outline.append(np.stack([ax + (bx - ax) * t, ay + (by - ay) * t], axis=1))
    star = digital(np.concatenate(outline))
    for measure in ("k_cosine", "1_curvature"):
        found = star[teh_chin(star, closed=True, params=TehChinParams(measure))]
        for tip in tips[::2]:
            assert np.hypot(*(found - tip).T).min() <= 1.5


def test_visvalingam_drops_the_smallest_triangles_first():
    roof = [(0, 0), (2, 1), (4, 0), (7, 5), (10, 0)]
    for area, left in ((2.0, 5), (2.1, 4), (10.1, 3), (25.1, 2)):
        assert len(visvalingam(roof, params=VisvalingamParams(area=area))) == left
    assert len(visvalingam(roof, params=VisvalingamParams(area=1e9, least=4))) == 4


def test_wrong_parameters_are_named():
    for call in (
        lambda: RdpParams(-1.0),
        lambda: ProParams(span="last"),
        lambda: CarmonaParams(stop="never"),
        lambda: VisvalingamParams(least=1),
        lambda: masood([(0, 0)], params=RdpParams()),  # type: ignore[arg-type]
    ):
        with pytest.raises(ParameterError):
            call()
