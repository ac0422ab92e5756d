"""Images of a trial: of several sizes and encodings, and some that no node can use."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from geoprim_core._check import AnyArray
from geoprim_core.io.definitions import serialize
from geoprim_core.io.image_message import image_record
from geoprim_core.io.record import Record
from geoprim_core.synthetic import disc_image

SIZES = ((320, 240), (160, 120), (241, 181), (400, 300))
_STAMP = struct.Struct("<iI")
_STAMP_AT = 4  # after the bytes that tell the encoding
_SCENES = 4
_BAD_SHARE = 0.02


@dataclass(frozen=True)
class Frame:
    """A serialised sensor_msgs/msg/Image; `good` where a node can use it."""

    data: bytes
    good: bool = True

    def at(self, stamp_ns: int) -> bytes:
        """Return the message with a stamp."""
        stamp = _STAMP.pack(*divmod(stamp_ns, 1_000_000_000))
        return self.data[:_STAMP_AT] + stamp + self.data[_STAMP_AT + _STAMP.size :]


def frames(seed: int) -> Iterator[Frame]:
    """Return frames without end, drawn at random; one in fifty cannot be used."""
    draw = np.random.default_rng(seed)
    good, bad = _good(draw), _bad()
    while True:
        pool = bad if draw.random() < _BAD_SHARE else good
        yield pool[draw.integers(len(pool))]


def _good(draw: np.random.Generator) -> list[Frame]:
    found = []
    for width, height in SIZES:
        for _ in range(_SCENES):
            radius = height * draw.uniform(0.1, 0.35)
            centre = tuple(draw.uniform(0.4, 0.6, 2) * (width, height))
            gray = disc_image(width, height, centre=centre, radius=radius)
            found += [_frame(image, encoding) for encoding, image in _encoded(gray).items()]
    return found


def _encoded(gray: AnyArray) -> dict[str, AnyArray]:
    colour = np.repeat(gray[:, :, None], 3, axis=2)
    return {
        "mono8": gray,
        "bgr8": colour,
        "rgb8": colour,
        "bgra8": np.concatenate([colour, colour[:, :, :1]], axis=2),
        "mono16": gray.astype(np.uint16) * 250,
        "32FC1": gray.astype(np.float32) / 255,
    }


def _bad() -> list[Frame]:
    gray = disc_image(*SIZES[0], centre=(160.0, 120.0), radius=50.0)
    nothing = {"width": 0, "height": 0, "step": 0, "data": np.zeros(0, np.uint8)}
    changes: list[dict[str, Any]] = [
        {"encoding": "yuv_strange"},
        {"step": 10},
        {"data": np.zeros(100, np.uint8)},
        nothing,
        {"encoding": "32FC1", "step": gray.shape[1] * 4, "data": _nan_bytes(gray.size)},
    ]
    return [replace(_frame(gray, "mono8", change), good=False) for change in changes]


def _nan_bytes(count: int) -> AnyArray:
    return np.full(count, np.nan, np.float32).view(np.uint8)


def _frame(image: AnyArray, encoding: str, changes: dict[str, Any] | None = None) -> Frame:
    record = image_record(image, 0, "camera", encoding)
    return Frame(serialize(Record(record.type, {**record.fields, **(changes or {})})))
