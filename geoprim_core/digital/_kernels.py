"""Kernel of the digital straight segments: recognition with points added ahead, removed behind.

A segment is kept as its direction v, its least remainder mu, its width omega and its leaning
pixels. The remainder of a pixel p is cross(p, v) = p_x v_y - p_y v_x; those of the segment's
pixels fill mu .. mu + omega - 1. Upper leaning pixels have mu, lower ones mu + omega - 1; of each
kind the first and the last are known. `v` is the shortest such direction: three leaning pixels in
turn (upper, lower, upper or lower, upper, lower) fix it.
"""

from __future__ import annotations

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel

FIRST, LAST, VX, VY, MU, OMEGA, UF, UL, LF, LL, ONE, TWO = range(12)


@kernel
def _width(vx: int, vy: int, eight: bool) -> int:
    """Return omega, which is also the number of pixels that the direction spans."""
    return max(abs(vx), abs(vy)) if eight else abs(vx) + abs(vy)


@kernel
def _turn(s: IntArray, vx: int, vy: int, eight: bool) -> None:
    s[VX], s[VY], s[OMEGA] = vx, vy, _width(vx, vy, eight)


@kernel
def _admits(s: IntArray, code: int, eight: bool) -> bool:
    """Say whether a step of that Freeman code may stand beside those of the segment."""
    if s[ONE] < 0 or code == s[ONE] or code == s[TWO]:
        return True
    if s[TWO] >= 0:
        return False
    gap = abs(code - s[ONE])
    gap = min(gap, 8 - gap)
    return gap == (1 if eight else 2)


@kernel
def _add(s: IntArray, x: IntArray, y: IntArray, code: int, tally: IntArray, eight: bool) -> bool:
    """Add the pixel ahead if the segment stays one; say whether it did."""
    m = s[LAST] + 1
    if not _admits(s, code, eight):
        return False
    if s[ONE] < 0:  # a single pixel until now
        _turn(s, x[m] - x[m - 1], y[m] - y[m - 1], eight)
        s[MU] = x[m] * s[VY] - y[m] * s[VX]
        s[UF] = s[LF] = m - 1
        s[UL] = s[LL] = m
    else:
        r = x[m] * s[VY] - y[m] * s[VX] - s[MU]
        if r < -1 or r > s[OMEGA]:
            return False
        if r == -1:
            s[LF], s[UL] = s[LL], m
            _turn(s, x[m] - x[s[UF]], y[m] - y[s[UF]], eight)
            s[MU] = x[m] * s[VY] - y[m] * s[VX]
        elif r == s[OMEGA]:
            s[UF], s[LL] = s[UL], m
            _turn(s, x[m] - x[s[LF]], y[m] - y[s[LF]], eight)
            s[MU] = x[s[UF]] * s[VY] - y[s[UF]] * s[VX]
        else:
            if r == 0:
                s[UL] = m
            if r == s[OMEGA] - 1:
                s[LL] = m
    if s[ONE] < 0:
        s[ONE] = code
    elif code != s[ONE]:
        s[TWO] = code
    tally[code] += 1
    s[LAST] = m
    return True


@kernel
def _forget(s: IntArray, code: int, tally: IntArray) -> None:
    """Take one step off the tally of Freeman codes."""
    tally[code] -= 1
    if tally[code] == 0:
        if code == s[ONE]:
            s[ONE] = s[TWO]
        s[TWO] = -1


