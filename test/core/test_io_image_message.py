"""Images in and out of messages: every encoding, padding, byte order, and what is refused."""

import struct
import zlib
from types import SimpleNamespace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import ImageError
from geoprim_core.io.image_message import (
    ENCODINGS,
    image_from_message,
    image_record,
    image_to_fields,
)

FORMS = {
    "mono8": (np.uint8, 1),
    "8UC1": (np.uint8, 1),
    "mono16": (np.uint16, 1),
    "16UC1": (np.uint16, 1),
    "32FC1": (np.float32, 1),
    "64FC1": (np.float64, 1),
    "8UC3": (np.uint8, 3),
    "bgr8": (np.uint8, 3),
    "rgb8": (np.uint8, 3),
    "bgra8": (np.uint8, 4),
    "rgba8": (np.uint8, 4),
    "bgr16": (np.uint16, 3),
    "16UC3": (np.uint16, 3),
    "rgb16": (np.uint16, 3),
    "bgra16": (np.uint16, 4),
    "rgba16": (np.uint16, 4),
}
YUV = {"yuv422": 1, "uyvy": 1, "yuv422_yuy2": 0, "yuyv": 0}  # place of the grey level
BAYER = [name for name in ENCODINGS if name.startswith("bayer")]


def message(image, encoding, padding=0, big=False):
    """Return an Image message built byte by byte."""
    ordered = image.astype(image.dtype.newbyteorder(">" if big else "<"))
    rows = [row.tobytes() + b"\xaa" * padding for row in ordered]
    return SimpleNamespace(
        height=image.shape[0],
        width=image.shape[1],
        encoding=encoding,
        is_bigendian=int(big),
        step=len(rows[0]),
        data=b"".join(rows),
    )


def random_image(encoding, height, width, seed=0):
    kind, channels = FORMS[encoding]
    random = np.random.default_rng(seed)
    shape = (height, width) if channels == 1 else (height, width, channels)
    values = random.integers(0, 65536 if kind == np.uint16 else 256, shape)
    return values.astype(kind)


def in_bgr(image, encoding):
    order = {"rgb": [2, 1, 0], "rgba": [2, 1, 0], "bgra": [0, 1, 2]}.get(encoding.rstrip("816"))
    return image if order is None else image[:, :, order]


def test_every_encoding_is_tested():
    assert set(ENCODINGS) == set(FORMS) | set(BAYER) | set(YUV)


@pytest.mark.parametrize("encoding", FORMS)
@given(
    height=st.integers(1, 7),
    width=st.integers(1, 9),
    padding=st.integers(0, 5),
    big=st.booleans(),
    seed=st.integers(0, 99),
)
@settings(max_examples=15, deadline=None)
def test_pixels_come_out_whatever_padding_and_byte_order(
    encoding, height, width, padding, big, seed
):
    image = random_image(encoding, height, width, seed)
    read = image_from_message(message(image, encoding, padding, big))
    assert read.dtype == image.dtype
    assert read.dtype.isnative
    np.testing.assert_array_equal(read, in_bgr(image, encoding))


@pytest.mark.parametrize("encoding", FORMS)
def test_what_is_written_is_read_back(encoding):
    image = random_image(encoding, 5, 7)
    record = image_record(image, 5, "camera", encoding)
    assert record.encoding == encoding
    assert record.step * record.height == len(record.data)
    np.testing.assert_array_equal(image_from_message(record), in_bgr(image, encoding))


@pytest.mark.parametrize("encoding", ["mono8", "bgr8", "mono16", "32FC1"])
def test_gray_and_bgr_are_views(encoding):
    sent = message(random_image(encoding, 6, 5), encoding, padding=3)
    sent.data = np.frombuffer(sent.data, np.uint8)
    assert np.shares_memory(image_from_message(sent), sent.data)


@pytest.mark.parametrize("encoding", BAYER)
def test_a_plain_colour_survives_the_bayer_pattern(encoding):
    """Where one pattern were taken for another, the channels would be swapped or mixed."""
    bgr = {"r": 200, "g": 120, "b": 40}
    kind = np.uint16 if encoding.endswith("16") else np.uint8
    tile = np.array([bgr[c] for c in encoding.removeprefix("bayer_")[:4]], kind).reshape(2, 2)
    image = image_from_message(message(np.tile(tile, (8, 8)), encoding))
    assert image.shape == (16, 16, 3)
    assert image.dtype == kind
    assert (image == (40, 120, 200)).all()


