"""The one mapping between core types and the geoprim messages, for live nodes and bags alike.

`to_wire` makes a `Record`: the fields of a message as plain Python and numpy values, which a
ROS node copies into its message class and a bag writer serialises. `from_wire` reads any object
that has the fields of a message: a ROS message, a decoded bag message or a `Record`.

Bulk geometry travels as float32. Whole pixels up to 2^24 and everything that the edge stage
emits are float32 numbers, so that a value comes back as it was sent.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np

from geoprim_core._check import AnyArray, FloatArray, describe
from geoprim_core.errors import InputError
from geoprim_core.io.record import Record, header, type_name
from geoprim_core.types import Contours, Detections, EllipseDetections, Ellipses, Polygons

Wired = Contours | Polygons | EllipseDetections | Detections

_ELLIPSE = ("x", "y", "semi_major", "semi_minor", "angle")
_EVIDENCE = ("score", "coverage", "alignment", "continuity")
_BOX = ("x_min", "y_min", "x_max", "y_max")
_SIZE = ("length", "width")


def to_wire(
    value: Wired,
    stamp_ns: int,
    frame_id: str,
    *,
    contours: Contours | None = None,
    method: str = "",
) -> Record:
    """Return the message of a core value.

    Parameters
    ----------
    value : Contours, Polygons, EllipseDetections or Detections
    stamp_ns : int
        Stamp of the input image in nanoseconds.
    frame_id : str
        Frame of the input image.
    contours : Contours
        The contours that polygons belong to; only for Polygons, and needed there.
    method : str
        Short name of the approximation method; only for Polygons.

    Returns
    -------
    Record

    Raises
    ------
    InputError
        The value is none of these types, or polygons come without their contours.

    Examples
    --------
    >>> contours = Contours([[0, 0], [1, 1]], offsets=[0, 2], closed=[False])
    >>> record = to_wire(contours, stamp_ns=1_500_000_000, frame_id="camera")
    >>> record.type, record.points.tolist(), record.header.stamp.sec
    ('geoprim_msgs/msg/Contours', [0.0, 0.0, 1.0, 1.0], 1)
    >>> from_wire(record).points.tolist()
    [[0.0, 0.0], [1.0, 1.0]]
    """
    if isinstance(value, Contours):
        name, body = "Contours", _contour_fields(value)
    elif isinstance(value, Polygons):
        name, body = "Polygons", _polygon_fields(value, contours, method)
    elif isinstance(value, EllipseDetections):
        name, body = "EllipseDetections", _ellipse_fields(value)
    elif isinstance(value, Detections):
        name, body = "Detections", {"detections": _object_records(value)}
    else:
        expected = "Contours, Polygons, EllipseDetections or Detections"
        raise InputError("value", expected, describe(value))
    width, height = value.image_size or (0, 0)
    head = {
        "header": header(stamp_ns, frame_id),
        "image_width": width,
        "image_height": height,
    }
    return Record(f"geoprim_msgs/msg/{name}", head | body)


def from_wire(message: Any) -> Wired:
    """Return the core value of a message: a ROS message, a decoded bag message or a Record.

    Raises
    ------
    InputError
        The type is not one of geoprim's, or the arrays contradict each other; the text names
        the field.
    """
    name = type_name(message).rpartition("/")[2]
    if name not in _READERS:
        known = ", ".join(f"geoprim_msgs/msg/{k}" for k in _READERS)
        raise InputError("message", f"one of {known}", type_name(message))
    try:
        return _READERS[name](message)
    except InputError as error:
        raise InputError(f"{name}.{error.argument}", error.expected, error.got) from None
    except AttributeError as error:
        raise InputError(name, "all fields of the message", str(error)) from None


def _contour_fields(contours: Contours) -> dict[str, Any]:
    return {
        "points": _float32(contours.points),
        "offsets": contours.offsets.astype(np.uint32),
        "closed": contours.closed.astype(np.uint8),
        "subpixel": _float32(contours.subpixel),
        "gradient_angle": _float32(contours.gradient_angle),
        "blur": contours.blur,
        "softness": contours.softness,
        "gradient_magnitude": _float32(contours.gradient_magnitude),
    }


def _polygon_fields(polygons: Polygons, contours: Contours | None, method: str) -> dict[str, Any]:
    if not isinstance(contours, Contours):
        raise InputError("contours", "the Contours that the polygons belong to", describe(contours))
    return {
        "method": method,
        "indices": polygons.indices.astype(np.uint32),
        "offsets": polygons.offsets.astype(np.uint32),
        "closed": polygons.closed.astype(np.uint8),
        "vertices": _float32(polygons.vertices(contours)),
    }


def _ellipse_fields(found: EllipseDetections) -> dict[str, Any]:
    return {
        "complete": found.complete,
        "reason": found.reason,
        "detections": _ellipse_records(found),
    }


def _ellipse_records(found: EllipseDetections) -> list[Record]:
    evidence = np.stack([getattr(found, name) for name in _EVIDENCE], axis=1).tolist()
    covariance = found.covariance.reshape(-1, 25)
    return [
        Record(
            "geoprim_msgs/msg/EllipseDetection",
            {"ellipse": ellipse, **dict(zip(_EVIDENCE, values, strict=True)), "covariance": matrix},
        )
        for ellipse, values, matrix in zip(
            _ellipses(found.ellipses), evidence, covariance, strict=True
        )
    ]


def _object_records(found: Detections) -> list[Record]:
    assert found.polygon_offsets is not None
    assert found.size is not None
    polygons, cuts = found.polygons.astype(np.float32), found.polygon_offsets
    rows = zip(
        found.labels,
        found.score.tolist(),
        found.boxes.tolist(),
        _ellipses(found.ellipses),
        (polygons[a:b].reshape(-1) for a, b in pairwise(cuts)),
        found.size.tolist(),
        strict=True,
    )
    return [
        Record(
            "geoprim_msgs/msg/Detection",
            {
                "label": label,
                "score": score,
                **dict(zip(_BOX, box, strict=True)),
                "ellipse": ellipse,
                "polygon": outline,
                **dict(zip(_SIZE, size, strict=True)),
            },
        )
        for label, score, box, ellipse, outline, size in rows
    ]


def _ellipses(ellipses: Ellipses) -> list[Record]:
    return [
        Record("geoprim_msgs/msg/Ellipse", dict(zip(_ELLIPSE, row, strict=True)))
        for row in ellipses.array().tolist()
    ]


def _float32(values: FloatArray | None) -> AnyArray:
    if values is None:
        return np.zeros(0, np.float32)
    return values.astype(np.float32).reshape(-1)


def _read_contours(message: Any) -> Contours:
    points = _pairs(message.points, "points")
    subpixel = _pairs(message.subpixel, "subpixel")
    angle = np.asarray(message.gradient_angle, np.float64)
    magnitude = np.asarray(getattr(message, "gradient_magnitude", ()), np.float64)
    return Contours(
        points,
        np.asarray(message.offsets),
        _flags(message.closed),
        _image_size(message),
        subpixel if len(subpixel) else None,
        angle if len(angle) else None,
        float(message.blur),
        float(getattr(message, "softness", np.nan)),  # older recordings have none,
        magnitude if len(magnitude) else None,  # and no magnitudes
    )


def _read_polygons(message: Any) -> Polygons:
    indices = np.asarray(message.indices)
    vertices = _pairs(message.vertices, "vertices")
    if len(vertices) != len(indices):
        expected = f"{len(indices)} vertices, one an index"
        raise InputError("vertices", expected, f"{len(vertices)}")
    flags = _flags(message.closed)
    return Polygons(indices, np.asarray(message.offsets), flags, _image_size(message))


def _read_ellipses(message: Any) -> EllipseDetections:
    found = message.detections
    covariance = [np.asarray(d.covariance, np.float64) for d in found]
    if any(c.shape != (25,) for c in covariance):
        raise InputError("detections.covariance", "25 numbers each", "another number")
    ellipses = _read_ellipse_list([d.ellipse for d in found])
    matrices = np.reshape(covariance, (len(found), 5, 5))
    score, coverage, alignment, continuity = _columns(found, _EVIDENCE).T
    return EllipseDetections(
        ellipses, score, coverage, alignment, continuity, matrices, _image_size(message),
        bool(message.complete), str(message.reason),
    )  # fmt: skip


def _read_objects(message: Any) -> Detections:
    found = message.detections
    outlines = [_pairs(d.polygon, "detections.polygon") for d in found]
    return Detections(
        labels=tuple(str(d.label) for d in found),
        score=np.array([d.score for d in found], np.float64),
        boxes=_columns(found, _BOX),
        ellipses=_read_ellipse_list([d.ellipse for d in found]),
        polygons=np.concatenate([np.zeros((0, 2)), *outlines]),
        polygon_offsets=np.cumsum([0, *(len(outline) for outline in outlines)]),
        size=_columns(found, _SIZE),
        image_size=_image_size(message),
    )


def _read_ellipse_list(ellipses: list[Any]) -> Ellipses:
    return Ellipses.from_array(_columns(ellipses, _ELLIPSE))


def _columns(objects: Any, names: tuple[str, ...]) -> FloatArray:
    values = [[getattr(o, name) for name in names] for o in objects]
    return np.array(values, np.float64).reshape(len(values), len(names))


def _pairs(values: Any, field: str) -> FloatArray:
    array = np.asarray(values, np.float64)
    if array.size % 2:
        raise InputError(field, "x0, y0, x1, y1, ...: an even number of values", f"{array.size}")
    return array.reshape(-1, 2)


def _flags(values: Any) -> AnyArray:
    flags: AnyArray = np.asarray(values) != 0
    return flags


def _image_size(message: Any) -> tuple[int, int] | None:
    size = int(message.image_width), int(message.image_height)
    return None if size == (0, 0) else size


_READERS: dict[str, Callable[[Any], Wired]] = {
    "Contours": _read_contours,
    "Polygons": _read_polygons,
    "EllipseDetections": _read_ellipses,
    "Detections": _read_objects,
}
