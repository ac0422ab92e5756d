"""Kernels that thin an edge map, cut its junctions and follow its branches."""

from __future__ import annotations

from typing import Any

import numpy as np

from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.edges._kernels_pixels import NONE


@inner_kernel
def ring(edges: Any, x: Any, y: Any) -> Any:
    """Return the number of edge pixels around one pixel and of the separate runs they form.

    Runs are counted as 8-connected: two pixels at the sides of a corner belong together.
    """
    height, width = edges.shape
    bits = 0
    place = 1
    for k in range(8):  # east, south-east, south, ... once round
        i = (1, 1, 0, -1, -1, -1, 0, 1)[k]
        j = (0, 1, 1, 1, 0, -1, -1, -1)[k]
        if 0 <= x + i < width and 0 <= y + j < height and edges[y + j, x + i]:
            bits |= place
        place *= 2
    count = 0
    runs = 0
    for k in range(8):
        count += (bits >> k) & 1
        if k % 2 == 0 and (bits >> k) & 1 == 0:
            # a run ends at a side pixel that is missing, after a corner or a side
            runs += 1 if ((bits >> ((k + 1) % 8)) & 1 or (bits >> ((k + 2) % 8)) & 1) else 0
    if runs == 0 and count > 0:
        runs = 1
    return count, runs


@kernel
def thin(edges: Any, xs: Any, ys: Any, order: Any) -> Any:
    """Return the edge map without the pixels that it stays connected without, in that order."""
    lean = edges.copy()
    changed = True
    while changed:
        changed = False
        for k in order:
            x, y = xs[k], ys[k]
            if lean[y, x]:
                count, runs = ring(lean, x, y)
                if runs == 1 and 2 <= count < 7:
                    lean[y, x] = False
                    changed = True
    return lean


@kernel
def cut_junctions(lean: Any, xs: Any, ys: Any) -> Any:
    """Return a thin edge map without the pixels where three or more branches meet."""
    parted = lean.copy()
    for k in range(len(xs)):
        if lean[ys[k], xs[k]]:
            _, runs = ring(lean, xs[k], ys[k])
            if runs >= 3:
                parted[ys[k], xs[k]] = False
    return parted


@kernel
def follow(parted: Any, index: Any, count: Any) -> Any:
    """Return links between neighbours of a thin edge map: each pixel in one chain at most."""
    height, width = parted.shape
    before = np.full(count, NONE, np.uint32)
    after = np.full(count, NONE, np.uint32)
    seen = np.zeros(count, np.bool_)
    for y in range(height):
        for x in range(width):
            if not parted[y, x] or seen[index[y, x]]:
                continue
            seen[index[y, x]] = True
            for way in range(2):  # onwards from the seed, then back from it
                px: Any = x
                py: Any = y
                moving = True
                while moving:
                    moving = False
                    k = index[py, px]
                    for step in range(8):  # sides first, then corners
                        i = (1, 0, -1, 0, 1, -1, -1, 1)[step]
                        j = (0, 1, 0, -1, 1, 1, -1, -1)[step]
                        qx, qy = px + i, py + j
                        if not (0 <= qx < width and 0 <= qy < height) or not parted[qy, qx]:
                            continue
                        m = index[qy, qx]
                        if seen[m]:
                            continue
                        seen[m] = True
                        if way == 0:
                            after[k] = m
                            before[m] = k
                        else:
                            before[k] = m
                            after[m] = k
                        px, py = qx, qy
                        moving = True
                        break
    return before, after
