"""Kernels of the `refined` scheme, pairs: candidates from single arcs and pairs of arcs."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_arcs import CHORD, INWARDS, MIDDLE, PLACES, POLARITY, SIZE
from geoprim_core.ecc.refined._kernels_batch import BATCH, WORK, fit_pairs, sample_arcs
from geoprim_core.ecc.refined._kernels_few import PairRules, partners_of_few, sees

CLASS_RATIO = 1.5  # longest over shortest arc of one class of lengths
LEAST_CELL = 16.0  # pixels
LEVEL = 1e-4  # a border of a search region that rises less is taken as level
FEW = 600  # arcs that are compared each with each
ROOM = 16384  # candidates before there has to be made more
BISECTIONS = 24  # of the share that leaves so many pairs
CELL_ARCS = 2.0  # side of a cell in mean distances of arcs


class Cells(NamedTuple):
    """The arcs in square cells by their middles, those of like length together.

    Attributes
    ----------
    classes : (C + 1,) int64
        Where each class of like length starts among the arcs.
    left, top, side : float
        Corner of the grid of cells and side of one in pixels.
    starts : (C, rows, columns + 1) int64
        Where the arcs of each cell start among the members, which follow row by row.
    members : (A,) int64
        The arcs.
    area : (C, rows + 1, columns + 1) int64
        How many arcs of a class lie in the rows above and the columns to the left (summed area).
    """

    classes: IntArray
    left: float
    top: float
    side: float
    starts: IntArray
    members: IntArray
    area: IntArray


@kernel
def length_classes(table: FloatArray) -> IntArray:
    """Return where each class of arcs of like length starts; the arcs come longest first."""
    starts = np.empty(len(table) + 1, np.int64)
    count = 0
    longest = math.inf
    for i in range(len(table)):
        if CLASS_RATIO * table[i, SIZE] < longest:
            starts[count] = i
            longest = table[i, SIZE]
            count += 1
    starts[count] = len(table)
    return starts[: count + 1].copy()


@kernel
def cells_of(table: FloatArray) -> Cells:
    """Sort the middles of arcs, which come longest first, into cells."""
    classes = length_classes(table)
    count = len(table)
    left, top = table[:, MIDDLE].min(), table[:, MIDDLE + 1].min()
    width, height = table[:, MIDDLE].max() - left, table[:, MIDDLE + 1].max() - top
    cell = max(LEAST_CELL, CELL_ARCS * math.sqrt((width + 1.0) * (height + 1.0) / count))
    columns, rows = int(width / cell) + 1, int(height / cell) + 1
    starts = np.zeros((len(classes) - 1, rows, columns + 1), np.int64)
    area = np.zeros((len(classes) - 1, rows + 1, columns + 1), np.int64)
    members = np.empty(count, np.int64)
    where = np.empty((count, 2), np.int64)
    for c in range(len(classes) - 1):
        tally = np.zeros((rows, columns), np.int64)
        for i in range(classes[c], classes[c + 1]):
            where[i, 0] = min(rows - 1, int((table[i, MIDDLE + 1] - top) / cell))
            where[i, 1] = min(columns - 1, int((table[i, MIDDLE] - left) / cell))
            tally[where[i, 0], where[i, 1]] += 1
        total = classes[c]
        for y in range(rows):
            along = 0
            for x in range(columns):
                starts[c, y, x] = total
                total += tally[y, x]
                along += tally[y, x]
                area[c, y + 1, x + 1] = area[c, y, x + 1] + along
            starts[c, y, columns] = total
        tally[:] = 0
        for i in range(classes[c], classes[c + 1]):
            y, x = where[i, 0], where[i, 1]
            members[starts[c, y, x] + tally[y, x]] = i
            tally[y, x] += 1
    return Cells(classes, left, top, cell, starts, members, area)


@inner_kernel
def count_pairs(table: FloatArray, cells: Cells, share: float) -> float:
    """Return how many pairs of arcs may be near enough for a share; rather more than too few."""
    classes, area, side = cells.classes, cells.area, cells.side
    rows, columns = area.shape[1] - 1, area.shape[2] - 1
    total = 0.0
    for own in range(len(classes) - 1):
        for i in range(classes[own], classes[own + 1]):
            x = (table[i, MIDDLE] - cells.left) / side
            y = (table[i, MIDDLE + 1] - cells.top) / side
            for c in range(own, len(classes) - 1):
                reach = 0.5 * (table[i, SIZE] + table[classes[c], SIZE]) / (share * side)
                x0, x1 = max(0, int(x - reach)), min(columns, int(x + reach) + 1)
                y0, y1 = max(0, int(y - reach)), min(rows, int(y + reach) + 1)
                number = area[c, y1, x1] - area[c, y0, x1] - area[c, y1, x0] + area[c, y0, x0]
                total += 0.5 * (number - 1) if c == own else number
    return total


@inner_kernel
def admitted_share(table: FloatArray, cells: Cells, rules: PairRules) -> tuple[float, float]:
    """Return the least share that leaves `max_pairs` pairs, and the pairs at `min_share`.

    Arcs far apart for their lengths can make up little of an ellipse: they go first.
    """
    every = 0.5 * len(table) * (len(table) - 1.0)
    if every <= rules.max_pairs:
        return rules.min_share, every
    every = count_pairs(table, cells, rules.min_share)
    if every <= rules.max_pairs:
        return rules.min_share, every
    low, high = rules.min_share, max(2.0, 2.0 * rules.min_share)
    for _ in range(BISECTIONS):
        middle = math.sqrt(low * high)
        if count_pairs(table, cells, middle) <= rules.max_pairs:
            high = middle
        else:
            low = middle
    return high, every


@inner_kernel
def row_range(
    arc: FloatArray, slack: float, top: float, bottom: float, low: float, high: float
) -> tuple[float, float]:
    """Return the part of [low, high] on the rows [top, bottom] in an arc's search region."""
    for k in range(4):
        normal = CHORD if k == 3 else INWARDS + 2 * k
        nx, ny = arc[normal], arc[normal + 1]
        place = PLACES if k == 3 else PLACES + 2 * k  # the chord starts where the arc does
        limit = arc[place] * nx + arc[place + 1] * ny - slack
        limit -= max(ny * top, ny * bottom)
        if nx > LEVEL:
            low = max(low, limit / nx)
        elif nx < -LEVEL:
            high = min(high, limit / nx)
        elif limit > LEVEL * max(abs(low), abs(high)):
            return 1.0, 0.0
    return low, high


