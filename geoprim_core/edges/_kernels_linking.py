"""Kernels that link edge pixels by their gradient and write the contours."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from geoprim_core._jit import kernel
from geoprim_core.edges._kernels_pixels import SUBPIXEL_STEPS

EXCESS_SHARE = 0.5


@kernel
def find_steps(
    xs: Any,
    ys: Any,
    index: Any,
    offset: Any,
    normal: Any,
    double: Any,
    turn_cosine: Any,
    reach: Any,
    sideways: Any,
) -> Any:
    """Return the steps that a contour may take: from, to (M,) int32, cost, cosine (M,) float32.

    A step leads along the edge, with the brighter side on the right hand as seen on the screen,
    to a pixel within `reach` whose gradient has at least the cosine `turn_cosine` with its own.
    Pixels marked `double` take no part.
    """
    count = len(xs)
    height, width = index.shape
    source = np.empty(count + 16, np.int32)
    target = np.empty(count + 16, np.int32)
    figures = np.empty((count + 16, 2), np.float32)
    size = 0
    reach_squared = reach * reach
    for k in range(count):
        if double[k]:
            continue
        x, y = xs[k], ys[k]
        nx, ny = normal[k, 0], normal[k, 1]
        if size + 12 > len(source):
            more = len(source) // 2
            source = np.concatenate((source, np.empty(more, np.int32)))
            target = np.concatenate((target, np.empty(more, np.int32)))
            figures = np.concatenate((figures, np.empty((more, 2), np.float32)))
        for j in range(min(3, height - y)):
            for i in range(max(-2 if j else 1, -x), min(3, width - x)):
                if i * i + j * j > reach_squared:
                    continue
                m = index[y + j, x + i]
                if m < 0 or double[m]:
                    continue
                mx, my = normal[m, 0], normal[m, 1]
                cosine = nx * mx + ny * my
                if cosine < turn_cosine:
                    continue
                ex = i + offset[m, 0] - offset[k, 0]
                ey = j + offset[m, 1] - offset[k, 1]
                scale = 1.0 / math.sqrt(2.0 + 2.0 * cosine)
                along = (ex * (ny + my) - ey * (nx + mx)) * scale
                across = abs(ex * (nx + mx) + ey * (ny + my)) * scale
                if across > sideways * abs(along) or abs(along) < 0.3:
                    continue
                source[size] = k if along > 0.0 else m
                target[size] = m if along > 0.0 else k
                figures[size, 0] = abs(along) + across + 4.0 * (1.0 - cosine)
                figures[size, 1] = cosine
                size += 1
    return source[:size], target[:size], figures[:size, 0].copy(), figures[:size, 1].copy()


@kernel
def chain(source: Any, target: Any, cost: Any, chosen: Any, before: Any, after: Any) -> None:
    """Fill in, in place, the pixel before and after each edge pixel on its contour; -1: none.

    Of the chosen steps that are still open the cheapest is taken first: in rounds, those that are
    the best one both for the pixel they leave and for the one they reach.
    """
    best_after = np.full(len(after), -1, np.int32)
    best_before = np.full(len(after), -1, np.int32)
    open_steps: Any = np.flatnonzero(chosen).astype(np.int32)
    while True:
        kept = 0
        for p in open_steps:
            first, second = source[p], target[p]
            if after[first] != -1 or before[second] != -1:
                continue
            open_steps[kept] = p
            kept += 1
            if best_after[first] < 0 or cost[p] < cost[best_after[first]]:
                best_after[first] = p
            if best_before[second] < 0 or cost[p] < cost[best_before[second]]:
                best_before[second] = p
        open_steps = open_steps[:kept]
        if kept == 0:
            break
        for p in open_steps:
            if best_after[source[p]] == p and best_before[target[p]] == p:
                after[source[p]] = target[p]
                before[target[p]] = source[p]
        for p in open_steps:
            best_after[source[p]] = -1
            best_before[target[p]] = -1


@kernel
def bend(normal: Any, k: Any, m: Any) -> Any:
    """Return the signed angle from one gradient to another."""
    cross = normal[k, 0] * normal[m, 1] - normal[k, 1] * normal[m, 0]
    return math.atan2(cross, normal[k, 0] * normal[m, 0] + normal[k, 1] * normal[m, 1])


@kernel
def cut_corners(normal: Any, before: Any, after: Any, max_turn: Any) -> None:
    """Undo, in place, links that turn by over `max_turn` where the contour around them does not.

    A link stays where the mean turn of the three links before and the three after it comes
    within half of `max_turn` of its own: a small circle, but not a corner or a crossing.
    """
    for k in range(len(after)):
        m = after[k]
        if m < 0:
            continue
        turn = bend(normal, k, m)
        if abs(turn) <= max_turn:
            continue
        total = 0.0
        first, last = k, m
        for _ in range(3):
            if before[first] >= 0:
                total += bend(normal, before[first], first)
                first = before[first]
            if after[last] >= 0:
                total += bend(normal, last, after[last])
                last = after[last]
        expected = total / 6.0
        if abs(turn - expected) > EXCESS_SHARE * max_turn:
            after[k] = -1
            before[m] = -1


@kernel
def straighten(points: Any, fine: Any, angle: Any) -> Any:
    """Take the corner pixels out of stairs, in place, and return how many pixels are left.

    A pixel goes where those before and after it touch each other; of two such pixels in a row
    the one farther from the edge goes.
    """
    count = len(points)
    kept = min(1, count)
    for k in range(1, count):
        drop = False
        if k + 1 < count:
            drop = (
                abs(points[k + 1, 0] - points[kept - 1, 0]) <= 1.0
                and abs(points[k + 1, 1] - points[kept - 1, 1]) <= 1.0
            )
        if drop and k + 2 < count:
            rival = (
                abs(points[k + 2, 0] - points[k, 0]) <= 1.0
                and abs(points[k + 2, 1] - points[k, 1]) <= 1.0
            )
            if rival:
                here = (fine[k, 0] - points[k, 0]) ** 2 + (fine[k, 1] - points[k, 1]) ** 2
                there = (fine[k + 1, 0] - points[k + 1, 0]) ** 2
                there += (fine[k + 1, 1] - points[k + 1, 1]) ** 2
                drop = here >= there
        if not drop:
            for c in range(2):
                points[kept, c] = points[k, c]
                fine[kept, c] = fine[k, c]
            angle[kept] = angle[k]
            kept += 1
    return kept


@kernel
def walk(
    xs: Any, ys: Any, offset: Any, normal: Any, before: Any, after: Any, min_length: Any
) -> Any:
    """Return the contours that the links make: pixels, sub-pixel points, gradients, ends, closed.

    Where a link leaps over a pixel, the pixel nearest to its middle is put in.
    """
    count = len(xs)
    seen = np.zeros(count, np.bool_)
    room = count
    for k in range(count):
        m = after[k]
        if m >= 0 and (abs(xs[m] - xs[k]) > 1 or abs(ys[m] - ys[k]) > 1):
            room += 1
    points = np.empty((room, 2), np.float64)
    fine = np.empty((room, 2), np.float64)
    angle = np.empty(room, np.float64)
    ends = np.empty(count, np.int64)
    closed = np.empty(count, np.bool_)
    size = 0
    curves = 0
    for turn in range(2):  # open chains from their heads, then what is left: the rings
        for head in range(count):
            if seen[head] or (turn == 0 and before[head] >= 0):
                continue
            length = 0
            k = head
            while k >= 0 and not seen[k]:
                seen[k] = True
                m = after[k]
                leaps = m >= 0 and (abs(xs[m] - xs[k]) > 1 or abs(ys[m] - ys[k]) > 1)
                length += 2 if leaps else 1
                k = m
            if length < min_length:  # most chains in noise: not worth writing
                continue
            start = size
            k = head
            while True:
                points[size, 0] = xs[k]
                points[size, 1] = ys[k]
                fine[size, 0] = xs[k] + offset[k, 0]
                fine[size, 1] = ys[k] + offset[k, 1]
                angle[size] = np.float32(math.atan2(normal[k, 1], normal[k, 0]))
                size += 1
                m = after[k]
                if m >= 0 and (abs(xs[m] - xs[k]) > 1 or abs(ys[m] - ys[k]) > 1):
                    mid_x = 0.5 * (xs[k] + offset[k, 0] + xs[m] + offset[m, 0])
                    mid_y = 0.5 * (ys[k] + offset[k, 1] + ys[m] + offset[m, 1])
                    fine[size, 0] = math.floor(mid_x * SUBPIXEL_STEPS) / SUBPIXEL_STEPS
                    fine[size, 1] = math.floor(mid_y * SUBPIXEL_STEPS) / SUBPIXEL_STEPS
                    x = max(xs[k], xs[m]) - 1, min(xs[k], xs[m]) + 1
                    y = max(ys[k], ys[m]) - 1, min(ys[k], ys[m]) + 1
                    points[size, 0] = min(max(math.floor(fine[size, 0] + 0.5), x[0]), x[1])
                    points[size, 1] = min(max(math.floor(fine[size, 1] + 0.5), y[0]), y[1])
                    tilt = math.atan2(normal[k, 1] + normal[m, 1], normal[k, 0] + normal[m, 0])
                    angle[size] = np.float32(tilt)
                    size += 1
                k = m
                if k < 0 or k == head:
                    break
            size = start + straighten(points[start:size], fine[start:size], angle[start:size])
            if size - start < min_length:
                size = start
                continue
            near_x = abs(points[size - 1, 0] - points[start, 0]) <= 1.0
            near_y = abs(points[size - 1, 1] - points[start, 1]) <= 1.0
            ends[curves] = size
            closed[curves] = near_x and near_y
            curves += 1
    return points[:size], fine[:size], angle[:size], ends[:curves], closed[:curves]
