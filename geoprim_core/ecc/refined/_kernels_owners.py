"""Kernels of the `refined` scheme: which verified ellipses the smooth arcs belong to."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from geoprim_core._check import IntArray
from geoprim_core._jit import inner_kernel, kernel
from geoprim_core.ecc.refined._kernels_points import arcs_of_points

SLOTS = 8  # verified ellipses remembered for each arc
OWNED = 0.7  # an arc belongs to an ellipse that this share of its points support
TAKEN = 0.9  # and is taken by a sure one that this share supports: no other may need the rest


class Owners(NamedTuple):
    """Which verified ellipses the arcs belong to.

    Attributes
    ----------
    arc_of : (N,) int64
        The arc that each edge point is on, -1 for none.
    sizes : (A,) int64
        Number of points of each arc.
    ellipses : (A, SLOTS) int64
        The last ellipses that each arc belongs to.
    owned : (A,) int64
        As many ellipses each arc has belonged to.
    taken : (A,) int64
        1 for the arcs that an ellipse has taken.
    tries : (A,) int64
        How many candidates of each arc have failed.
    tally : (A,) int64
        Room to count in, of zeros.
    """

    arc_of: IntArray
    sizes: IntArray
    ellipses: IntArray
    owned: IntArray
    taken: IntArray
    tries: IntArray
    tally: IntArray


@kernel
def no_owners(order: IntArray, ends: IntArray, total: int) -> Owners:
    """Return the state before any ellipse is verified, of arcs on some of `total` edge points."""
    sizes = ends[1:] - ends[:-1]
    count = len(sizes)
    room = np.zeros((4, count), np.int64)
    slots = np.empty((count, SLOTS), np.int64)
    arc_of = arcs_of_points(order, ends, total)
    return Owners(arc_of, sizes, slots, room[0], room[1], room[2], room[3])


@inner_kernel
def share_owner(owners: Owners, i: int, j: int) -> bool:
    """Tell whether two arcs (or one, j < 0) already belong to one verified ellipse."""
    if j < 0:
        return bool(owners.owned[i] > 0)
    for k in range(min(SLOTS, owners.owned[i])):
        for m in range(min(SLOTS, owners.owned[j])):
            if owners.ellipses[i, k] == owners.ellipses[j, m]:
                return True
    return False


@inner_kernel
def is_settled(owners: Owners, i: int, j: int, max_tries: int) -> bool:
    """Tell whether two arcs, or one (j < 0), need no further candidate.

    One of them is taken, both belong to one verified ellipse, or both have failed too often.
    """
    if owners.taken[i] or (j >= 0 and owners.taken[j]) or share_owner(owners, i, j):
        return True
    return bool(min(owners.tries[i], owners.tries[max(i, j)]) >= max_tries)


@inner_kernel
def note_failure(owners: Owners, i: int, j: int) -> None:
    """Note that a candidate of two arcs, one (j < 0) or none (i < 0) has failed."""
    if i >= 0:
        owners.tries[i] += 1
        owners.tries[max(i, j)] += 1 if j > i else 0


@inner_kernel
def note_owner(owners: Owners, chosen: IntArray, count: int, ellipse: int, strong: bool) -> None:
    """Note for each arc that supports an ellipse with most of its points that it belongs to it."""
    for k in range(count):
        if owners.arc_of[chosen[k]] >= 0:
            owners.tally[owners.arc_of[chosen[k]]] += 1
    for k in range(count):
        arc = owners.arc_of[chosen[k]]
        if arc >= 0 and owners.tally[arc] > 0:
            if owners.tally[arc] > OWNED * owners.sizes[arc]:
                owners.ellipses[arc, owners.owned[arc] % SLOTS] = ellipse
                owners.owned[arc] += 1
                if strong and owners.tally[arc] > TAKEN * owners.sizes[arc]:
                    owners.taken[arc] = 1
            owners.tally[arc] = 0
