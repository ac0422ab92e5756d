"""Images in and out of sensor_msgs/msg/Image and CompressedImage, without cv_bridge.

The functions take any object that has the fields of the message: a ROS message, a decoded bag
message or a `Record`.
"""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np

from geoprim_core._check import AnyArray, describe
from geoprim_core.errors import ImageError
from geoprim_core.io.record import Record, header

# Encoding -> (numpy type, channels, OpenCV conversion to BGR or None where there is nothing to do).
# OpenCV names a Bayer pattern by its second row and column, ROS by its first.
_ENCODINGS: dict[str, tuple[str, int, int | None]] = {
    "mono8": ("u1", 1, None),
    "8UC1": ("u1", 1, None),
    "mono16": ("u2", 1, None),
    "16UC1": ("u2", 1, None),
    "32FC1": ("f4", 1, None),
    "64FC1": ("f8", 1, None),
    "bgr8": ("u1", 3, None),
    "8UC3": ("u1", 3, None),
    "rgb8": ("u1", 3, cv2.COLOR_RGB2BGR),
    "bgra8": ("u1", 4, cv2.COLOR_BGRA2BGR),
    "rgba8": ("u1", 4, cv2.COLOR_RGBA2BGR),
    "bgr16": ("u2", 3, None),
    "16UC3": ("u2", 3, None),
    "rgb16": ("u2", 3, cv2.COLOR_RGB2BGR),
    "bgra16": ("u2", 4, cv2.COLOR_BGRA2BGR),
    "rgba16": ("u2", 4, cv2.COLOR_RGBA2BGR),
    # As USB cameras send: a grey level a pixel, and by turns one of the two colours.
    "yuv422": ("u1", 2, cv2.COLOR_YUV2BGR_UYVY),
    "uyvy": ("u1", 2, cv2.COLOR_YUV2BGR_UYVY),
    "yuv422_yuy2": ("u1", 2, cv2.COLOR_YUV2BGR_YUY2),
    "yuyv": ("u1", 2, cv2.COLOR_YUV2BGR_YUY2),
}
_BAYER = {
    "rggb": cv2.COLOR_BayerBG2BGR,
    "bggr": cv2.COLOR_BayerRG2BGR,
    "gbrg": cv2.COLOR_BayerGR2BGR,
    "grbg": cv2.COLOR_BayerGB2BGR,
}
for _pattern, _conversion in _BAYER.items():
    _ENCODINGS[f"bayer_{_pattern}8"] = ("u1", 1, _conversion)
    _ENCODINGS[f"bayer_{_pattern}16"] = ("u2", 1, _conversion)

ENCODINGS = tuple(_ENCODINGS)
"""The encodings of sensor_msgs/msg/Image that can be read."""

# What an array is written as when no encoding is asked for: (numpy type, channels) -> encoding.
_DEFAULTS = {
    ("u1", 1): "mono8",
    ("u2", 1): "mono16",
    ("f4", 1): "32FC1",
    ("f8", 1): "64FC1",
    ("u1", 3): "bgr8",
    ("u1", 4): "bgra8",
    ("u2", 3): "bgr16",
    ("u2", 4): "bgra16",
}


def image_from_message(message: Any) -> AnyArray:
    """Return the image of a sensor_msgs Image or CompressedImage.

    Parameters
    ----------
    message : object with the fields of the message
        Row padding and byte order are honoured.

    Returns
    -------
    (H, W) or (H, W, 3) array
        Gray, or colour in BGR order; uint8, uint16, float32 or float64 in native byte order.
        A view of the message's data where nothing has to be converted (gray and BGR in native
        byte order). 16-bit and float pixels keep their values: no range is assumed here, as a
        camera of 10 or 12 bits fills only a part of 16. The edge stage stretches them, so that
        the least becomes 0 and the largest 255, frame by frame, and refuses NaN and infinity:
        a depth image has to have its holes filled, with 0 for example.

    Raises
    ------
    ImageError
        The encoding is not known, a side is zero, `step` is too small or data is missing.

    Examples
    --------
    >>> message = image_record(np.eye(2, 3, dtype=np.uint8), stamp_ns=0, frame_id="camera")
    >>> message.encoding, image_from_message(message).tolist()
    ('mono8', [[1, 0, 0], [0, 1, 0]])
    """
    if hasattr(message, "format"):
        return _decompressed(message)
    kind, channels, conversion = _encoding(str(message.encoding))
    array = _rows(message, np.dtype(kind), channels).astype(kind, copy=False)
    if conversion is None:
        return array
    if str(message.encoding).startswith("bayer"):
        return _demosaiced(array, conversion)
    if channels == 2 and array.shape[1] % 2:
        expected = f"an even number, as two pixels share their colour in {message.encoding}"
        raise ImageError("width", expected, f"{array.shape[1]}")
    converted: AnyArray = cv2.cvtColor(np.ascontiguousarray(array), conversion)
    return converted


