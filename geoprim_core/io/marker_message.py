"""Ellipses as visualization_msgs: MarkerArray on the working plane, ImageMarker on the image."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from geoprim_core._check import FloatArray
from geoprim_core.applications import ellipse_outlines
from geoprim_core.applications.sorting import PLANE_DISTANCE
from geoprim_core.io.annotations import corner_based
from geoprim_core.io.plane_points import pixel_size_on_plane, points_on_plane
from geoprim_core.io.record import Record
from geoprim_core.io.shown import OverlayParams, Shown
from geoprim_core.params import Params, group, option

_ADD, _DELETE_ALL = 0, 3
_LINE_STRIP, _TEXT = 4, 9
_IMAGE_LINE_LIST = 2
_VERTICES = 48
_LINE_PIXELS, _LETTER_PIXELS = 2.0, 14.0  # on the plane, at the camera's axis


@dataclass(frozen=True)
class MarkerParams(Params):
    """How markers are made."""

    lifetime: float = option(
        1.0, "markers vanish so long after the last frame; 0: never", unit="s", low=0.0, high=3600.0
    )
    rectified: bool = option(
        False, "the image is rectified: P of camera_info holds, not K with its distortion"
    )


@dataclass(frozen=True)
class MarkersParams(Params):
    """The parameters of markers, under the names that files and nodes have for them."""

    plane_distance: float = option(
        float(PLANE_DISTANCE.default), PLANE_DISTANCE.text,
        unit=PLANE_DISTANCE.unit, low=PLANE_DISTANCE.low, high=PLANE_DISTANCE.high,
    )  # fmt: skip
    markers: MarkerParams = group(MarkerParams)


def marker_array(
    shown: Shown, header: Any, info: Any, distance: float, *,
    params: MarkerParams | None = None, style: OverlayParams | None = None,
) -> tuple[Record, int]:  # fmt: skip
    """Return a visualization_msgs/msg/MarkerArray of ellipses on the working plane.

    The array stands for itself: its first marker takes all earlier ones away, so that nothing
    old stays where a message was lost, and the lifetime does where no further one comes. A
    closed line in namespace `ellipses` and a text in namespace `texts` have the number of the
    ellipse in its message as their id.

    Parameters
    ----------
    shown : Shown
    header : std_msgs/msg/Header of the frame, as a message or a Record
    info : object with the fields of sensor_msgs/msg/CameraInfo
    distance : float
        Of the working plane from the camera, in metres.
    params, style : MarkerParams, OverlayParams, optional

    Returns
    -------
    Record, int
        The message, and how many ellipses are left out as the lens does not reach a part of
        them.

    Raises
    ------
    InputError
        As `points_on_plane`.
    """
    params, style = params or MarkerParams(), style or OverlayParams()
    pixels = ellipse_outlines(shown.ellipses, _VERTICES).reshape(-1, 2)
    places = points_on_plane(pixels, info, distance, rectified=params.rectified)
    outlines = places.reshape(len(shown), _VERTICES, 3)
    whole = np.isfinite(outlines).all(axis=(1, 2))
    size = pixel_size_on_plane(info, distance)
    colours, texts = shown.colours(style), shown.texts(style)
    markers = [_marker(header, "", 0, action=_DELETE_ALL)]
    for i in np.flatnonzero(whole).tolist():
        both = {"color": _colour(colours[i]), "lifetime": _duration(params.lifetime)}
        markers += _of_ellipse(header, shown.ids[i], outlines[i], texts[i], size, both)
    array = Record("visualization_msgs/msg/MarkerArray", {"markers": markers})
    return array, int(np.count_nonzero(~whole))


def image_marker(shown: Shown, header: Any, style: OverlayParams | None = None) -> Record:
    """Return a visualization_msgs/msg/ImageMarker with the outlines of all ellipses.

    One message holds one marker, so it is a list of lines, each with its colour. The corner of
    the image is (0, 0), as in Foxglove, which shows it like its own annotations.

    Parameters
    ----------
    shown : Shown
    header : std_msgs/msg/Header of the frame, as a message or a Record
    style : OverlayParams, optional
    """
    outlines = corner_based(ellipse_outlines(shown.ellipses, _VERTICES))
    ends = np.stack([outlines, np.roll(outlines, -1, axis=1)], axis=2).reshape(-1, 2)
    colours = [_colour(c) for c in shown.colours(style or OverlayParams())]
    fields = {
        "header": header,
        "ns": "ellipses",
        "type": _IMAGE_LINE_LIST,
        "action": _ADD,
        "scale": _LINE_PIXELS,
        "points": list(_points(np.column_stack([ends, np.zeros(len(ends))]))),
        "outline_colors": [c for c in colours for _ in range(_VERTICES)],
    }
    return Record("visualization_msgs/msg/ImageMarker", {**_IMAGE_DEFAULTS, **fields})


def _of_ellipse(
    header: Any, number: int, outline: FloatArray, text: str, pixel: float, both: dict[str, Any]
) -> Iterator[Record]:
    points = list(_points(np.vstack([outline, outline[:1]])))
    line = _vector("geometry_msgs/msg/Vector3", _LINE_PIXELS * pixel, 0.0, 0.0)
    yield _marker(header, "ellipses", number, type=_LINE_STRIP, scale=line, points=points, **both)
    if text:
        letters = _vector("geometry_msgs/msg/Vector3", 0.0, 0.0, _LETTER_PIXELS * pixel)
        pose = _pose(outline.mean(axis=0))
        yield _marker(
            header, "texts", number, type=_TEXT, scale=letters, pose=pose, text=text, **both
        )


def _marker(header: Any, space: str, number: int, **fields: Any) -> Record:
    own = {"header": header, "ns": space, "id": number}
    return Record("visualization_msgs/msg/Marker", {**_DEFAULTS, **own, **fields})


def _points(points: FloatArray) -> Iterator[Record]:
    return (_vector("geometry_msgs/msg/Point", *row) for row in points.tolist())


def _vector(kind: str, x: float, y: float, z: float) -> Record:
    return Record(kind, {"x": x, "y": y, "z": z})


def _pose(place: FloatArray) -> Record:
    straight = Record("geometry_msgs/msg/Quaternion", {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0})
    position = _vector("geometry_msgs/msg/Point", *place.tolist())
    return Record("geometry_msgs/msg/Pose", {"position": position, "orientation": straight})


def _colour(rgb: FloatArray) -> Record:
    r, g, b = rgb.tolist()
    return Record("std_msgs/msg/ColorRGBA", {"r": r, "g": g, "b": b, "a": 1.0})


def _duration(seconds: float) -> Record:
    sec, nanosec = divmod(round(seconds * 1e9), 1_000_000_000)
    return Record("builtin_interfaces/msg/Duration", {"sec": sec, "nanosec": nanosec})


_STAMP = Record("builtin_interfaces/msg/Time", {"sec": 0, "nanosec": 0})
_NO_HEADER = Record("std_msgs/msg/Header", {"stamp": _STAMP, "frame_id": ""})
_NO_IMAGE = {"header": _NO_HEADER, "format": "", "data": np.zeros(0, np.uint8)}
_ORIGIN = np.zeros(3)
_DEFAULTS: dict[str, Any] = {
    "type": 0,
    "action": _ADD,
    "pose": _pose(_ORIGIN),
    "scale": _vector("geometry_msgs/msg/Vector3", 0.0, 0.0, 0.0),
    "color": _colour(_ORIGIN),
    "lifetime": _duration(0.0),
    "frame_locked": False,
    "points": [],
    "colors": [],
    "texture_resource": "",
    "texture": Record("sensor_msgs/msg/CompressedImage", _NO_IMAGE),
    "uv_coordinates": [],
    "text": "",
    "mesh_resource": "",
    "mesh_file": Record(
        "visualization_msgs/msg/MeshFile", {"filename": "", "data": np.zeros(0, np.uint8)}
    ),
    "mesh_use_embedded_materials": False,
}
_IMAGE_DEFAULTS: dict[str, Any] = {
    "id": 0,
    "position": _vector("geometry_msgs/msg/Point", 0.0, 0.0, 0.0),
    "outline_color": _colour(_ORIGIN),
    "filled": 0,
    "fill_color": _colour(_ORIGIN),
    "lifetime": _duration(0.0),
}
