"""A viewer: what Foxglove does with the live view, by hand."""

import json
import struct
import time

import numpy as np
import pytest

_DOUBLE, _BYTES, _FLOAT = 1, 2, 5


def wire_fields(data):
    """Return field number -> values of a protobuf message; what is nested stays bytes."""
    fields, at = {}, 0

    def varint():
        nonlocal at
        value = shift = 0
        while True:
            byte = data[at]
            at += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value

    while at < len(data):
        key = varint()
        kind = key & 7
        if kind == _BYTES:
            size = varint()
            value = data[at : at + size]
            at += size
        elif kind in (_DOUBLE, _FLOAT):
            size = 8 if kind == _DOUBLE else 4
            (value,) = struct.unpack("<d" if kind == _DOUBLE else "<f", data[at : at + size])
            at += size
        else:
            value = varint()
        fields.setdefault(key >> 3, []).append(value)
    return fields


def read_annotations(data):
    """Return lines (type, points, colour) and texts of a foxglove.ImageAnnotations."""
    message = wire_fields(data)
    lines = []
    for part in map(wire_fields, message.get(2, ())):
        points = [wire_fields(p) for p in part.get(3, ())]
        colour = wire_fields(part[4][0])
        lines.append(
            (
                part[2][0],
                np.array([(p.get(1, [0.0])[0], p.get(2, [0.0])[0]) for p in points]),
                [colour.get(k, [0.0])[0] for k in (1, 2, 3)],
            )
        )
    return lines, [wire_fields(t)[3][0].decode() for t in message.get(3, ())]


class Viewer:
    """A websocket client that speaks Foxglove's protocol."""

    def __init__(self, port):
        from websockets.sync.client import connect

        self._connection = connect(f"ws://127.0.0.1:{port}", subprotocols=["foxglove.sdk.v1"])
        self._socket = self._connection.__enter__()
        self.channels = {}
        self._topics = {}

    def wait_for(self, *topics):
        """Read until topics are there."""
        while not set(topics) <= set(self.channels):
            message = json.loads(self._socket.recv(timeout=20))
            if message["op"] == "advertise":
                self.channels |= {c["topic"]: c for c in message["channels"]}

    def look_at(self, *topics):
        """Subscribe."""
        self.wait_for(*topics)
        wanted = [{"id": k, "channelId": self.channels[t]["id"]} for k, t in enumerate(topics)]
        self._topics = dict(enumerate(topics))
        self._socket.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))

    def see(self, *topics, timeout=30.0):
        """Return the next message of each topic: bytes."""
        seen, end = {}, time.monotonic() + timeout
        while not set(topics) <= set(seen):
            data = self._socket.recv(timeout=max(0.01, end - time.monotonic()))
            if isinstance(data, bytes) and data[0] == 1:
                number, _ = struct.unpack("<IQ", data[1:13])
                seen[self._topics[number]] = data[13:]
        return seen

    def close(self):
        self._connection.__exit__(None, None, None)


@pytest.fixture
def viewer():
    """Connect to a port as Foxglove does."""
    pytest.importorskip("foxglove")
    pytest.importorskip("websockets")
    made = []

    def connect(port):
        made.append(Viewer(port))
        return made[-1]

    yield connect
    for one in made:
        one.close()


@pytest.fixture
def annotations_of():
    """Decode a foxglove.ImageAnnotations."""
    return read_annotations
