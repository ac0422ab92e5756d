"""Maximal digital straight segments against recognition by brute force."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.digital import is_digital_straight, maximal_segments
from geoprim_core.errors import InputError, ParameterError

EIGHT = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])


@st.composite
def curves(draw):
    """Draw a digital curve and its connectivity: any steps, two of them, or nearly a line."""
    connectivity = draw(st.sampled_from([8, 4]))
    steps = EIGHT if connectivity == 8 else EIGHT[::2]
    kind = draw(st.sampled_from(["any", "two", "line"]))
    turn = draw(st.integers(0, len(steps) - 1))
    if kind == "line":
        p, q, count = draw(st.integers(0, 7)), draw(st.integers(1, 7)), draw(st.integers(1, 13))
        codes = np.diff(p * np.arange(count + 1) // max(p, q))
        if draw(st.booleans()):
            codes[draw(st.integers(0, count - 1))] ^= 1
    else:
        most = len(steps) - 1 if kind == "any" else 1
        codes = np.array(draw(st.lists(st.integers(0, most), max_size=12)), int)
    walk = steps[(codes + turn) % len(steps)].cumsum(axis=0)
    return np.vstack([np.zeros((1, 2), int), walk]) + draw(st.integers(-9, 9)), connectivity


def fits(pixels, connectivity):
    """Say whether some direction of at most so many pixels explains all remainders."""
    if len(pixels) <= 2:
        return True
    steps = {tuple(step) for step in np.diff(pixels, axis=0)}
    if len(steps) > 2:
        return False
    if len(steps) == 2:
        (a, b), (c, d) = steps
        if abs(a * d - b * c) != 1 or a * c + b * d != (1 if connectivity == 8 else 0):
            return False
    size = range(-len(pixels), len(pixels) + 1)
    v = np.array([(i, j) for i in size for j in size if (i, j) != (0, 0)])
    v = v[v @ (pixels[-1] - pixels[0]) > 0]
    remainders = np.outer(v[:, 1], pixels[:, 0]) - np.outer(v[:, 0], pixels[:, 1])
    width = np.abs(v).max(axis=1) if connectivity == 8 else np.abs(v).sum(axis=1)
    return bool((np.ptp(remainders, axis=1) < width).any())


def ends_by_force(pixels, first, last, connectivity):
    """Return the end of the longest segment from each pixel first .. last of an unrolled curve."""
    ends = []
    for start in range(first, last):
        end = start
        while end + 1 < len(pixels) and fits(pixels[start : end + 2], connectivity):
            end += 1
        ends.append(end)
    return np.array(ends)


@given(drawn=curves())
@settings(max_examples=150, deadline=None)
def test_the_segments_of_an_open_curve_are_those_of_brute_force(drawn):
    pixels, connectivity = drawn
    found = maximal_segments(pixels, connectivity=connectivity)
    ends = ends_by_force(pixels, 0, len(pixels), connectivity)
    starts = np.flatnonzero(np.diff(ends, prepend=-1) > 0)
    assert found.start.tolist() == starts.tolist()
    assert found.end.tolist() == ends[starts].tolist()
    assert is_digital_straight(pixels, connectivity=connectivity) == (len(starts) == 1)


@given(drawn=curves())
@settings(max_examples=60, deadline=None)
def test_the_segments_of_a_closed_curve_are_those_of_brute_force(drawn):
    there, connectivity = drawn
    if len(there) < 2:
        return
    pixels = np.vstack([there, there[::-1][1:-1]])
    found = maximal_segments(pixels, closed=True, connectivity=connectivity)
    count = len(pixels)
    ends = ends_by_force(np.tile(pixels, (3, 1)), count - 1, 2 * count, connectivity)
    starts = np.flatnonzero(np.diff(ends) > 0)
    assert found.start.tolist() == starts.tolist()
    assert (found.end + count).tolist() == ends[starts + 1].tolist()


@given(drawn=curves())
@settings(max_examples=150, deadline=None)
def test_remainders_fill_the_strip_and_leaning_pixels_lie_on_its_borders(drawn):
    pixels, connectivity = drawn
    found = maximal_segments(pixels, connectivity=connectivity)
    for k in range(len(found)):
        if found.start[k] == found.end[k]:
            continue
        piece = pixels[found.start[k] : found.end[k] + 1]
        remainder = found.a[k] * piece[:, 0] - found.b[k] * piece[:, 1] - found.mu[k]
        assert remainder.min() == 0 and remainder.max() == found.omega[k] - 1
        assert np.gcd(found.a[k], found.b[k]) == 1
        for leaning, border in ((found.upper[k], 0), (found.lower[k], found.omega[k] - 1)):
            places = np.flatnonzero(remainder == border) + found.start[k]
            assert leaning.tolist() == [places[0], places[-1]]


@pytest.mark.parametrize("dx, dy", [(233, 144), (-89, 55), (500, 1), (7, -300), (64, 64)])
def test_a_digitised_line_is_one_segment_of_its_own_slope(dx, dy):
    count = 3 * max(abs(dx), abs(dy))
    t = np.arange(count + 1) / max(abs(dx), abs(dy))
    line = np.stack([np.floor(t * dx + 0.5), np.floor(t * dy + 0.5)], axis=1)
    found = maximal_segments(line)
    assert len(found) == 1
    divisor = np.gcd(dx, dy)
    assert (found.b[0], found.a[0]) == (dx // divisor, dy // divisor)
    assert found.angle[0] == pytest.approx(np.arctan2(dy, dx), abs=1e-12)


def test_turned_and_shifted_starts_give_the_same_segments():
    t = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
    curve = np.rint(np.stack([40 * np.cos(t), 25 * np.sin(t) + 4 * np.cos(2 * t)], axis=1))
    curve = curve[(curve != np.roll(curve, 1, axis=0)).any(axis=1)]
    count = len(curve)
    found = maximal_segments(curve, closed=True)
    expected = set(zip(found.start, found.end - found.start, found.a, found.b, strict=True))
    for shift in (1, 13, 100):
        turned = maximal_segments(np.roll(curve, shift, axis=0), closed=True)
        starts = (turned.start - shift) % count
        assert set(zip(starts, turned.end - turned.start, turned.a, turned.b, strict=True)) == (
            expected
        )


def test_one_pixel_and_none():
    assert len(maximal_segments(np.zeros((0, 2)))) == 0
    one = maximal_segments([(3, 4)], closed=True)
    assert (one.start.tolist(), one.end.tolist()) == ([0], [0])


def test_what_is_no_digital_curve_is_refused():
    for points in ([(0, 0), (2, 0)], [(0, 0), (0, 0)], [(0, 0), (0.5, 0)]):
        with pytest.raises(InputError, match="neighbours"):
            maximal_segments(points)
    with pytest.raises(InputError, match="4 neighbours"):
        maximal_segments([(0, 0), (1, 1)], connectivity=4)
    with pytest.raises(InputError, match="neighbours"):
        maximal_segments([(0, 0), (1, 0), (2, 0)], closed=True)
    with pytest.raises(ParameterError, match="connectivity"):
        maximal_segments([(0, 0), (1, 1)], connectivity=6)