@inner_kernel
def find_partners(
    table: FloatArray,
    cells: Cells,
    i: int,
    own: int,
    share: float,
    drift: float,
    rules: PairRules,
    most: int,
    partners: IntArray,
) -> tuple[int, int]:
    """Write the arcs after arc i that may belong to it; return their number and those looked at.

    The arc is of class `own`. Cells outside the circle around it or outside its search region are
    passed over. `drift` is how far the middle that a cell is chosen by may be from that which
    `sees` tests. At most `most` pairs are looked at.
    """
    a = table[i]
    classes, starts, members, slack = cells.classes, cells.starts, cells.members, rules.slack
    rows, columns = starts.shape[1], starts.shape[2] - 1
    left, top, cell = cells.left, cells.top, cells.side
    looked = count = 0
    for c in range(own, len(classes) - 1):
        reach = 0.5 * (a[SIZE] + table[classes[c], SIZE]) / share
        y0 = max(0, int((a[MIDDLE + 1] - reach - top) / cell))
        y1 = min(rows, int((a[MIDDLE + 1] + reach - top) / cell) + 1)
        for y in range(y0, y1):
            high, low = a[MIDDLE] + reach, a[MIDDLE] - reach
            above = top + y * cell - 1e-6
            low, high = row_range(a, slack + drift, above, above + cell + 2e-6, low, high)
            if high < low:
                continue
            x0 = max(0, int((low - 1e-6 - left) / cell))
            x1 = min(columns, int((high + 1e-6 - left) / cell) + 1)
            if x1 <= x0 or high < left - 1e-6:
                continue
            for at in range(starts[c, y, x0], starts[c, y, x1]):
                j = members[at]
                if j <= i:
                    continue
                b = table[j]
                dx, dy = a[MIDDLE] - b[MIDDLE], a[MIDDLE + 1] - b[MIDDLE + 1]
                near = 0.5 * (a[SIZE] + b[SIZE]) / share
                if dx * dx + dy * dy > near * near or (rules.signed and a[POLARITY] != b[POLARITY]):
                    continue
                if looked == most:
                    return count, looked
                looked += 1
                if sees(a, b, slack) and sees(b, a, slack):
                    partners[count] = j
                    count += 1
    return count, looked


@kernel
def pair_arcs(
    points: FloatArray,
    order: IntArray,
    ends: IntArray,
    table: FloatArray,
    moments: FloatArray,
    rules: PairRules,
) -> tuple[IntArray, FloatArray, int, float, float]:
    """Return candidates (arc, arc or -1), (rank, ellipse), and the work done.

    Two arcs make a candidate when each lies in the other's search region and one ellipse fits
    both. Arcs further apart than an ellipse of which they are a share `min_share` are not looked
    at. The work: the pairs looked at, those that there were (rather more than too few) and the
    share asked for to keep within `max_pairs`. The arcs come longest first.
    """
    arcs = np.empty((ROOM, 2), np.int64)
    values = np.empty((ROOM, 6))
    found = looked = own = 0
    if len(table) == 0:
        return arcs[:0], values[:0], 0, 0.0, rules.min_share
    cells = cells_of(table)
    share, every = admitted_share(table, cells, rules)
    drift = 0.0
    for i in range(len(table)):
        x, y = table[i, PLACES + 2] - table[i, MIDDLE], table[i, PLACES + 3] - table[i, MIDDLE + 1]
        drift = max(drift, math.hypot(x, y))
    samples = sample_arcs(points, order, ends)
    partners = np.empty(len(table), np.int64)
    pairs = np.empty((2, BATCH), np.int64)
    work = np.empty(WORK)
    few = len(table) <= FEW and 0.5 * len(table) * (len(table) - 1.0) <= rules.max_pairs
    columns = table.T.copy()
    marks = np.empty(len(table), np.int8)
    waiting = 0
    for i in range(len(table)):
        while i >= cells.classes[own + 1]:
            own += 1
        if few:
            count, more = partners_of_few(table, columns, i, share, rules, marks, partners)
        else:
            count, more = find_partners(
                table, cells, i, own, share, drift, rules, rules.max_pairs - looked, partners
            )
        looked += more
        # Here and not below: a loop that may replace arrays counts references in each round.
        while found + waiting + count + 1 > len(arcs):
            arcs = np.concatenate((arcs, np.empty_like(arcs)))
            values = np.concatenate((values, np.empty_like(values)))
        for k in range(-1, count):
            pairs[0, waiting], pairs[1, waiting] = i, (partners[k] if k >= 0 else -1)
            waiting += 1
            if waiting < BATCH and (k + 1 < count or i + 1 < len(table)):
                continue
            found += fit_pairs(
                samples, table, moments, pairs, waiting, rules, work, arcs[found:], values[found:]
            )
            waiting = 0
    return arcs[:found], values[:found], looked, every, share
