"""Tangents, half-windows, curvatures and normals where the answer is known."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.ecc.arcs import Arcs
from geoprim_core.ecc.tangents import arc_tangents
from geoprim_core.errors import InputError, ParameterError
from geoprim_core.evaluation.tangent_speed import pixel_circle
from geoprim_core.io.drawing import draw_normals
from geoprim_core.synthetic.boundaries import trace_boundary
from geoprim_core.tangent import (
    CURVATURES,
    TABLE,
    DebParams,
    HybridParams,
    LambdaMstParams,
    WindowParams,
    curvatures,
    deb,
    epf,
    estimate_tangents,
    half_windows,
    icipf,
    ipf,
    lambda_mst,
    lr3,
    matas,
    normals,
    radii_of,
)
from geoprim_core.tangent.pencils import pencils_of
from geoprim_core.types import Contours, Tangents


def circle_error(angle: np.ndarray, circle: np.ndarray) -> np.ndarray:
    """Errors in degrees on a circle about the origin; NaN where undefined."""
    truth = np.arctan2(circle[:, 1], circle[:, 0]) - np.pi / 2  # `pixel_circle` turns so
    return np.degrees(np.abs((angle - truth + np.pi) % (2 * np.pi) - np.pi))


def test_a_parabola_is_fitted_exactly():
    x = np.arange(-20.0, 21.0)
    parabola = np.stack([x, 3.0 + 0.01 * (x - 4) ** 2], axis=1)
    slope = np.arctan(0.02 * (x - 4))
    for method in (epf, ipf):
        angle = method(parabola, params=WindowParams(half_window=6))
        assert np.allclose(angle[6:-6], slope[6:-6], atol=1e-12)
        bend = curvatures(parabola, method.__name__, params=WindowParams(half_window=6))
        assert np.allclose(bend[6:-6], 0.02 * np.cos(slope[6:-6]) ** 3, atol=1e-12)


def test_a_cubic_in_its_principal_frame_is_fitted_exactly():
    """Odd about the middle: its principal axis is that of the window about the middle."""
    x = np.arange(-8.0, 9.0)
    turn = 0.6
    u, v = x, 0.001 * x**3 - 0.04 * x  # the covariance of u and v is not 0, order 3 takes it
    cubic = np.stack([u * np.cos(turn) - v * np.sin(turn), u * np.sin(turn) + v * np.cos(turn)], 1)
    angle = lr3(cubic, params=WindowParams(half_window=8))[8]
    assert angle == pytest.approx(turn - np.arctan(0.04), abs=2e-3)


def test_independent_parabolas_follow_any_parametric_parabola():
    q = np.arange(-15.0, 16.0)
    curve = np.stack([0.05 * q**2 + q, 0.03 * q**2 - 0.5 * q], axis=1)
    angle = icipf(curve, params=WindowParams(half_window=5))
    # Through its pixel and symmetric about it: the derivative of a parabola, at every pixel.
    truth = np.arctan2(0.06 * q - 0.5, 0.1 * q + 1.0)
    assert np.allclose(angle[5:-5], truth[5:-5], atol=1e-12)


def test_matas_takes_the_median_and_not_the_mean():
    x = np.arange(21)
    spike = np.stack([x, np.zeros(21)], axis=1)
    spike[13, 1] = 9.0  # one pixel far off
    assert matas(spike, params=WindowParams(half_window=5))[10] == pytest.approx(0.0, abs=1e-15)
    assert abs(icipf(spike, params=WindowParams(half_window=5))[10]) > 0.1


@pytest.mark.parametrize("method", sorted(CURVATURES))
def test_curvature_of_a_circle_is_one_over_its_radius_and_changes_sign_with_the_way(method):
    circle = pixel_circle(900)
    radius = 900 / (4 * np.sqrt(2))
    params = DebParams(radius=30.0) if method == "deb" else None
    if "_h" not in method and method != "deb":
        params = WindowParams(half_window=25)
    bend = curvatures(circle, method, closed=True, params=params)
    spread = 0.6 if method.endswith(("_h11", "_h12", "_h10", "_h3")) else 0.25
    assert abs(np.nanmean(bend)) == pytest.approx(1 / radius, rel=spread)
    back = curvatures(circle[::-1], method, closed=True, params=params)[::-1]
    assert np.allclose(back, -bend, atol=1e-9, equal_nan=True)


def test_methods_without_a_second_derivative_give_no_curvature():
    missing = {name for name in TABLE.names if name not in CURVATURES}
    assert missing == {
        name for name in TABLE.names if name.startswith(("lr1", "matas", "lambda"))
    }  # fmt: skip
    with pytest.raises(ParameterError, match="curvature"):
        curvatures([(0, 0), (1, 0)], "lambda_mst")


@given(st.floats(-3.14, 3.14))
@settings(max_examples=30, deadline=None)
def test_normals_stand_upright_on_the_direction(angle):
    (nx, ny), (dx, dy) = normals([angle])[0], (np.cos(angle), np.sin(angle))
    assert nx * dx + ny * dy == pytest.approx(0.0, abs=1e-15)
    assert dx * ny - dy * nx == pytest.approx(1.0)  # turned from +x towards +y


def test_normals_of_no_direction_are_no_numbers():
    assert np.isnan(normals([np.nan])).all()


# Half-windows


def test_half_windows_on_a_line_reach_to_its_ends():
    """One maximal segment: B = i, F = n - 1 - i, L = n."""
    line = np.stack([np.arange(30), np.arange(30) // 3], axis=1)
    i = np.arange(30)
    wanted = {
        "10": np.maximum(i, 29 - i), "11": np.minimum(i, 29 - i), "12": np.full(30, 14),
        "2": np.floor(np.maximum(i, 29 - i) ** 1.5), "3": np.full(30, 30),
        "4": np.full(30, int(30**1.5)),
    }  # fmt: skip
    for choice, expected in wanted.items():
        assert np.array_equal(half_windows(line, choice), expected)


def test_half_windows_of_a_pixel_reach_as_far_as_brute_force_finds():
    circle = pixel_circle(300)
    pencils = pencils_of(circle, closed=True)
    back, ahead = pencils.reaches()
    s, count = pencils.segments, len(circle)
    for i in range(0, count, 7):
        holds = [
            (i + turn - a, b - i - turn)
            for a, b in zip(s.start, s.end, strict=True)
            for turn in (-count, 0, count)
            if a <= i + turn <= b
        ]
        assert back[i] == max(b for b, _ in holds)
        assert ahead[i] == max(f for _, f in holds)


def test_an_unknown_choice_of_window_is_refused():
    with pytest.raises(ParameterError, match="choice"):
        half_windows([(0, 0), (1, 0)], "1")


def test_hybrid_windows_shrink_towards_the_ends_of_an_open_curve():
    line = np.stack([np.arange(40.0), np.zeros(40)], axis=1)
    angle = TABLE["epf_h10"].function(line, closed=False, params=None)
    assert np.isnan(angle[[0, -1]]).all()
    assert (angle[1:-1] == 0.0).all()


def test_no_hybrid_window_is_larger_than_allowed():
    circle = pixel_circle(4000)
    wide = TABLE["icipf_h4"].function(circle, closed=True, params=HybridParams())
    narrow = TABLE["icipf_h4"].function(circle, closed=True, params=HybridParams(max_half_window=8))
    fixed = icipf(circle, closed=True, params=WindowParams(half_window=8))
    assert np.array_equal(narrow, fixed)
    assert circle_error(wide, circle).mean() < circle_error(narrow, circle).mean()


# Maximal segments


def test_gaps_repeats_and_right_angles_leave_the_segments_of_the_thin_curve():
    thin = np.array([(0, 0), (1, 1), (2, 2), (3, 2), (4, 2), (5, 2)])
    rough = np.array([(0, 0), (1, 0), (1, 1), (1, 1), (2, 2), (5, 2)])  # corner, repeat, gap
    found, expected = pencils_of(rough, closed=False), pencils_of(thin, closed=False)
    assert np.array_equal(found.segments.start, expected.segments.start)
    assert np.array_equal(found.segments.end, expected.segments.end)
    assert found.before.tolist() == [0, 0, 1, 1, 2, 5]
    assert found.behind.tolist() == [0, 1, 1, 1, 2, 5]


def test_a_four_connected_curve_keeps_its_standard_lines():
    stairs = np.array([((i + 1) // 2, i // 2) for i in range(21)])
    assert np.allclose(lambda_mst(stairs), np.pi / 4)


@pytest.mark.parametrize("points", [[(0.5, 0), (1, 0)], [(0, 0), (5000, 0)]])
def test_segments_want_whole_numbers_and_steps_of_some_length(points):
    with pytest.raises(InputError, match="points"):
        lambda_mst(points)


@pytest.mark.parametrize("floor", [0.0, 0.4])
def test_lambda_mst_is_the_mean_of_the_pencil_weighted_by_the_triangle(floor):
    curve = np.array([(i, i * i // 30) for i in range(15)])
    segments = pencils_of(curve, closed=False).segments
    found = lambda_mst(curve, params=LambdaMstParams(floor=floor))
    for i in range(len(curve)):
        total = np.zeros(2)
        for k in np.flatnonzero((segments.start <= i) & (i <= segments.end)):
            e = (i - segments.start[k] + 0.5) / (segments.end[k] - segments.start[k] + 1)
            weight = floor + 1.0 - abs(2.0 * e - 1.0)
            total += weight * np.array([np.cos(segments.angle[k]), np.sin(segments.angle[k])])
        assert found[i] == pytest.approx(np.arctan2(total[1], total[0]), abs=1e-12)


@pytest.mark.parametrize("method", ["lambda_mst", "lambda_msg"])
@pytest.mark.parametrize("semi_minor", [60.0, 30.0, 14.0])
def test_segments_in_the_way_of_travel_make_no_errors_of_90_degrees(method, semi_minor):
    """Errata T5: the thesis prints such errors for eccentricities up to 0.99."""
    y, x = np.mgrid[-105:106, -105:106]
    border = trace_boundary(((x - 0.3) / 100) ** 2 + ((y + 0.2) / semi_minor) ** 2 <= 1.0)
    u, v = (border - [105.3, 104.8]).T
    truth = np.arctan2(u / 100**2, -v / semi_minor**2)
    angle = TABLE[method].function(border, closed=True, params=None)
    error = np.abs((angle - truth + np.pi) % (2 * np.pi) - np.pi)
    assert error.max() < np.radians(30)
    assert error.mean() < np.radians(1)


# DEB's radius


def test_the_radius_follows_the_smallest_circle():
    by_rule = DebParams(radius_rule="smallest_circle", smallest_circle=20.0, tolerance=0.5)
    circle = pixel_circle(600)
    fixed = deb(circle, closed=True, params=DebParams(radius=10.0))  # 3.4.3: 20 px, 0.5, R = 10
    assert np.array_equal(deb(circle, closed=True, params=by_rule), fixed)


def test_the_automatic_radius_grows_with_the_circle_and_beats_the_fixed_one_on_it():
    auto = DebParams(radius_rule="auto")
    medians = []
    for pixels in (400, 1200, 4000):
        circle = pixel_circle(pixels)
        medians.append(np.median(radii_of(circle, auto, closed=True)))
        found = circle_error(deb(circle, closed=True, params=auto), circle)
        fixed = circle_error(deb(circle, closed=True), circle)
        assert np.nanmean(found) < np.nanmean(fixed)
    assert medians == sorted(medians)
    assert medians[2] > 2 * medians[0]


def test_the_automatic_radius_of_many_curves_is_that_of_each():
    parts = [pixel_circle(300), pixel_circle(100)]
    contours = Contours(np.concatenate(parts), [0, 300, 300 + len(parts[1])], [True, True])
    params = DebParams(radius_rule="auto")
    alone = [deb(part, closed=True, params=params) for part in parts]
    assert np.array_equal(
        estimate_tangents(contours, "deb", params).angle, np.concatenate(alone), equal_nan=True
    )


# Those who use them


@pytest.mark.parametrize("method", ["lambda_mst", "epf_h3", "matas"])
def test_arcs_take_any_method(method):
    circle = pixel_circle(400)
    arcs = Arcs(circle[:150], [0, 150], [0], [False], np.arange(150), image_size=None)
    found = arc_tangents(arcs, None, method)
    truth = TABLE[method].function(circle[:150], closed=False, params=None)
    assert np.array_equal(found.angle, truth, equal_nan=True)
    assert found.defined.all()


def test_normals_are_drawn_of_their_own_contours_only():
    line = Contours([(i, 5) for i in range(9)], [0, 9], [False])
    with pytest.raises(InputError, match="tangents"):
        draw_normals(np.zeros((20, 20)), line, Tangents(np.zeros(8), [0, 8]))