@kernel
def _lean_back(s: IntArray, x: IntArray, y: IntArray, upper: bool, eight: bool) -> None:
    """Turn to the simpler direction once the leaning pixel that forbade it is gone.

    With s the step of remainder -omega across the strip, the removed pixel U, and L the only
    lower leaning one: the new direction is the parent L + s - U of v in the Stern-Brocot tree,
    and the last upper leaning pixel and L lean on the new lines too. Lower: mirrored.
    """
    gone = s[FIRST] - 1
    sx = sy = 0
    if not eight:
        sx, sy = -np.sign(s[VY]), np.sign(s[VX])
    elif abs(s[VX]) > abs(s[VY]):
        sy = np.sign(s[VX])
    else:
        sx = -np.sign(s[VY])
    if upper:
        _turn(s, x[s[LL]] + sx - x[gone], y[s[LL]] + sy - y[gone], eight)
        s[UF] = s[UL] - s[OMEGA] * ((s[UL] - s[FIRST]) // s[OMEGA])
        s[LL] = s[LF] + s[OMEGA] * ((s[LAST] - s[LF]) // s[OMEGA])
    else:
        _turn(s, x[s[UL]] - sx - x[gone], y[s[UL]] - sy - y[gone], eight)
        s[LF] = s[LL] - s[OMEGA] * ((s[LL] - s[FIRST]) // s[OMEGA])
        s[UL] = s[UF] + s[OMEGA] * ((s[LAST] - s[UF]) // s[OMEGA])
    s[MU] = x[s[UF]] * s[VY] - y[s[UF]] * s[VX]


@kernel
def _remove(s: IntArray, x: IntArray, y: IntArray, code: int, tally: IntArray, eight: bool) -> None:
    """Remove the rearmost pixel of a segment of at least two."""
    gone = s[FIRST]
    s[FIRST] = gone + 1
    _forget(s, code, tally)
    if s[FIRST] == s[LAST]:
        return
    step = s[OMEGA]
    if step == 1:  # all pixels lean both ways
        s[UF] = s[LF] = gone + 1
    elif s[UF] == gone:
        if s[UF] + step < s[UL] or s[LF] != s[LL]:
            s[UF] += step
        else:
            _lean_back(s, x, y, True, eight)
    elif s[LF] == gone:
        if s[LF] + step < s[LL] or s[UF] != s[UL]:
            s[LF] += step
        else:
            _lean_back(s, x, y, False, eight)


@kernel
def freeman_codes(
    points: FloatArray, closed: bool, eight: bool
) -> tuple[IntArray, IntArray, IntArray, int]:
    """Return x, y, the Freeman codes (a turn of 45 degrees each) and the first wrong step or -1.

    A closed curve comes in three rounds, so that no window meets its end.
    """
    count = len(points)
    rounds = 3 if closed else 1
    x, y = np.empty(rounds * count, np.int64), np.empty(rounds * count, np.int64)
    codes = np.empty(rounds * count, np.int64)
    for i in range(count):
        x[i], y[i] = int(points[i, 0]), int(points[i, 1])
        if x[i] != points[i, 0] or y[i] != points[i, 1]:
            return x, y, codes, i
    for i in range(count if closed else count - 1):
        j = i + 1 if i + 1 < count else 0
        dx, dy = x[j] - x[i], y[j] - y[i]
        if max(abs(dx), abs(dy)) != 1 or not (eight or dx == 0 or dy == 0):
            return x, y, codes, i
        code = 2 - dx if dy > 0 else 6 + dx
        codes[i] = 2 - 2 * dx if dy == 0 else code
    for i in range(count, rounds * count):
        x[i], y[i], codes[i] = x[i - count], y[i - count], codes[i - count]
    return x, y, codes, -1


@kernel
def maximal_segments_of(
    x: IntArray, y: IntArray, codes: IntArray, count: int, closed: bool, eight: bool
) -> IntArray:
    """Return (k, 10): first, last, v_x, v_y, mu, omega and leaning pixels of every segment.

    A closed curve comes as three rounds of pixels. Every pixel is added once and removed at most
    once, in constant time each: the whole is linear.
    """
    found = np.empty((count + 1, 10), np.int64)
    size = 0
    s = np.zeros(12, np.int64)
    s[ONE] = s[TWO] = -1
    tally = np.zeros(8, np.int64)
    emitted = False
    while s[LAST] < len(x) - 1:
        code = codes[s[LAST]]
        if _add(s, x, y, code, tally, eight):
            continue
        if closed and size > 0 and s[FIRST] >= found[0, 0] + count:
            return found[:size].copy()
        if emitted or not closed:  # the very first of a closed curve may go on behind its start
            found[size] = s[:10]
            size += 1
        emitted = True
        while not _add(s, x, y, code, tally, eight):
            _remove(s, x, y, codes[s[FIRST]], tally, eight)
    if not closed:
        found[size] = s[:10]
        size += 1
    return found[:size].copy()