def image_to_fields(image: AnyArray, encoding: str | None = None) -> dict[str, Any]:
    """Return the fields of sensor_msgs/msg/Image, without the header, that hold an image.

    Parameters
    ----------
    image : (H, W), (H, W, 3) or (H, W, 4) array
        Written as it stands: an encoding names the order of its channels, it converts nothing.
        Pixels may be NaN, as in depth images.
    encoding : str, optional
        Default by type and channels: mono8, mono16, 32FC1, 64FC1, bgr8, bgra8, bgr16 or bgra16.

    Raises
    ------
    ImageError
        The image or the encoding is not supported, or they do not fit each other.
    """
    if not isinstance(image, np.ndarray) or image.ndim not in (2, 3) or image.size == 0:
        raise ImageError("image", "an array (H, W), (H, W, 3) or (H, W, 4)", describe(image))
    channels = 1 if image.ndim == 2 else image.shape[2]
    kind = image.dtype.str[1:]
    name = encoding or _DEFAULTS.get((kind, channels))
    if name is None or _encoding(name)[:2] != (kind, channels):
        expected = f"an image that fits encoding {name or ', '.join(_DEFAULTS.values())}"
        raise ImageError("image", expected, describe(image))
    data = np.ascontiguousarray(image.astype(f"<{kind}", copy=False))
    return {
        "height": image.shape[0],
        "width": image.shape[1],
        "encoding": name,
        "is_bigendian": 0,
        "step": data.strides[0],
        "data": data.reshape(-1).view(np.uint8),
    }


def image_record(
    image: AnyArray, stamp_ns: int, frame_id: str, encoding: str | None = None
) -> Record:
    """Return a sensor_msgs/msg/Image with a header; see `image_to_fields`."""
    fields = image_to_fields(image, encoding)
    return Record("sensor_msgs/msg/Image", {"header": header(stamp_ns, frame_id), **fields})


def _encoding(name: str) -> tuple[str, int, int | None]:
    if name not in _ENCODINGS:
        raise ImageError("encoding", "one of " + ", ".join(ENCODINGS), repr(name))
    return _ENCODINGS[name]


def _demosaiced(mosaic: AnyArray, conversion: int) -> AnyArray:
    if min(mosaic.shape) < 3:
        got = f"{mosaic.shape[1]} x {mosaic.shape[0]}"
        raise ImageError("image", "at least 3 x 3 pixels to demosaic", got)
    colours: AnyArray = cv2.cvtColor(np.ascontiguousarray(mosaic), conversion)
    return colours


def _rows(message: Any, kind: np.dtype[Any], channels: int) -> AnyArray:
    """Return the pixels as a view of the message's data."""
    height, width, step = int(message.height), int(message.width), int(message.step)
    if height < 1 or width < 1:
        raise ImageError("height, width", "at least one pixel", f"{width} x {height}")
    row = width * channels * kind.itemsize
    if step < row:
        expected = f"at least {row} bytes a row of {width} pixels in {message.encoding}"
        raise ImageError("step", expected, f"{step}")
    data = np.frombuffer(message.data, np.uint8)
    needed = step * (height - 1) + row  # the padding of the last row may be absent
    if len(data) < needed:
        raise ImageError("data", f"{needed} bytes for {width} x {height} pixels", f"{len(data)}")
    ordered = kind.newbyteorder(">" if message.is_bigendian else "<")
    shape = (height, width) if channels == 1 else (height, width, channels)
    inner = (kind.itemsize,) if channels == 1 else (channels * kind.itemsize, kind.itemsize)
    view: AnyArray = np.ndarray(shape, ordered, data, strides=(step, *inner))
    return view


def _decompressed(message: Any) -> AnyArray:
    """Return the image of a CompressedImage, gray or BGR.

    `format` is "jpeg" or as image_transport writes it, "rgb8; jpeg compressed bgr8": colours are
    stored as BGR whatever they were, and a Bayer mosaic as it is.
    """
    name = str(message.format)
    data = np.frombuffer(message.data, np.uint8)
    image = None
    if len(data) and "compressedDepth" not in name:
        image = _decoded(data)
    if image is None:
        got = f"{len(data)} bytes of format {name!r}"
        raise ImageError("data", "a compressed image that OpenCV decodes (JPEG, PNG)", got)
    encoding = name.partition(";")[0].strip()
    if encoding.startswith("bayer_") and image.ndim == 2 and encoding in _ENCODINGS:
        return _demosaiced(image, _ENCODINGS[encoding][2] or 0)
    alpha = image.ndim == 3 and image.shape[2] == 4
    decoded: AnyArray = cv2.cvtColor(image, cv2.COLOR_BGRA2BGR) if alpha else image
    return decoded


def _decoded(data: AnyArray) -> AnyArray | None:
    """Return what OpenCV makes of a file's bytes; None where it cannot be read."""
    try:
        image: AnyArray | None = cv2.imdecode(data, cv2.IMREAD_UNCHANGED)
    except cv2.error:  # for one that claims more pixels than OpenCV takes
        return None
    return image
