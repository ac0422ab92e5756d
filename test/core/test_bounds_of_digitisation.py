"""The three rules for the largest deviation of a digital line (thesis 2.4, errata P4)."""

import numpy as np
import pytest

from geoprim_core.errors import InputError, ParameterError
from geoprim_core.polygon import deviation_bound, dss_bound, slope_bound, tan_bound


@pytest.mark.parametrize(
    "length, printed", [(3, 1.755), (5, 1.518), (10, 1.438), (20, 1.420), (1e6, np.sqrt(2))]
)
def test_released_rule_gives_the_figures_of_errata_p4(length, printed):
    assert deviation_bound((7, 9), (7 + length, 9)) == pytest.approx(printed, abs=1e-3)


@pytest.mark.parametrize("length", [2.0, 2.5, 3.0, 7.7, 31.0])
def test_released_rule_is_the_maximum_over_slopes_and_signs(length):
    phi = np.linspace(0, 2 * np.pi, 100_001)
    cos, sin = np.cos(phi), np.sin(phi)
    largest = -np.inf
    for first, second in ((sin + cos, cos - sin), (sin - cos, cos + sin)):
        for t in (second / length, -second / length):
            turn = np.abs(first) / length * (1 - t + t * t)
            largest = max(largest, (length * np.tan(turn)).max())
    assert deviation_bound((0, 0), (0, length)) == pytest.approx(largest, abs=1e-6)


def test_released_rule_is_negative_for_neighbouring_pixels():
    assert deviation_bound((0, 0), (1, 0)) < 0
    assert deviation_bound((0, 0), (1, 1)) < 0


def test_exact_rule_is_reached_and_never_exceeded_by_moved_end_points():
    corners = np.array([(x, y) for x in (-0.5, 0.5) for y in (-0.5, 0.5)])
    for phi in np.linspace(0, np.pi / 2, 37):
        for length in (2.5, 4.0, 9.0):
            end = length * np.array([np.cos(phi), np.sin(phi)])
            moved = end + (corners[:, None] - corners[None]).reshape(-1, 2)
            turn = np.abs(np.arctan2(moved[:, 1], moved[:, 0]) - phi)
            bound = slope_bound((0, 0), end, "exact")
            assert turn.max() == pytest.approx(bound, abs=1e-9)
            assert deviation_bound((0, 0), end, "exact") == pytest.approx(length * bound)


def test_printed_rule_is_no_upper_bound_for_short_lines():
    # Errata P4: brute force exceeds it by up to 1.95 times; here along a diagonal.
    worst = max(
        slope_bound((0, 0), end, "exact") / slope_bound((0, 0), end, "thesis")
        for end in [(x, y) for x in range(12) for y in range(1, 12) if x * x + y * y > 4]
    )
    assert 1.3 < worst <= 1.96


def test_printed_rule_stays_below_the_root_of_two():
    for x in range(40):
        for y in range(1, 40):
            assert deviation_bound((0, 0), (x, y), "thesis") < np.sqrt(2)


@pytest.mark.parametrize("rule", ["thesis", "exact", "released", "dss4", "dss8", "tan"])
def test_bounds_do_not_depend_on_position_direction_or_octant(rule):
    value = deviation_bound((0, 0), (7, 3), rule)
    for dx, dy in [(3, 7), (-7, 3), (7, -3), (-3, -7)]:
        assert deviation_bound((5, -8), (5 + dx, dy - 8), rule) == pytest.approx(value, rel=1e-14)
    assert deviation_bound((4, 4), (4, 4), rule) == 0.0
    assert slope_bound((4, 4), (4, 4), rule) == np.pi / 2


def test_the_three_bounds_meet_for_long_segments():
    # (2-50)-(2-52): d_dig tends to d_DSS of the same slope, the largest of both and d_tan to sqrt 2
    for phi in np.linspace(0, np.pi / 2, 19):
        end = 1e7 * np.array([np.cos(phi), np.sin(phi)])
        dss = dss_bound((0, 0), end, connectivity=4)
        assert dss == pytest.approx(abs(np.cos(phi)) + abs(np.sin(phi)))
        assert deviation_bound((0, 0), end, "thesis") == pytest.approx(dss, abs=1e-6)
        assert deviation_bound((0, 0), end, "exact") == pytest.approx(dss, abs=1e-6)
        assert tan_bound((0, 0), end) == pytest.approx(np.sqrt(2), abs=1e-6)
    assert dss_bound((0, 0), (9, 9), connectivity=4) == pytest.approx(np.sqrt(2))


def test_tan_bound_is_the_inner_tangent_of_two_circles():
    for length in (1.5, 2.0, 7.0):
        turn = slope_bound((0, 0), (0, length), "tan")
        assert np.sin(turn) * length / 2 == pytest.approx(1 / np.sqrt(2))
        assert tan_bound((0, 0), (0, length)) == pytest.approx(length * turn)
    assert slope_bound((0, 0), (1, 0), "tan") == np.pi / 2


@pytest.mark.parametrize("dx, dy", [(31, 7), (40, 23), (17, -16), (-50, 3)])
def test_no_pixel_of_a_digital_segment_is_as_far_as_its_width(dx, dy):
    # Errata P5: the naive, 8-connected segment; its standard form has the width of `dss4`.
    count = max(abs(dx), abs(dy))
    line = np.rint(np.arange(count + 1)[:, None] / count * [dx, dy])
    away = np.abs(line[:, 0] * dy - line[:, 1] * dx) / np.hypot(dx, dy)
    assert away.max() < dss_bound((0, 0), (dx, dy), 8) < dss_bound((0, 0), (dx, dy), 4)


def test_wrong_arguments_are_named():
    with pytest.raises(ParameterError, match="4 or 8"):
        dss_bound((0, 0), (1, 0), connectivity=6)
    with pytest.raises(ParameterError, match="thesis, exact, released"):
        deviation_bound((0, 0), (1, 0), "best")
    with pytest.raises(InputError, match="end"):
        slope_bound((0, 0), (1, np.nan))