@pytest.mark.parametrize(("encoding", "place"), YUV.items())
def test_colours_of_usb_cameras_are_read(encoding, place):
    """Blue, of Y 41, U 240, V 110 by ITU-R BT.601, then grey on the next two pixels."""
    pixels = np.full((2, 4, 2), 128, np.uint8)
    pixels[:, :2, place] = 41
    pixels[:, 0, 1 - place], pixels[:, 1, 1 - place] = 240, 110
    image = image_from_message(message(pixels, encoding, padding=3)).astype(int)
    assert image.shape == (2, 4, 3)
    assert np.abs(image[:, :2] - [255, 0, 0]).max() <= 3
    assert np.abs(image[:, 2:] - 130).max() <= 1
    with pytest.raises(ImageError, match="width: expected an even number, as two pixels share"):
        image_from_message(message(pixels[:, :3], encoding))


def test_the_padding_of_the_last_row_may_be_absent():
    image = random_image("mono8", 3, 4)
    sent = message(image, "mono8", padding=4)
    sent.data = sent.data[:-4]
    np.testing.assert_array_equal(image_from_message(sent), image)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"encoding": "nv21"}, "encoding: expected one of mono8.*'nv21'"),
        ({"encoding": ""}, "encoding"),
        ({"height": 0}, "at least one pixel, got 6 x 0"),
        ({"width": 0}, "at least one pixel, got 0 x 4"),
        ({"step": 17}, "step: expected at least 18 bytes.*got 17"),
        ({"data": b""}, "data: expected 72 bytes.*got 0"),
        ({"data": bytes(71)}, "data: expected 72 bytes.*got 71"),
        ({"height": 2**31, "step": 2**31}, "data: expected"),
    ],
)
def test_messages_that_cannot_be_images_are_refused(changes, text):
    sent = message(random_image("bgr8", 4, 6), "bgr8")
    for name, value in changes.items():
        setattr(sent, name, value)
    with pytest.raises(ImageError, match=text):
        image_from_message(sent)


def test_a_bayer_image_too_small_to_demosaic_is_refused():
    with pytest.raises(ImageError, match="3 x 3"):
        image_from_message(message(np.zeros((2, 2), np.uint8), "bayer_rggb8"))


def test_an_encoding_that_does_not_fit_the_array_is_refused():
    with pytest.raises(ImageError, match=r"encoding rgb8.*\(4, 4\)"):
        image_to_fields(np.zeros((4, 4), np.uint8), "rgb8")
    with pytest.raises(ImageError, match=r"bgra16, got .*float32"):
        image_to_fields(np.zeros((4, 4, 3), np.float32))


def test_nan_pixels_travel():
    depth = np.full((3, 4), np.nan, np.float32)
    np.testing.assert_array_equal(image_from_message(image_record(depth, 0, "camera")), depth)


@pytest.mark.parametrize("image", [np.zeros((0, 4), np.uint8), np.zeros(4, np.uint8), [[1]]])
def test_what_is_no_image_is_not_written(image):
    with pytest.raises(ImageError, match=r"image: expected an array \(H, W\)"):
        image_to_fields(image)


def test_compressed_images_are_decoded():
    gray = random_image("mono8", 9, 8)
    bgra = random_image("bgra8", 9, 8)
    deep = random_image("mono16", 9, 8)
    for image, expected in ((gray, gray), (bgra, bgra[:, :, :3]), (deep, deep)):
        data = cv2.imencode(".png", image)[1].tobytes()
        sent = SimpleNamespace(format="png", data=data)
        np.testing.assert_array_equal(image_from_message(sent), expected)


def test_what_image_transport_writes_as_format_is_understood():
    """Colours are stored as BGR whatever they were; a mosaic is stored as it is."""
    bgr = random_image("bgr8", 9, 8)
    data = cv2.imencode(".png", bgr)[1].tobytes()
    sent = SimpleNamespace(format="rgb8; png compressed bgr8", data=data)
    np.testing.assert_array_equal(image_from_message(sent), bgr)
    mosaic = random_image("mono8", 8, 10)
    data = cv2.imencode(".png", mosaic)[1].tobytes()
    sent = SimpleNamespace(format="bayer_grbg8; png compressed ", data=data)
    raw = image_from_message(message(mosaic, "bayer_grbg8"))
    np.testing.assert_array_equal(image_from_message(sent), raw)


def test_the_bits_of_16_bit_images_are_kept():
    """A camera of 12 bits in mono16: no range is assumed when the message is read."""
    image = random_image("mono16", 4, 5) >> 4
    np.testing.assert_array_equal(image_from_message(message(image, "mono16", big=True)), image)


def _huge_png():
    header = struct.pack(">IIBBBBB", 2**31 - 1, 2**31 - 1, 8, 2, 0, 0, 0)
    chunks = [(b"IHDR", header), (b"IDAT", b""), (b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(d)) + t + d + struct.pack(">I", zlib.crc32(t + d)) for t, d in chunks
    )


@pytest.mark.parametrize("data", [b"", b"not a picture", b"\x89PNG\r\n\x1a\n", _huge_png()])
def test_compressed_images_that_cannot_be_decoded_are_refused(data):
    with pytest.raises(ImageError, match="JPEG, PNG"):
        image_from_message(SimpleNamespace(format="png", data=data))
