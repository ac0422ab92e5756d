"""Checks at the public doors: they return the canonical form or raise a clear `InputError`."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from geoprim_core.errors import ImageError, InputError

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
Int32Array = npt.NDArray[np.int32]
Int16Array = npt.NDArray[np.int16]
Int8Array = npt.NDArray[np.int8]
UInt32Array = npt.NDArray[np.uint32]
BoolArray = npt.NDArray[np.bool_]
AnyArray = npt.NDArray[Any]
_FLOAT = np.dtype(np.float64)
_FEW = 4096


def describe(value: object) -> str:
    """Say in a few words what a value is, for the `got` part of a message."""
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape} and type {value.dtype}"
    text = repr(value)
    return f"{text if len(text) <= 60 else text[:57] + '...'} ({type(value).__name__})"


def with_article(noun: str) -> str:
    """Return "a camera", "an ellipse"."""
    return f"{'an' if noun[0].lower() in 'aeio' else 'a'} {noun}"


def _canonical(value: object, shape: tuple[int | None, ...]) -> bool:
    """Tell in a microsecond of an array that it needs no conversion: fits take only a few."""
    return (
        type(value) is np.ndarray
        and value.dtype == _FLOAT  # kernels kept on disk make descriptors of their own
        and value.flags.c_contiguous
        and value.ndim == len(shape)
        and shape[0] in (None, value.shape[0])
        and value.shape[1:] == shape[1:]
    )


def numbers(value: object, argument: str, shape: tuple[int | None, ...]) -> FloatArray:
    """Return `value` as a C-ordered float64 array of `shape` (None: any length)."""
    if _canonical(value, shape):
        return value  # type: ignore[return-value]
    expected = "a numeric array of shape (" + ", ".join("N" if s is None else str(s) for s in shape)
    expected += ",)" if len(shape) == 1 else ")"
    try:
        array = np.ascontiguousarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(argument, expected, describe(value)) from None
    if np.ndim(value) != len(shape) or np.iscomplexobj(value):  # type: ignore[arg-type]
        if not (np.size(value) == 0 and len(shape) == 2):  # type: ignore[arg-type]
            raise InputError(argument, expected, describe(value))
        array = array.reshape(0, shape[1] or 0)
    if any(
        want is not None and want != have for want, have in zip(shape, array.shape, strict=True)
    ):
        raise InputError(argument, expected, describe(value))
    return array


def finite(value: object, argument: str, shape: tuple[int | None, ...]) -> FloatArray:
    """Like `numbers`, and refuse NaN and infinity."""
    array = numbers(value, argument, shape)
    # The product is quick on few numbers, and may overflow where all are finite; on many it would
    # wake the threads of the linear algebra library, which then spin.
    if array.size <= _FEW and math.isfinite(np.vdot(array, array)):
        return array
    if not np.isfinite(array).all():
        where = np.argwhere(~np.isfinite(array))[0]
        index = ", ".join(str(i) for i in where)
        raise InputError(argument, "finite numbers", f"{array[tuple(where)]} at [{index}]")
    return array


def points(value: object, argument: str = "points") -> FloatArray:
    """Return points (x, y) as a finite (N, 2) float64 array."""
    return finite(value, argument, (None, 2))


def integers(value: object, argument: str) -> IntArray:
    """Return a flat array of whole numbers as int64."""
    array = np.asarray(value)
    if array.size == 0:
        return np.zeros(0, np.int64)
    kind = array.dtype.kind
    whole = kind in "iu" or (kind == "f" and bool((array == np.floor(array)).all()))
    if array.ndim != 1 or not whole:
        raise InputError(argument, "a flat array of whole numbers", describe(value))
    return np.ascontiguousarray(array, dtype=np.int64)


def offsets(value: object, total: int, argument: str = "offsets") -> IntArray:
    """Return ragged-array offsets: 0 = o[0] <= o[1] <= ... <= o[K] = total."""
    array = integers(value, argument)
    expected = f"offsets that start at 0, never decrease and end at {total}"
    if array.size == 0:
        raise InputError(argument, expected, "no offsets at all")
    if array[0] != 0 or array[-1] != total or (array[1:] < array[:-1]).any():
        raise InputError(argument, expected, f"{array[:4].tolist()} ... {array[-1]}")
    return array


def image_size(value: object, argument: str = "image_size") -> tuple[int, int] | None:
    """Return (width, height) in pixels as two positive ints, or None where it is unknown."""
    if value is None:
        return None
    try:
        width, height = (int(v) for v in value)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        raise InputError(argument, "(width, height) in pixels", describe(value)) from None
    if width < 1 or height < 1:
        raise InputError(argument, "a width and a height of at least 1", f"({width}, {height})")
    return width, height


def image(value: object, argument: str = "image") -> AnyArray:
    """Return an image as an array (H, W), (H, W, 3) or (H, W, 4) of a supported type.

    Supported are uint8, uint16, float32 and float64; floats must be finite. bool becomes uint8.
    """
    expected = "an image (H, W), (H, W, 3) or (H, W, 4) of uint8, uint16, float32 or float64"
    if not isinstance(value, np.ndarray):
        raise ImageError(argument, expected, describe(value))
    array = value.view(np.uint8) * np.uint8(255) if value.dtype == np.bool_ else value
    if array.ndim == 3 and array.shape[2] == 1:
        array = array[:, :, 0]
    wrong_shape = array.ndim not in (2, 3) or (array.ndim == 3 and array.shape[2] not in (3, 4))
    if wrong_shape or array.dtype not in (np.uint8, np.uint16, np.float32, np.float64):
        raise ImageError(argument, expected, describe(value))
    if array.shape[0] == 0 or array.shape[1] == 0:
        raise ImageError(argument, "an image with at least one pixel", describe(value))
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        bad = int(array.size - np.isfinite(array).sum())
        raise ImageError(argument, "finite pixel values", f"{bad} pixels that are NaN or infinite")
    return array
