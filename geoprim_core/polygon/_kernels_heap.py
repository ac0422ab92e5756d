"""Kernels of a heap of items with keys that change: the least key first, then the least item.

A heap of items 0 .. n-1 is four arrays: `items` in heap order, the `place` of each item in it
(-1: not in it), the `key` of each item, and `size`, of one number. They are passed one by one: a
named tuple would be taken apart, and its arrays counted, at every step.
"""

from __future__ import annotations

from geoprim_core._check import FloatArray, IntArray
from geoprim_core._jit import kernel


@kernel
def _is_less(key: FloatArray, a: int, b: int) -> bool:
    return bool(key[a] < key[b] or (key[a] == key[b] and a < b))


@kernel
def _sift(items: IntArray, place: IntArray, key: FloatArray, size: IntArray, at: int) -> None:
    """Move the item at a place up or down to where it belongs."""
    item, count = items[at], size[0]
    while at > 0 and _is_less(key, item, items[(at - 1) // 2]):
        items[at] = items[(at - 1) // 2]
        place[items[at]] = at
        at = (at - 1) // 2
    while 2 * at + 1 < count:
        child = 2 * at + 1
        if child + 1 < count and _is_less(key, items[child + 1], items[child]):
            child += 1
        if not _is_less(key, items[child], item):
            break
        items[at] = items[child]
        place[items[at]] = at
        at = child
    items[at] = item
    place[item] = at


@kernel
def put(
    items: IntArray, place: IntArray, key: FloatArray, size: IntArray, item: int, value: float
) -> None:
    """Set the key of an item, which enters the heap if it is not in it."""
    key[item] = value
    if place[item] < 0:
        place[item] = size[0]
        items[size[0]] = item
        size[0] += 1
    _sift(items, place, key, size, place[item])


@kernel
def take_out(items: IntArray, place: IntArray, key: FloatArray, size: IntArray, item: int) -> None:
    """Remove an item, if it is there."""
    at = place[item]
    if at < 0:
        return
    size[0] -= 1
    place[item] = -1
    last = items[size[0]]
    if last != item:
        items[at] = last
        place[last] = at
        _sift(items, place, key, size, at)
